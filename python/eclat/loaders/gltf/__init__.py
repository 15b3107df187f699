# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""glTF 2.0: `load_gltf` makes a `Scene` of a `.gltf` or `.glb` file.

The parts: `container` (files, chunks, buffers), `element` (checked JSON), `accessors` (arrays), `topology` and
`primitives` (triangles), `textures`, `materials`, `lights`, `cameras`, `nodes` (the hierarchy).
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from eclat.errors import EclatError, warn
from eclat.loaders.gltf.accessors import Accessors
from eclat.loaders.gltf.cameras import read_camera
from eclat.loaders.gltf.container import Document
from eclat.loaders.gltf.element import Element
from eclat.loaders.gltf.extensions import warn_of_unsupported
from eclat.loaders.gltf.lights import Light, read_light
from eclat.loaders.gltf.materials import Materials, used_uv_sets
from eclat.loaders.gltf.nodes import Matrix, instances, scene_nodes
from eclat.loaders.gltf.primitives import Primitive, bodies_and_sheets, place, read_primitive
from eclat.loaders.parts import LimitError, Parts
from eclat.scene import Camera, Material, Mesh, Scene

MAX_VERTICES = 1 << 26
"""Vertices of all instances together. A small file can ask for any number; 6 GB hold these."""

MESH_COST = 256
"""What an instance costs at least, in vertices: its Python objects."""


def load_gltf(path: str | Path) -> Scene:
    """The default scene of a glTF 2.0 file, all instances in world space.

    Lengths are metres. Punctual lights are in candela and lux, emission is in cd·m⁻² [KHR_lights_punctual,
    KHR_materials_emissive_strength]: a file with either sets `Scene.photometric`. Double-sided materials emit on both
    sides. Whatever is replaced or ignored is told by an `EclatWarning`.

    Parameters
    ----------
    path : a `.gltf` or `.glb` file; the files it names must lie in its folder or below.

    Raises
    ------
    EclatError : the file is broken or unreadable; the message names the element.

    Examples
    --------
    >>> scene = load_gltf("room.glb")
    >>> len(scene.meshes)
    1
    """
    return _Builder(Document(Path(path))).build(Path(path).stem)


class _Builder:
    """Collects meshes, lights and cameras while the nodes are walked."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._accessors = Accessors(document)
        self._materials = Materials(document)
        self._primitives: dict[tuple[str, tuple[float, ...]], tuple[Primitive, Material] | None] = {}
        extension = document.root.extension("KHR_lights_punctual")
        self._known_lights = [] if extension is None else extension.children("lights")
        self._meshes: list[Mesh] = []
        self._lights: list[Light] = []
        self._cameras: list[Camera] = []
        self._vertices = 0
        self._parts = Parts()

    def build(self, name: str) -> Scene:
        document = self._document
        warn_of_unsupported(document)
        for node, to_world in scene_nodes(document):
            self._add_mesh(node, to_world)
            reference = node.extension("KHR_lights_punctual")
            if reference is not None:
                with self._parts.one():
                    self._add_light(reference, to_world)
            self._add_camera(node, to_world)
        self._parts.finish()
        if not self._meshes:
            warn(f"{document.name}: the scene has no triangles")
        return Scene(
            meshes=tuple(self._meshes),
            lights=tuple(self._lights),
            cameras=tuple(self._cameras),
            name=name,
            photometric=self._photometric(),
        )

    def _photometric(self) -> bool:
        """As glTF means its numbers, unless the file is ours and says otherwise."""
        note = self._document.own_note
        if note is not None and note.data.get("photometric") is not None:
            return note.flag("photometric")
        return bool(self._lights) or any(mesh.material.emission is not None for mesh in self._meshes)

    def _add_mesh(self, node: Element, to_world: Matrix) -> None:
        mesh = self._document.element(node, "mesh", "meshes")
        if mesh is None:
            return
        if node.data.get("skin") is not None:
            warn(f"{node.where}: skins are not supported; the mesh keeps the shape and place it has without")
        elements = mesh.children("primitives")
        if not elements:
            warn(f"{mesh.where}: has no primitives and is skipped")
        weights = _weights(node, mesh)
        with np.errstate(all="ignore"):
            places = to_world @ instances(node, self._accessors)
        if not np.isfinite(places).all():
            raise EclatError(f"{node.where}: the scales of its instances multiply beyond all bounds")
        for i, element in enumerate(elements):
            name = mesh.text("name") or node.text("name") or mesh.where.partition(", ")[2]
            with self._parts.one():
                self._add_primitive(element, weights, places, name if len(elements) == 1 else f"{name}.{i}")

    def _add_primitive(self, element: Element, weights: tuple[float, ...], places: Matrix, name: str) -> None:
        key = (element.where, weights)
        if key not in self._primitives:
            self._primitives[key] = self._read(element, weights)
        found = self._primitives[key]
        if found is None:
            return
        primitive, material = found
        parts = bodies_and_sheets(primitive, material)
        self._spend(max(len(primitive.positions), MESH_COST) * len(places), element)
        for matrix in places:
            if np.linalg.matrix_rank(matrix[:3, :3]) < 2:
                warn(f"{element.where}: a node scales it to nothing; it is skipped there")
                continue
            self._meshes += [place(part, matrix, surface, name) for part, surface in parts]

    def _read(self, element: Element, weights: tuple[float, ...]) -> tuple[Primitive, Material] | None:
        note = element.own_note()
        if note is not None and note.flag("back_side"):
            return None  # of a sheet whose front stands beside it
        attributes = element.child("attributes")
        positions = self._accessors.floats(attributes, "POSITION", ("VEC3",)) if attributes is not None else None
        self._spend(0 if positions is None else len(positions), element)
        primitive = read_primitive(element, self._accessors, weights, self._document.second_uv_set)
        if primitive is None:
            return None
        material = self._materials.of(element, primitive.colors is not None)
        for uv_set in sorted(used_uv_sets(material)):
            if (primitive.uvs, primitive.uvs2)[uv_set] is None:
                warn(f"{element.where}: its material reads TEXCOORD_{uv_set}, which it lacks; (0, 0) is used")
        if primitive.colors is not None and self._materials.opaque(element):
            primitive.colors[:, 3] = 1
        return primitive, material

    def _spend(self, vertices: int, element: Element) -> None:
        self._vertices += vertices
        if self._vertices > MAX_VERTICES:
            raise LimitError(f"{element.where}: with it the scene has more than {MAX_VERTICES} vertices, the limit")

    def _add_light(self, reference: Element, to_world: Matrix) -> None:
        index = reference.index("light", len(self._known_lights), "lights")
        if index is None:
            raise EclatError(f"{reference.where}: expected an integer as 'light', which is missing")
        self._lights.append(read_light(self._known_lights[index], to_world))

    def _add_camera(self, node: Element, to_world: Matrix) -> None:
        camera = self._document.element(node, "camera", "cameras")
        if camera is not None:
            name = node.text("name") or camera.text("name") or camera.where.partition(", ")[2]
            self._cameras.append(read_camera(camera, to_world, name))


def _weights(node: Element, mesh: Element) -> tuple[float, ...]:
    """The weights of morph targets: those of the node, or else of the mesh."""
    owner = node if node.data.get("weights") is not None else mesh
    values = owner.data.get("weights")
    return owner.numbers("weights", len(values) if isinstance(values, list) else 0, ())
