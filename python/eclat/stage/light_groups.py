# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Groups of the lamps of a scene, and for each group the scene in which only its lamps shine.

Light adds up, so the light of a scene is the sum of the light of its groups. Each group is a whole scene, which any verb and any
method can take.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase

from eclat.errors import EclatError, did_you_mean, shown
from eclat.scene import DirectionalLight, Light, Material, Mesh, Scene
from eclat.stage.surface import emits

SKY, SUN, UNNAMED, OTHERS = "sky", "sun", "unnamed", "others"
"""Names of the groups of an environment, of directional lights, and of other lamps, if these have no names of their own; and of
the group of the lamps that no group of the caller contains."""

LONGEST_NAME = 100
"""The greatest number of characters of the name of a group; a longer name of a lamp is cut. OpenEXR allows names of channels
of 255 bytes, and a character takes two bytes or, rarely, more."""


def light_groups(scene: Scene, groups: Mapping[str, str | Sequence[str]] | None = None) -> dict[str, Scene]:
    """Divide the lamps of a scene into groups; return for each group the scene in which only its lamps shine.

    The name of a lamp is that of a light or an environment, or `Mesh.lamp` of a mesh that emits, or else the name of the mesh or
    of its material. Lamps without a name are in the groups "sky" (the environment), "sun" (directional lights) and "unnamed".

    Parameters
    ----------
    scene : the scene.
    groups : the names of the lamps of each group, in which `*` and `?` stand for any characters and for one. A lamp belongs
        to the first group that names it, and those that no group names are in the group "others". None makes a group of
        each name.

    Returns
    -------
    The scenes by the name of the group. All have the surfaces and cameras of `scene`.

    Raises
    ------
    EclatError : a name is not that of a lamp, or a group contains no lamp.

    Examples
    --------
    >>> import eclat
    >>> list(eclat.light_groups(eclat.load("atrium")))
    ['sun', 'sky']
    """
    lamps = _lamps(scene)
    if groups is not None:
        lamps = _grouped(lamps, groups)
    dark: dict[int, Material] = {}
    return {name: _only(scene, name, lamps, dark) for name in dict.fromkeys(lamps.values())}


_Lamp = tuple[str, int]
"""A kind, "mesh", "light" or "environment", and the index in the scene."""


def _lamps(scene: Scene) -> dict[_Lamp, str]:
    """Return the names of all lamps."""
    named: dict[_Lamp, str] = {}
    for index, mesh in enumerate(scene.meshes):
        if emits(mesh.material):
            named["mesh", index] = mesh.lamp or mesh.name or mesh.material.name or UNNAMED
    for index, light in enumerate(scene.lights):
        named["light", index] = light.name or _nameless(light)
    if scene.environment is not None:
        named["environment", 0] = scene.environment.name or SKY
    return {lamp: name[:LONGEST_NAME] for lamp, name in named.items()}


def _nameless(light: Light) -> str:
    return SUN if isinstance(light, DirectionalLight) else UNNAMED


def _grouped(lamps: Mapping[_Lamp, str], groups: Mapping[str, str | Sequence[str]]) -> dict[_Lamp, str]:
    names = list(dict.fromkeys(lamps.values()))
    patterns: list[tuple[str, str]] = []
    for group, members in groups.items():
        if not isinstance(group, str) or not group or len(group) > LONGEST_NAME:
            raise EclatError(f"light_groups: expected a name of 1 to {LONGEST_NAME} characters, got {shown(group)}")
        for pattern in [members] if isinstance(members, str) else members:
            if not isinstance(pattern, str):
                raise EclatError(f"light_groups, {group}: expected the name of a lamp, got {shown(pattern)}")
            if not any(fnmatchcase(name, pattern) for name in names):
                known = ", ".join(names) or "none"
                hint = did_you_mean(pattern, names)
                raise EclatError(f"light_groups, {group}: expected the name of a lamp ({known}), got {pattern!r}{hint}")
            patterns.append((group, pattern))
    found = {
        lamp: next((group for group, pattern in patterns if fnmatchcase(name, pattern)), OTHERS)
        for lamp, name in lamps.items()
    }
    if empty := groups.keys() - found.values():
        raise EclatError(
            f"light_groups, {min(empty)}: expected at least one lamp that no earlier group contains, got none"
        )
    order = [*groups, OTHERS]
    return dict(sorted(found.items(), key=lambda item: order.index(item[1])))


def _only(scene: Scene, group: str, lamps: Mapping[_Lamp, str], dark: dict[int, Material]) -> Scene:
    """Return the scene in which only the lamps of the group shine; `dark` keeps the materials that were darkened."""

    def unlit(mesh: Mesh) -> Mesh:
        found = dark.get(id(mesh.material))
        if found is None:
            found = dark[id(mesh.material)] = _darkened(mesh.material)
        return replace(mesh, material=found)

    meshes = tuple(
        unlit(mesh) if lamps.get(("mesh", i), group) != group else mesh for i, mesh in enumerate(scene.meshes)
    )
    lights = tuple(light for i, light in enumerate(scene.lights) if lamps["light", i] == group)
    environment = scene.environment if lamps.get(("environment", 0)) == group else None
    return replace(scene, meshes=meshes, lights=lights, environment=environment)


def _darkened(material: Material) -> Material:
    """Return the material without its emission, and without that of its back and of the materials that it mixes."""
    back = None if material.back is None else _darkened(material.back)
    return replace(material, emission=None, back=back, children=tuple(map(_darkened, material.children)))
