# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Replacement of materials of a scene by name, for example to give a model a polished floor."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from eclat.errors import EclatError, did_you_mean, shown
from eclat.loaders.mitsuba import load_material
from eclat.scene import Material, Mesh, Scene, Value
from eclat.typed import typed

_BASE_COLOURS = ("reflectance", "diffuse_reflectance", "base_color")
"""Names of the parameters that hold the base colour in the various kinds of material."""

_LISTED = 24
"""Largest number of names that a message lists."""


def material_names(scene: Scene) -> list[str]:
    """List the names that `override_materials` accepts: those of materials, and those of meshes whose material has no
    name."""
    names = (mesh.material.name or mesh.name for mesh in scene.meshes)
    return [name for name in dict.fromkeys(names) if name]


@typed
def override_materials(
    scene: Scene,
    materials: Mapping[str, Mapping[str, Any] | Material],
    base_folder: str | os.PathLike[str] | None = None,
) -> Scene:
    """Replace some materials of a scene, which may come from any kind of file.

    Parameters
    ----------
    materials : maps the name of a material or of a mesh (`material_names` lists them) to its replacement. This is a
        `Material`, which is used unchanged, or a bsdf as in `load_dict`, such as `{"type": "roughplastic", "alpha":
        0.2}`. Properties that a bsdf does not give keep their values: the base colour with its texture, opacity, bumps,
        emission, and whether the material is two-sided.
    base_folder : folder to which file names in `materials` are relative, by default the current folder.

    Raises
    ------
    EclatError : the scene has no material or mesh of that name, the kind of bsdf or a property is unknown, or a value
        is invalid.

    Examples
    --------
    >>> import eclat
    >>> floor = {"type": "roughconductor", "distribution": "ggx", "alpha": 0.2}
    >>> scene = eclat.override_materials(eclat.load("cornell-box"), {"floor": floor})
    """
    by_material = {mesh.material.name for mesh in scene.meshes if mesh.material.name}
    by_mesh = {mesh.name for mesh in scene.meshes if mesh.name}
    for name in materials:
        if name not in by_material | by_mesh:
            known = [*material_names(scene), *sorted(by_mesh - by_material)]
            raise EclatError(
                f"material {name!r}: expected one of {_listed(dict.fromkeys(known))}{did_you_mean(name, known)}"
            )
    folder = Path() if base_folder is None else Path(base_folder)
    made: dict[tuple[str, int], Material] = {}

    def changed(mesh: Mesh) -> Mesh:
        name = next((n for n in (mesh.material.name, mesh.name) if n in materials), None)
        if name is None:
            return mesh
        # Meshes that share a material still share its replacement, because the core stores each material once.
        key = name, id(mesh.material)
        if key not in made:
            made[key] = _in_place_of(mesh.material, name, materials[name], folder)
        return replace(mesh, material=made[key])

    return replace(scene, meshes=tuple(changed(mesh) for mesh in scene.meshes))


def parsed_override(text: str) -> tuple[str, dict[str, Any]]:
    """Parse `NAME=KIND,property=value,…` into the name and the bsdf; the numbers of a colour are separated by blanks.

    Raises EclatError if the text has another form.
    """
    name, equals, rest = text.partition("=")
    kind, *settings = (part.strip() for part in rest.split(","))
    if not (name.strip() and equals and kind) or "=" in kind:
        raise EclatError(f"expected NAME=KIND,property=value,… such as floor=roughplastic,alpha=0.2, got {text!r}")
    bsdf: dict[str, Any] = {"type": kind}
    for setting in settings:
        key, equals, value = (part.strip() for part in setting.partition("="))
        if not (key and equals and value):
            raise EclatError(f"{name.strip()}: expected property=value after the kind, got {setting!r}")
        if key in bsdf:
            raise EclatError(f"{name.strip()}: {key} is given twice, expected it once")
        bsdf[key] = _value(value)
    return name.strip(), bsdf


def _value(text: str) -> Any:
    """Convert a text to a number, a colour of three numbers, or a word."""
    try:
        numbers = [float(part) for part in text.split()]
    except ValueError:
        return text
    return {"type": "rgb", "value": numbers} if len(numbers) == 3 else numbers[0] if len(numbers) == 1 else text


def _in_place_of(old: Material, name: str, given: Mapping[str, Any] | Material, folder: Path) -> Material:
    if isinstance(given, Material):
        return given
    if not isinstance(given, Mapping):
        raise EclatError(f"material {name!r}: expected a Material or a dict, got {shown(given)}")
    try:
        new = load_material(given, folder)
    except EclatError as error:
        raise EclatError(f"material {name!r}: {error}") from None
    return replace(
        _with_base_colour(_on_sides_of(old, new), _base_colour(old), given),
        name=old.name, opacity=old.opacity, alpha_cutoff=old.alpha_cutoff, vertex_colors=old.vertex_colors,
        normal_map=new.normal_map or old.normal_map, emission=old.emission, emission_two_sided=old.emission_two_sided,
        hidden_from_camera=old.hidden_from_camera,
    )  # fmt: skip


def _on_sides_of(old: Material, new: Material) -> Material:
    sides = new.two_sided or old.two_sided
    children = tuple(_on_sides_of(old, child) for child in new.children)
    return replace(new, two_sided=sides, back_culled=old.back_culled, children=children)


def _base_colour(material: Material) -> Value | None:
    """Return the base colour of the material, or of the first of its parts that has one, or None."""
    for name in _BASE_COLOURS:
        if name in material.parameters:
            return material.parameters[name]
    return next((colour for child in material.children if (colour := _base_colour(child)) is not None), None)


def _with_base_colour(material: Material, colour: Value | None, given: Mapping[str, Any]) -> Material:
    said = any(name in given for name in _BASE_COLOURS)
    own = next((name for name in _BASE_COLOURS if name in material.parameters), None)
    if said or own is None or colour is None:
        return material
    return replace(material, parameters=material.parameters | {own: colour})


def _listed(names: Iterable[str]) -> str:
    shown = list(names)
    more = f" and {len(shown) - _LISTED} more" if len(shown) > _LISTED else ""
    return (", ".join(shown[:_LISTED]) + more) or "no name, because nothing in the scene has one"
