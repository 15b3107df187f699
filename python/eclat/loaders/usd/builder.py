# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Visit the prims of a USD stage, and place what they show: the hierarchy, instances and point instancers."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.loaders.budget import OBJECT, spend
from eclat.loaders.gltf.primitives import Primitive, transform_primitive
from eclat.loaders.parts import LimitError, Parts
from eclat.loaders.usd import gprims
from eclat.loaders.usd.cameras import read_camera
from eclat.loaders.usd.lights import read_light
from eclat.loaders.usd.materials import Materials
from eclat.loaders.usd.meshes import Polygons, primitive_of, read_polygons
from eclat.loaders.usd.stages import Stage, guarded, matrix, pxr
from eclat.scene import Camera, Environment, Light, Material, Mesh

Matrix = NDArray[np.float64]

VISIT = 512
"""The number of bytes of the budget that a visit of a prim takes, so that nested instances of nothing end as well."""
MOST_NESTED = 32
"""The largest number of point instancers within each other."""

_SHOWN = ("default", "render")
_NOT_DRAWN = ("BasisCurves", "NurbsCurves", "HermiteCurves", "NurbsPatch", "Points", "TetMesh", "Volume")


@dataclass(frozen=True)
class _Visit:
    """A prim to be visited, and what it has from its parents."""

    prim: Any
    parent: Matrix
    purpose: str
    predicate: Any
    nested: int


class Builder:
    """The builder of a scene. After `build`, its fields hold what was found, and `parts` counts invalid parts."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._materials = Materials(stage)
        self._polygons: dict[str, Polygons] = {}
        self._made: dict[tuple[object, ...], list[tuple[Primitive, Material]]] = {}
        self.meshes: list[Mesh] = []
        self.lights: list[Light] = []
        self.environment: Environment | None = None
        self.cameras: list[Camera] = []
        self.parts = Parts()

    def build(self) -> None:
        """Visit all prims. Invalid parts are left out; `parts.finish` warns of them."""
        usd = pxr("Usd")
        unit = np.diag([self._stage.metres] * 3 + [1.0])
        root = self._stage.stage.GetPseudoRoot()
        predicate = usd.TraverseInstanceProxies(usd.PrimDefaultPredicate)
        stack = [_Visit(root, unit, "default", predicate, 0)]
        while stack:
            stack += reversed(self._visited(stack.pop()))

    def _visited(self, visit: _Visit) -> list[_Visit]:
        """Visit a prim. If it is damaged, it is left out with all below it, and there is nothing to be visited next."""
        found: list[_Visit] = []
        try:
            with guarded(self._stage.name):
                found = self._visit(visit)
        except LimitError:
            raise
        except EclatError as error:
            with self.parts.one():
                raise error
        return found

    def _visit(self, visit: _Visit) -> list[_Visit]:
        """Visit a prim. Returns what is to be visited next: its children, or the copies of a point instancer."""
        geometry, stage, prim = pxr("UsdGeom"), self._stage, visit.prim
        spend(VISIT, stage.where(prim))
        imageable = geometry.Imageable(prim)
        purpose, to_world = visit.purpose, visit.parent
        if imageable:
            if str(stage.value(imageable.GetVisibilityAttr(), "inherited")) == "invisible":
                return []
            if imageable.GetPurposeAttr().HasAuthoredValue():
                purpose = str(stage.value(imageable.GetPurposeAttr(), "default"))
        xformable = geometry.Xformable(prim)
        if xformable:
            local = matrix(xformable.GetLocalTransformation(stage.time))
            start = np.diag([stage.metres] * 3 + [1.0]) if xformable.GetResetXformStack() else visit.parent
            with np.errstate(all="ignore"):
                to_world = start @ local
            if xformable.TransformMightBeTimeVarying():
                stage.once("motion", "values that change over time are those of the first time")
        if purpose in _SHOWN:
            if prim.IsA(geometry.PointInstancer):
                copies: list[_Visit] = []
                with self.parts.one(), guarded(stage.name):
                    copies = self._copies(replace(visit, parent=to_world, purpose=purpose))
                return copies
            with self.parts.one(), guarded(stage.name):
                self._add(prim, to_world)
        children = prim.GetFilteredChildren(visit.predicate)
        return [replace(visit, prim=child, parent=to_world, purpose=purpose) for child in children]

    def _add(self, prim: Any, to_world: Matrix) -> None:
        geometry, lux, stage = pxr("UsdGeom"), pxr("UsdLux"), self._stage
        kind = str(prim.GetTypeName())
        if kind == "Mesh" or kind in gprims.TYPES:
            self._check(prim, to_world)
            self._add_mesh(prim, to_world)
        elif kind == "Camera":
            self._check(prim, to_world)
            self.cameras.append(read_camera(stage, prim, to_world))
        elif prim.HasAPI(lux.LightAPI):
            self._check(prim, to_world)
            self._add_light(prim, to_world)
        elif kind == "Skeleton":
            stage.once("skeleton", "skeletons are not supported: skinned meshes are shown as they were bound")
        elif kind in _NOT_DRAWN:
            stage.once(f"kind {kind}", f"prims of the type {kind} are not supported and are left out")
        if prim.IsA(geometry.Gprim) and prim.HasAPI(lux.MeshLightAPI):
            stage.once("mesh light", "meshes with MeshLightAPI are shown, but do not shine")

    def _check(self, prim: Any, to_world: Matrix) -> None:
        if not np.isfinite(to_world).all():
            raise EclatError(f"{self._stage.where(prim)}: expected a finite transform, got an overflow")

    def _add_light(self, prim: Any, to_world: Matrix) -> None:
        made = read_light(self._stage, prim, to_world)
        if made is None:
            return
        if made.mesh is not None:
            spend(OBJECT + made.mesh.positions.nbytes, self._stage.where(prim))
            self.meshes.append(made.mesh)
        if made.light is not None:
            self.lights.append(made.light)
        if made.environment is not None:
            if self.environment is not None:
                warn(f"{self._stage.where(prim)}: only one dome light is supported; this one is ignored")
            else:
                self.environment = made.environment

    def _add_mesh(self, prim: Any, to_world: Matrix) -> None:
        """Place the triangles of a prim. Instances share what they were read from."""
        for primitive, material in self._parts_of(prim):
            arrays = (primitive.positions, primitive.triangles, primitive.normals)
            spend(OBJECT + sum(array.nbytes for array in arrays if array is not None), primitive.where)
            if np.linalg.matrix_rank(to_world[:3, :3]) < 2:
                warn(f"{self._stage.where(prim)}: the transform scales the mesh to a line or a point; it is left out")
                return
            mesh = transform_primitive(primitive, to_world, material, prim.GetName())
            lamp = prim.GetName() if material.emission is not None else ""
            self.meshes.append(replace(mesh, lamp=lamp))

    def _parts_of(self, prim: Any) -> list[tuple[Primitive, Material]]:
        """Return the triangles of a prim by material."""
        shade = pxr("UsdShade")
        binding = shade.MaterialBindingAPI(prim)
        subsets = [subset.GetPrim() for subset in binding.GetMaterialBindSubsets()]
        bound = [shade.MaterialBindingAPI(one).ComputeBoundMaterial()[0] for one in (prim, *subsets)]
        shared = prim.GetPrimInPrototype() if prim.IsInstanceProxy() else prim
        key = (str(shared.GetPath()), *(str(one.GetPath()) if one else "" for one in bound))
        if key not in self._made:
            self._made[key] = self._read(prim, key[0], subsets, bound)
        return self._made[key]

    def _read(self, prim: Any, shared: str, subsets: list[Any], bound: list[Any]) -> list[tuple[Primitive, Material]]:
        stage, geometry = self._stage, pxr("UsdGeom")
        if shared not in self._polygons:
            self._polygons[shared] = read_polygons(stage, prim)
        polygons = self._polygons[shared]
        sided = geometry.Gprim(prim).GetDoubleSidedAttr()
        one_sided = bool(sided.HasAuthoredValue()) and not stage.value(sided, True)
        left = np.ones(len(polygons.corners), bool)
        made: list[tuple[Primitive, Material]] = []
        for subset, material in zip(subsets, bound[1:], strict=True):
            faces = np.array(stage.value(geometry.Subset(subset).GetIndicesAttr(), []), dtype=np.int64)
            chosen = np.isin(polygons.polygons, faces) & left
            left &= ~chosen
            if chosen.any():
                made.append(self._part(polygons, chosen, material, one_sided))
        if left.any():
            made.append(self._part(polygons, left, bound[0], one_sided))
        return made

    def _part(
        self, polygons: Polygons, chosen: NDArray[np.bool_], bound: Any, one_sided: bool
    ) -> tuple[Primitive, Material]:
        surface = self._materials.of(bound, one_sided)
        primitive = primitive_of(self._stage, polygons, chosen, surface.uv_sets, surface.colors)
        return primitive, surface.material

    def _copies(self, visit: _Visit) -> list[_Visit]:
        """Return a visit for each copy of a point instancer, whose prototypes are shown only by way of it."""
        usd, geometry, stage = pxr("Usd"), pxr("UsdGeom"), self._stage
        where, instancer = stage.where(visit.prim), geometry.PointInstancer(visit.prim)
        if visit.nested >= MOST_NESTED:
            raise EclatError(f"{where}: expected at most {MOST_NESTED} point instancers within each other, got more")
        prototypes = [stage.stage.GetPrimAtPath(path) for path in instancer.GetPrototypesRel().GetForwardedTargets()]
        indices = np.array(stage.value(instancer.GetProtoIndicesAttr(), []), dtype=np.int64)
        spend(VISIT * len(indices), where)
        if not len(indices):
            return []
        if indices.min() < 0 or indices.max() >= len(prototypes):
            raise EclatError(
                f"{where}: expected protoIndices below {len(prototypes)}, the number of prototypes, got others"
            )
        transforms = instancer.ComputeInstanceTransformsAtTime(
            stage.time, stage.time, geometry.PointInstancer.ExcludeProtoXform, geometry.PointInstancer.IgnoreMask
        )
        if len(transforms) != len(indices):
            raise EclatError(
                f"{where}: expected {len(indices)} positions, as many as protoIndices, got {len(transforms)}"
            )
        mask = np.array(instancer.ComputeMaskAtTime(stage.time) or [True] * len(indices), dtype=bool)
        # Prototypes may be overs or classes, which the predicate of the stage leaves out.
        predicate = usd.TraverseInstanceProxies(usd.PrimIsActive & usd.PrimIsLoaded)
        return [
            _Visit(prototypes[index], visit.parent @ matrix(transform), visit.purpose, predicate, visit.nested + 1)
            for index, transform, shown in zip(indices.tolist(), transforms, mask.tolist(), strict=True)
            if shown and prototypes[index]
        ]
