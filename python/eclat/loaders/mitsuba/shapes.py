# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Convert shapes to meshes in world space, with materials and area lights."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from eclat.errors import EclatError, did_you_mean, warn
from eclat.loaders.budget import size_of, spend
from eclat.loaders.mitsuba import primitives
from eclat.loaders.mitsuba.kinds import PLUGINS
from eclat.loaders.mitsuba.materials import Materials, default_material
from eclat.loaders.mitsuba.mesh_files import MESH_FILES, load_mesh_file
from eclat.loaders.mitsuba.node import Node
from eclat.loaders.mitsuba.placement import transform_mesh
from eclat.loaders.mitsuba.primitives import SEGMENTS
from eclat.loaders.mitsuba.tessellation import Tessellation
from eclat.loaders.mitsuba.transforms import Matrix, is_singular, normalize
from eclat.scene import Material, Mesh, Value, grey

_MAX_COORDINATE = 1e18
"""The largest absolute value of a coordinate. The square of a distance must not overflow float32."""


@dataclass
class Shapes:
    """The converter of the shapes of a scene. It keeps converted materials and groups."""

    materials: Materials = field(default_factory=Materials)
    groups: dict[int, list[Mesh]] = field(default_factory=dict)
    lit: dict[tuple[int, int], tuple[Material, Material]] = field(default_factory=dict)
    """The emissive copies of materials, by the `id` of the material and of the emitter. The second material is the
    original one. It is kept alive here, so that no other object gets its `id`."""
    tessellation: Tessellation | None = None
    """The number of segments of each round shape. If it is None, all have the default number."""
    moving: frozenset[int] = frozenset()
    """The nodes, by `id`, that move over time. The files of their meshes are read once and kept."""
    hide_emitters: bool = False
    """Whether lamps of an extent are hidden from cameras."""
    loaded: dict[int, list[Mesh]] = field(default_factory=dict)
    """The meshes from files of moving nodes, by the `id` of the node, before they are transformed."""

    def later(self) -> Shapes:
        """Return a converter for another time, which shares all that does not move."""
        return replace(self, groups={key: made for key, made in self.groups.items() if key not in self.moving})

    def of(self, node: Node) -> list[Mesh]:
        """Convert a shape to meshes. A shape whose type is not supported gives none, with a warning.

        Raises
        ------
        EclatError : a file or a value is invalid.
        LimitError : the scene has too much geometry for the size of its files.
        """
        if node.type == "shapegroup":
            return []  # only its instances are visible
        if node.type == "instance":
            return self._instance(node)
        if node.type == "merge":
            return [mesh for _, child in node.of_tag("shape") for mesh in self.of(child)]
        if node.type in MESH_FILES:
            meshes = [self._in_world(mesh, node) for mesh in self._from_file(node)]
        elif node.type in _PRIMITIVES:
            meshes = self._primitive(node)
        else:
            near = "" if node.type in PLUGINS["shape"] else did_you_mean(node.type, PLUGINS["shape"])
            warn(f"{node.where}: the shape type {node.type!r} is not supported{near}; the shape is left out")
            return []
        _check_coordinates(meshes, node)
        spend(sum(size_of(mesh) for mesh in meshes), node.where)
        lamp = _lamp(node)
        return [replace(mesh, material=self._lit(mesh.material, node), lamp=lamp or mesh.lamp) for mesh in meshes]

    def _instance(self, node: Node) -> list[Mesh]:
        groups = [child for _, child in node.of_tag("shape")]
        if len(groups) != 1 or groups[0].type != "shapegroup":
            raise EclatError(f"{node.where}: expected one nested shapegroup, got {[group.type for group in groups]}")
        group = groups[0]
        if id(group) not in self.groups:
            self.groups[id(group)] = [mesh for _, child in group.of_tag("shape") for mesh in self.of(child)]
        meshes = self.groups[id(group)]
        matrix = self._to_world(node)
        spend(sum(size_of(mesh) for mesh in meshes), node.where)
        copies = [transform_mesh(mesh, matrix) for mesh in meshes]
        _check_coordinates(copies, node)
        return copies

    def _primitive(self, node: Node) -> list[Mesh]:
        segments = SEGMENTS if self.tessellation is None else self.tessellation.segments(node)
        made = _PRIMITIVES[node.type](node, segments)
        if made is None:
            return []
        surface, matrix = made
        material = self._bsdf(node)
        tangents = None
        if material.normal_map is not None and material.normal_map.kind == "normal":
            # In Mitsuba, the bitangent is always normal × tangent, and does not depend on the direction of v.
            tangents = np.concatenate([surface.tangents, np.ones((len(surface.tangents), 1))], axis=1)
        mesh = Mesh(
            surface.positions,
            surface.triangles,
            material,
            normals=surface.normals,
            uvs=surface.uvs,
            tangents=tangents,
            name=node.id or node.type,
        )
        mesh = transform_mesh(mesh, self._to_world(node) @ matrix)
        if node.boolean("face_normals", default=False):
            mesh = replace(mesh, normals=None)
        return [self._flipped(mesh, node)]

    def _from_file(self, node: Node) -> list[Mesh]:
        if id(node) not in self.moving:
            return load_mesh_file(node, self.materials)
        if id(node) not in self.loaded:
            self.loaded[id(node)] = load_mesh_file(node, self.materials)
        return self.loaded[id(node)]

    def _in_world(self, mesh: Mesh, node: Node) -> Mesh:
        name = node.id or mesh.name
        return self._flipped(replace(transform_mesh(mesh, self._to_world(node)), name=name), node)

    def _flipped(self, mesh: Mesh, node: Node) -> Mesh:
        if not node.boolean("flip_normals", default=False):
            return mesh
        normals = None if mesh.normals is None else -mesh.normals
        return replace(mesh, triangles=mesh.triangles[:, ::-1], normals=normals)

    def _to_world(self, node: Node) -> Matrix:
        matrix = node.transform("to_world")
        if is_singular(matrix) and node.type not in ("rectangle", "disk"):
            warn(f"{node.where}, to_world: the matrix is singular, so the shape becomes flat")
        elif not np.any(np.cross(matrix[:3, 0], matrix[:3, 1])):
            warn(f"{node.where}, to_world: the matrix leaves no area of the shape, so nothing of it is seen")
        return matrix

    def _bsdf(self, node: Node) -> Material:
        bsdfs = [child for _, child in node.of_tag("bsdf")]
        if len(bsdfs) > 1:
            warn(f"{node.where}: expected one BSDF, got {len(bsdfs)}; the first one is used")
        return self.materials.of(bsdfs[0]) if bsdfs else default_material(emissive=bool(list(node.of_tag("emitter"))))

    def _lit(self, material: Material, node: Node) -> Material:
        """Add the emission of the shape's area light, if it has one, to `material`."""
        emitters = [child for _, child in node.of_tag("emitter")]
        if not emitters:
            return material
        emitter = emitters[0]
        if len(emitters) > 1 or emitter.type != "area":
            types = [child.type for child in emitters]
            warn(
                f"{node.where}: expected one emitter of type area, got {types}; the first one is used as an area light"
            )
        original, key = material, (id(material), id(emitter))
        if key not in self.lit:
            radiance = self.materials.textures.value(emitter, "radiance", default=1.0, kind="emission")
            if material.opacity.texture is None and max(material.opacity.constant) == 0:
                warn(
                    f"{node.where}: an emitter with a null BSDF is not supported; the surface becomes opaque and black"
                )
                # A mask that lets all light through may have a BSDF inside, which reflects nothing in Mitsuba.
                material = Material("diffuse", {"reflectance": grey(0.0)}, name=material.name)
            radiance = _unmasked(radiance, material.opacity, node)
            self.lit[key] = replace(material, emission=radiance, hidden_from_camera=self.hide_emitters), original
        return self.lit[key][0]


def _unmasked(radiance: Value, opacity: Value, node: Node) -> Value:
    """Return the radiance that a lamp with this opacity must have to shine with `radiance`: in Mitsuba a mask thins what a
    surface reflects, but not what it emits, and here it thins both.
    """
    if opacity.texture is not None:
        warn(f"{node.where}: the lamp shines only where its mask is opaque, unlike in Mitsuba, where holes shine, too")
        return radiance
    r, g, b = (channel / opacity.constant[0] for channel in radiance.constant)
    return replace(radiance, constant=(r, g, b))


def _lamp(node: Node) -> str:
    """Return the name of a lamp: the id of the emitter, of the shape or of the BSDF; it is empty if none has one."""
    emitters = [child.id for _, child in node.of_tag("emitter")]
    bsdfs = [child.id for _, child in node.of_tag("bsdf")]
    return next(filter(None, [*emitters, node.id, *bsdfs]), "")


def _check_coordinates(meshes: list[Mesh], node: Node) -> None:
    """Raise EclatError if a coordinate is too large."""
    for mesh in meshes:
        if np.abs(mesh.positions).max(initial=0.0) > _MAX_COORDINATE:
            raise EclatError(
                f"{node.where}: expected coordinates whose absolute value is at most {_MAX_COORDINATE:g}, got larger ones"
            )


def _sphere(node: Node, segments: int) -> tuple[primitives.Surface, Matrix] | None:
    radius = node.number("radius", default=1.0)
    matrix = np.diag([radius, radius, radius, 1.0])
    matrix[:3, 3] = node.vector("center") or (0.0, 0.0, 0.0)
    if radius <= 0:
        raise node.mismatch("radius", "a number above 0", radius)
    return primitives.sphere(segments), matrix


def _cylinder(node: Node, segments: int) -> tuple[primitives.Surface, Matrix] | None:
    start = np.array(node.vector("p0") or (0.0, 0.0, 0.0))
    end = np.array(node.vector("p1") or (0.0, 0.0, 1.0))
    radius = node.positive("radius", default=1.0)
    axis = end - start
    if not np.any(axis):
        warn(f"{node.where}: the cylinder is left out, because p0 and p1 are the same point")
        return None
    side = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    across = normalize(side)
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1] = across * radius, np.cross(normalize(axis), across) * radius
    matrix[:3, 2], matrix[:3, 3] = axis, start
    if np.allclose(normalize(axis), (0, 0, 1)):
        matrix[:3, :2] = np.array([[radius, 0], [0, radius], [0, 0]])  # so that u starts at +x, as in Mitsuba
    return primitives.cylinder(segments), matrix


_PRIMITIVES = {
    "rectangle": lambda node, segments: (primitives.rectangle(), np.eye(4)),
    "cube": lambda node, segments: (primitives.cube(), np.eye(4)),
    "disk": lambda node, segments: (primitives.disk(segments), np.eye(4)),
    "sphere": _sphere,
    "cylinder": _cylinder,
}
