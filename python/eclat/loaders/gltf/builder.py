# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Build the meshes, lights and cameras of a glTF file at one moment: visit the nodes and place what they carry."""

from __future__ import annotations

from collections.abc import Hashable
from dataclasses import dataclass, replace

import numpy as np

from eclat.errors import EclatError, warn
from eclat.intensity_profile import IntensityProfile
from eclat.loaders.budget import OBJECT, spend
from eclat.loaders.gltf.accessors import Accessors
from eclat.loaders.gltf.animations import read_animations
from eclat.loaders.gltf.bending import bend_primitive
from eclat.loaders.gltf.cameras import read_camera
from eclat.loaders.gltf.container import Document
from eclat.loaders.gltf.element import Element
from eclat.loaders.gltf.lights import read_light, read_profile_light
from eclat.loaders.gltf.materials import Materials, used_uv_sets
from eclat.loaders.gltf.nodes import Matrix, instances, scene_nodes
from eclat.loaders.gltf.primitives import (
    Pieces,
    Primitive,
    read_primitive,
    solid_triangles,
    split_solids_and_sheets,
    transform_primitive,
)
from eclat.loaders.gltf.skins import joint_matrices
from eclat.loaders.ies import parse_ies
from eclat.loaders.parts import Parts
from eclat.motion.animation import Pose
from eclat.scene import Camera, Light, Material, Mesh

Part = tuple[Primitive, Material]
Made = tuple[object, Mesh]
"""What a mesh was made from, its signature, and the mesh."""


class Sources:
    """What all moments of a file share, so that each array, texture and unmoved mesh is made once."""

    def __init__(self, document: Document) -> None:
        self.accessors = Accessors(document)
        self.materials = Materials(document)
        self.channels = read_animations(document, self.accessors)
        self.solids: dict[str, Pieces | None] = {}
        """The triangles that bound solids, by primitive, so that a primitive is split in the same way at all times."""
        self.resting: dict[Hashable, Made] | None = None
        """The meshes of the rest pose, once it has been built."""
        self.primitives: dict[tuple[object, ...], _Read] = {}
        """The primitives of the rest pose."""
        self.profiles: dict[int, IntensityProfile] = {}
        """The photometric files, by their indices."""


@dataclass(frozen=True, eq=False)
class _Read:
    """A primitive as it was read, its material, and its parts that have one material each."""

    whole: Primitive
    material: Material
    parts: list[Part]


@dataclass(frozen=True)
class Origin:
    """The places in the file where a mesh, a light or a camera comes from: its node, and the index of its material, light
    or camera."""

    node: int
    index: int | None


@dataclass(frozen=True)
class _Place:
    """Where the mesh of a node lies: one matrix for each instance, or the matrices of the joints of a skin."""

    node: int
    matrices: Matrix
    skinned: bool
    weights: tuple[float, ...]
    lamp: str
    """The name of the node, by which its meshes that emit are grouped."""


class Builder:
    """The builder of one pose. After `build`, `origins` says where each object comes from, and `parts` counts invalid
    parts of the scene.
    """

    def __init__(self, document: Document, sources: Sources, materials: Materials | None = None) -> None:
        self._document = document
        self._sources = sources
        self._accessors = sources.accessors
        self._materials = sources.materials if materials is None else materials
        self._primitives: dict[tuple[object, ...], _Read] = dict(sources.primitives)
        extension = document.root.extension("KHR_lights_punctual")
        self._known_lights = [] if extension is None else extension.children("lights")
        extension = document.root.extension("EXT_lights_ies")
        self._known_profiles = [] if extension is None else extension.children("lights")
        self._meshes: dict[Hashable, Mesh] = {}
        self._made: dict[Hashable, Made] = {}
        self._lights: dict[Hashable, Light] = {}
        self._cameras: dict[Hashable, Camera] = {}
        self.origins: dict[Hashable, Origin] = {}
        self.parts = Parts()

    def build(self) -> Pose:
        """Visit all nodes. Invalid parts are left out; `parts.finish` warns of them."""
        nodes = list(scene_nodes(self._document))
        places = {index: to_world for index, _, to_world in nodes}
        for index, node, to_world in nodes:
            self._add_mesh(index, node, places)
            reference = node.extension("KHR_lights_punctual")
            if reference is not None:
                with self.parts.one():
                    self._add_light(index, node, reference, to_world)
            measured = node.extension("EXT_lights_ies")
            if measured is not None:
                with self.parts.one():
                    self._add_profile_light(index, node, measured, to_world)
            self._add_camera(index, node, to_world)
        if self._sources.resting is None:
            self._sources.resting, self._sources.primitives = self._made, self._primitives
        return Pose(self._meshes, self._lights, self._cameras)

    def _add_mesh(self, index: int, node: Element, places: dict[int, Matrix]) -> None:
        mesh = self._document.element(node, "mesh", "meshes")
        if mesh is None:
            return
        elements = mesh.children("primitives")
        if not elements:
            warn(f"{mesh.where}: the mesh has no primitives and is left out")
        place = self._skinned_place(index, node, mesh, places) or self._place(index, node, mesh, places[index])
        for i, element in enumerate(elements):
            name = mesh.text("name") or node.text("name") or mesh.where.partition(", ")[2]
            with self.parts.one():
                self._add_primitive(element, i, place, name if len(elements) == 1 else f"{name}.{i}")

    def _place(self, index: int, node: Element, mesh: Element, to_world: Matrix) -> _Place:
        with np.errstate(all="ignore"):
            matrices = to_world @ instances(node, self._accessors)
        if not np.isfinite(matrices).all():
            raise EclatError(
                f"{node.where}: expected finite transforms of the instances, got an overflow: the product of the scales "
                "is too large"
            )
        return _Place(index, matrices, False, _weights(node, mesh), node.text("name"))

    def _skinned_place(self, index: int, node: Element, mesh: Element, places: dict[int, Matrix]) -> _Place | None:
        """Return the place of a mesh with a skin, whose node's transform has no effect; None without a valid skin."""
        try:
            joints = joint_matrices(self._document, self._accessors, node, places)
        except EclatError as error:
            warn(f"{error}; the mesh is loaded without its skin")
            return None
        return None if joints is None else _Place(index, joints, True, _weights(node, mesh), node.text("name"))

    def _add_primitive(self, element: Element, number: int, place: _Place, name: str) -> None:
        parts = self._parts_of(element, place.weights, place.skinned)
        copies = place.matrices[None] if place.skinned else place.matrices
        for primitive, _ in parts:
            spend(_transformed_size(primitive) * len(copies), element.where)
        animated = self._sources.channels is not None
        for i, matrix in enumerate(copies):
            flat = not place.skinned and np.linalg.matrix_rank(matrix[:3, :3]) < 2
            if flat and not animated:
                warn(
                    f"{element.where}: the transform of a node scales the mesh to a line or a point; this instance is "
                    "left out"
                )
                continue
            for part, (primitive, material) in enumerate(parts):
                key = (place.node, number, i, part)
                if flat:
                    made = _flat(primitive, material, place, matrix, name)
                else:
                    made = self._placed(key, primitive, material, place, matrix, name)
                self._keep(key, made, element, place)

    def _keep(self, key: Hashable, made: Made, element: Element, place: _Place) -> None:
        self._made[key] = made
        self._meshes[key] = made[1]
        index = element.index("material", len(self._document.elements("materials")), "materials")
        self.origins[key] = Origin(place.node, index)

    def _placed(
        self, key: Hashable, primitive: Primitive, material: Material, place: _Place, matrix: Matrix, name: str
    ) -> Made:
        """Make a mesh in world space, or return that of the rest pose if it has not changed."""
        signature = (place.skinned, place.weights, matrix.tobytes(), id(material))
        resting = (self._sources.resting or {}).get(key)
        if resting is not None and resting[0] == signature:
            return resting
        if place.skinned:
            mesh = bend_primitive(primitive, matrix, material, name)
        else:
            mesh = transform_primitive(primitive, matrix, material, name)
        return signature, replace(mesh, lamp=place.lamp)

    def _parts_of(self, element: Element, weights: tuple[float, ...], skinned: bool) -> list[Part]:
        """Return the parts of a primitive that have one material each. There are none if it has no triangles."""
        note = element.eclat_extras()
        if note is not None and note.flag("back_side"):
            return []  # The primitive that holds the front side gets a two-sided material instead.
        key = (element.where, weights, skinned)
        read = self._primitives.get(key)
        if read is None:
            primitive = read_primitive(element, self._accessors, weights, self._document.second_uv_set, skinned)
            if primitive is None:
                return []
            read = self._primitives[key] = self._split(element, primitive)
        elif read.material is not self._materials.of(element, read.whole.colors is not None):
            read = self._primitives[key] = self._split(element, read.whole)
        return read.parts

    def _split(self, element: Element, primitive: Primitive) -> _Read:
        material = self._materials.of(element, primitive.colors is not None)
        for uv_set in sorted(used_uv_sets(material)):
            if (primitive.uvs, primitive.uvs2)[uv_set] is None:
                warn(
                    f"{element.where}: the material uses TEXCOORD_{uv_set}, which the primitive does not have; (0, 0) is "
                    "used for all vertices"
                )
        if primitive.colors is not None and self._materials.ignores_alpha(element):
            primitive.colors[:, 3] = 1
        solids = self._sources.solids
        if element.where not in solids:
            solids[element.where] = solid_triangles(primitive, material)
        return _Read(primitive, material, split_solids_and_sheets(primitive, material, solids[element.where]))

    def _add_light(self, index: int, node: Element, reference: Element, to_world: Matrix) -> None:
        number = reference.index("light", len(self._known_lights), "lights")
        if number is None:
            raise EclatError(f"{reference.where}: expected the index of a light as 'light', but it is missing")
        light = self._known_lights[number]
        key = ("light", index)
        self._lights[key] = read_light(light, to_world, node.text("name") or light.text("name"))
        self.origins[key] = Origin(index, number)

    def _add_profile_light(self, index: int, node: Element, reference: Element, to_world: Matrix) -> None:
        number = reference.index("light", len(self._known_profiles), "lights")
        if number is None:
            raise EclatError(f"{reference.where}: expected the index of a light as 'light', but it is missing")
        element, known = self._known_profiles[number], self._sources.profiles
        if number not in known:
            view = self._document.buffer_view(element)
            data = self._document.uri_bytes(element.text("uri"), element.where) if view is None else bytes(view[0])
            known[number] = parse_ies(data, element.where)
        key = ("profile", index)
        name = node.text("name") or element.text("name")
        self._lights[key] = read_profile_light(reference, known[number], to_world, name)
        self.origins[key] = Origin(index, None)

    def _add_camera(self, index: int, node: Element, to_world: Matrix) -> None:
        camera = self._document.element(node, "camera", "cameras")
        if camera is not None:
            name = node.text("name") or camera.text("name") or camera.where.partition(", ")[2]
            key = ("camera", index)
            self._cameras[key] = read_camera(camera, to_world, name)
            number = node.index("camera", len(self._document.elements("cameras")), "cameras")
            self.origins[key] = Origin(index, number)


def _flat(primitive: Primitive, material: Material, place: _Place, matrix: Matrix, name: str) -> Made:
    """Make a mesh without triangles for an instance that is scaled to a line or a point, and that may grow later."""
    shifted = np.eye(4)
    shifted[:3, 3] = matrix[:3, 3]
    mesh = transform_primitive(primitive, shifted, material, name)
    return ("flat", matrix.tobytes(), id(material)), replace(mesh, triangles=mesh.triangles[:0], lamp=place.lamp)


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
