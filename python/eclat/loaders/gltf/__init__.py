# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Load scenes from glTF 2.0 files (`.gltf` and `.glb`).

The modules of this package are `container` (files, chunks and buffers), `element` (validated JSON), `accessors`
(arrays), `topology` and `primitives` (triangles), `textures`, `materials`, `lights`, `cameras`, `nodes` (the node
hierarchy), `skins` and `bending` (joints), `animations` (values over time), `builder` (the scene at one moment) and
`motion` (the scene over time).
"""

from __future__ import annotations

from pathlib import Path

from eclat.errors import warn
from eclat.loaders.gltf.builder import Builder, Sources
from eclat.loaders.gltf.container import Document
from eclat.loaders.gltf.extensions import warn_about_unsupported
from eclat.loaders.gltf.motion import motion_of
from eclat.motion.animation import Pose
from eclat.scene import Scene


def load_gltf(path: str | Path) -> Scene:
    """Load the default scene of a glTF 2.0 file, with all instances in world space.

    Lengths are in metres. The intensity of lights is in candela or lux [KHR_lights_punctual], and the emission of
    surfaces is in cd·m⁻² [KHR_materials_emissive_strength]. A file that has lights or emission sets
    `Scene.photometric`. Double-sided materials emit on both sides. All animations of the file together become
    `Scene.animation`. An `EclatWarning` reports everything that is replaced or ignored.

    Parameters
    ----------
    path : a `.gltf` or `.glb` file. The files that it refers to must be in its folder or in a folder below it.

    Raises
    ------
    EclatError : the file cannot be read or is invalid. The message names the element.

    Examples
    --------
    >>> scene = load_gltf("room.glb")
    >>> len(scene.meshes)
    1
    """
    document = Document(Path(path))
    warn_about_unsupported(document)
    sources = Sources(document)
    builder = Builder(document, sources)
    pose = builder.build()
    builder.parts.finish()
    if not pose.meshes:
        warn(f"{document.name}: the scene has no triangles, so it is empty")
    return Scene(
        meshes=tuple(pose.meshes.values()),
        lights=tuple(pose.lights.values()),
        cameras=tuple(pose.cameras.values()),
        name=Path(path).stem,
        photometric=_photometric(document, pose),
        animation=motion_of(document, sources, builder, pose),
    )


def _photometric(document: Document, pose: Pose) -> bool:
    """Return whether the scene has photometric units.

    The units are photometric if there are lights or emission, because glTF defines their units as such. A file that
    Éclat wrote states its units itself.
    """
    note = document.eclat_extras
    if note is not None and note.data.get("photometric") is not None:
        return note.flag("photometric")
    return bool(pose.lights) or any(mesh.material.emission is not None for mesh in pose.meshes.values())
