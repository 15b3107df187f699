# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Load scenes from glTF 2.0 files (`.gltf` and `.glb`).

The modules of this package are `container` (files, chunks and buffers), `element` (validated JSON), `accessors`
(arrays), `topology` and `primitives` (triangles), `textures`, `materials`, `lights`, `cameras` and `nodes` (the node
hierarchy).
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from eclat.errors import EclatError, warn
from eclat.loaders.budget import OBJECT, spend
from eclat.loaders.gltf.accessors import Accessors
from eclat.loaders.gltf.cameras import read_camera
from eclat.loaders.gltf.container import Document
from eclat.loaders.gltf.element import Element
from eclat.loaders.gltf.extensions import warn_about_unsupported
from eclat.loaders.gltf.lights import read_light
from eclat.loaders.gltf.materials import Materials, used_uv_sets
from eclat.loaders.gltf.nodes import Matrix, instances, scene_nodes
from eclat.loaders.gltf.primitives import (
    Primitive,
    read_primitive,
    split_solids_and_sheets,
    transform_primitive,
)
from eclat.loaders.parts import Parts
from eclat.scene import Camera, Light, Material, Mesh, Scene


def load_gltf(path: str | Path) -> Scene:
    """Load the default scene of a glTF 2.0 file, with all instances in world space.

    Lengths are in metres. The intensity of lights is in candela or lux [KHR_lights_punctual], and the emission of
    surfaces is in cd·m⁻² [KHR_materials_emissive_strength]. A file that has lights or emission sets
    `Scene.photometric`. Double-sided materials emit on both sides. An `EclatWarning` reports everything that is replaced
    or ignored.

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
    return _Builder(Document(Path(path))).build(Path(path).stem)


class _Builder:
    """The builder of a scene. It visits the nodes and collects meshes, lights and cameras."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._accessors = Accessors(document)
        self._materials = Materials(document)
        self._primitives: dict[tuple[str, tuple[float, ...]], list[tuple[Primitive, Material]]] = {}
        extension = document.root.extension("KHR_lights_punctual")
        self._known_lights = [] if extension is None else extension.children("lights")
        self._meshes: list[Mesh] = []
        self._lights: list[Light] = []
        self._cameras: list[Camera] = []
        self._parts = Parts()

    def build(self, name: str) -> Scene:
        document = self._document
        warn_about_unsupported(document)
        for node, to_world in scene_nodes(document):
            self._add_mesh(node, to_world)
            reference = node.extension("KHR_lights_punctual")
            if reference is not None:
                with self._parts.one():
                    self._add_light(node, reference, to_world)
            self._add_camera(node, to_world)
        self._parts.finish()
        if not self._meshes:
            warn(f"{document.name}: the scene has no triangles, so it is empty")
        return Scene(
            meshes=tuple(self._meshes),
            lights=tuple(self._lights),
            cameras=tuple(self._cameras),
            name=name,
            photometric=self._photometric(),
        )

    def _photometric(self) -> bool:
        """Return whether the scene has photometric units.

        The units are photometric if there are lights or emission, because glTF defines their units as such. A file that
        Éclat wrote states its units itself.
        """
        note = self._document.eclat_extras
        if note is not None and note.data.get("photometric") is not None:
            return note.flag("photometric")
        return bool(self._lights) or any(mesh.material.emission is not None for mesh in self._meshes)

    def _add_mesh(self, node: Element, to_world: Matrix) -> None:
        mesh = self._document.element(node, "mesh", "meshes")
        if mesh is None:
            return
        if node.data.get("skin") is not None:
            warn(f"{node.where}: skins are not supported; the mesh is loaded in its bind pose")
        elements = mesh.children("primitives")
        if not elements:
            warn(f"{mesh.where}: the mesh has no primitives and is left out")
        weights = _weights(node, mesh)
        with np.errstate(all="ignore"):
            places = to_world @ instances(node, self._accessors)
        if not np.isfinite(places).all():
            raise EclatError(
                f"{node.where}: expected finite transforms of the instances, got an overflow: the product of the scales "
                "is too large"
            )
        for i, element in enumerate(elements):
            name = mesh.text("name") or node.text("name") or mesh.where.partition(", ")[2]
            with self._parts.one():
                first = len(self._meshes)
                self._add_primitive(element, weights, places, name if len(elements) == 1 else f"{name}.{i}")
                lamp = node.text("name")
                self._meshes[first:] = [replace(made, lamp=lamp) for made in self._meshes[first:]]

    def _add_primitive(self, element: Element, weights: tuple[float, ...], places: Matrix, name: str) -> None:
        key = (element.where, weights)
        if key not in self._primitives:
            self._primitives[key] = self._read(element, weights)
        parts = self._primitives[key]
        for part, _ in parts:
            spend(_transformed_size(part) * len(places), element.where)
        for matrix in places:
            if np.linalg.matrix_rank(matrix[:3, :3]) < 2:
                warn(
                    f"{element.where}: the transform of a node scales the mesh to a line or a point; this instance is "
                    "left out"
                )
                continue
            self._meshes += [transform_primitive(part, matrix, surface, name) for part, surface in parts]

    def _read(self, element: Element, weights: tuple[float, ...]) -> list[tuple[Primitive, Material]]:
        """Read a primitive as parts that have one material each. There are none if it has no triangles."""
        note = element.eclat_extras()
        if note is not None and note.flag("back_side"):
            return []  # The primitive that holds the front side gets a two-sided material instead.
        primitive = read_primitive(element, self._accessors, weights, self._document.second_uv_set)
        if primitive is None:
            return []
        material = self._materials.of(element, primitive.colors is not None)
        for uv_set in sorted(used_uv_sets(material)):
            if (primitive.uvs, primitive.uvs2)[uv_set] is None:
                warn(
                    f"{element.where}: the material uses TEXCOORD_{uv_set}, which the primitive does not have; (0, 0) is "
                    "used for all vertices"
                )
        if primitive.colors is not None and self._materials.ignores_alpha(element):
            primitive.colors[:, 3] = 1
        return split_solids_and_sheets(primitive, material)

    def _add_light(self, node: Element, reference: Element, to_world: Matrix) -> None:
        index = reference.index("light", len(self._known_lights), "lights")
        if index is None:
            raise EclatError(f"{reference.where}: expected the index of a light as 'light', but it is missing")
        light = self._known_lights[index]
        self._lights.append(read_light(light, to_world, node.text("name") or light.text("name")))

    def _add_camera(self, node: Element, to_world: Matrix) -> None:
        camera = self._document.element(node, "camera", "cameras")
        if camera is not None:
            name = node.text("name") or camera.text("name") or camera.where.partition(", ")[2]
            self._cameras.append(read_camera(camera, to_world, name))


def _transformed_size(primitive: Primitive) -> int:
    """Return the number of bytes that an instance of a primitive takes. It shares triangles, unless it is mirrored,
    texture coordinates and colours with the other instances.
    """
    arrays = (primitive.positions, primitive.triangles, primitive.normals, primitive.tangents)
    return OBJECT + sum(array.nbytes for array in arrays if array is not None)


def _weights(node: Element, mesh: Element) -> tuple[float, ...]:
    """Return the weights of morph targets: those of the node or, if it has none, those of the mesh."""
    owner = node if node.data.get("weights") is not None else mesh
    values = owner.data.get("weights")
    return owner.numbers("weights", len(values) if isinstance(values, list) else 0, ())
