# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Mistakes in scenes that are built in Python, each with a message that says what was expected and where."""

from __future__ import annotations

import weakref
from collections.abc import Iterable
from dataclasses import fields

import numpy as np

from eclat.errors import EclatError, did_you_mean, shown, warn
from eclat.measured_brdf import MerlBrdf, RglBrdf
from eclat.scene import MATERIAL_KINDS, Light, Material, Mesh, Scene, Value

_THREE_NUMBERS = ("position", "direction", "intensity", "irradiance")
"""Fields of lights that hold three numbers each."""

_checked: weakref.WeakSet[Scene] = weakref.WeakSet()


def check_scene(scene: Scene) -> None:
    """Check what the conversion to the core takes for granted. A scene that has been checked is not checked again.

    Parameters of a material that its kind does not have are ignored, with a warning.

    Raises
    ------
    EclatError : a mesh has no arrays of the right shape, or names vertices that it does not have; the kind of a material is
        unknown, a parameter is no Value, or it lacks its children or its measurement; or a light lacks three numbers.
    """
    if scene in _checked:
        return
    seen: set[int] = set()
    for number, mesh in enumerate(scene.meshes):
        _check_mesh(mesh, f"mesh {number}")
        _check_material(mesh.material, seen)
    for number, light in enumerate(scene.lights):
        _check_light(light, f"light {number}")
    _checked.add(scene)


def _check_mesh(mesh: Mesh, what: str) -> None:
    if not isinstance(mesh, Mesh):
        raise EclatError(f"{what}: expected a Mesh, got {shown(mesh)}")
    what += f" {mesh.name!r}" if mesh.name else ""
    for name, kinds, noun in (("positions", "fiu", "numbers"), ("triangles", "iu", "whole numbers")):
        array = getattr(mesh, name)
        if not isinstance(array, np.ndarray):
            raise EclatError(f"{what}: expected {name} as a NumPy array of shape (N, 3), got a {type(array).__name__}")
        if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in kinds:
            raise EclatError(
                f"{what}: expected {name} of shape (N, 3) with {noun}, got {array.shape} with {array.dtype}"
            )
    count = len(mesh.positions)
    if len(mesh.triangles) and not 0 <= mesh.triangles.min() <= mesh.triangles.max() < count:
        row = int(np.argmax(((mesh.triangles < 0) | (mesh.triangles >= count)).any(axis=1)))
        raise EclatError(
            f"{what}: triangle {row}: expected vertices 0 to {count - 1}, got {mesh.triangles[row].tolist()}"
        )


def _check_material(material: Material, seen: set[int]) -> None:
    if id(material) in seen:
        return
    seen.add(id(material))
    if not isinstance(material, Material):
        raise EclatError(f"material: expected a Material, got {shown(material)}")
    what, kind = f"material {material.name!r}", material.kind
    if kind not in MATERIAL_KINDS:
        raise EclatError(
            f"{what}: expected a kind among {', '.join(MATERIAL_KINDS)}, got {kind!r}{did_you_mean(str(kind), MATERIAL_KINDS)}"
        )
    if kind == "measured" and not isinstance(material.measured, MerlBrdf | RglBrdf):
        raise EclatError(f"{what}: expected `measured` as eclat.load_brdf returns it, got {shown(material.measured)}")
    wanted = 2 if kind == "blend" else 0
    if len(material.children) != wanted:
        raise EclatError(f"{what}: expected {wanted} children for the kind {kind!r}, got {len(material.children)}")
    for name, value in material.parameters.items():
        if not isinstance(value, Value):
            raise EclatError(
                f"{what}, {name}: expected a Value, such as grey(0.5) or rgb(1, 0.5, 0), got {shown(value)}"
            )
    _warn_of_unknown(what, material)
    for part in (*material.children, *([] if material.back is None else [material.back])):
        _check_material(part, seen)


def _warn_of_unknown(what: str, material: Material) -> None:
    known = MATERIAL_KINDS[material.kind]
    unknown = [name for name in material.parameters if name not in known]
    if unknown:
        near: Iterable[str] = (did_you_mean(name, known) for name in unknown)
        warn(
            f"{what}: the kind {material.kind!r} has no parameter {', '.join(unknown)}, which is ignored"
            f"{next((text for text in near if text), '')}"
        )


def _check_light(light: Light, what: str) -> None:
    what += f" {light.name!r}" if getattr(light, "name", "") else ""
    names = {field.name for field in fields(light)} if hasattr(light, "__dataclass_fields__") else set()
    for name in _THREE_NUMBERS:
        if name not in names:
            continue
        try:
            value = np.asarray(getattr(light, name), np.float64)
        except (TypeError, ValueError):
            value = np.zeros(0)
        if value.shape != (3,):
            raise EclatError(f"{what}: expected three numbers as {name}, got {shown(getattr(light, name))}")
