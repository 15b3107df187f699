# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A Blender scene, as its dependency graph evaluates it, as a scene of Éclat."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from eclat.scene import Environment, Material, Mesh, Scene

from .image_nodes import ImageReader
from .lights import Light, lamp
from .materials import Made, Materials
from .meshes import Part, placed, read_parts
from .notices import Notices
from .world import DrawWorld, environment

SOLID = ("MESH", "CURVE", "SURFACE", "FONT", "META")
"""Types of objects that Blender can make a mesh of."""

SILENT = ("EMPTY", "CAMERA", "ARMATURE", "LATTICE", "LIGHT_PROBE", "SPEAKER")
"""Types of objects that no renderer shows."""

UP = (0.0, 0.0, 1.0)


@dataclass
class Translated:
    """The scene and what could not be carried over. `sources` names the object of each mesh, "" for lamps."""

    scene: Scene
    notices: Notices
    sources: tuple[str, ...]


class _Objects:
    """The objects of a scene, whose meshes are read once for all instances."""

    def __init__(self, notices: Notices) -> None:
        self.notices, self.materials = notices, Materials(notices)
        self.meshes: list[Mesh] = []
        self.sources: list[str] = []
        self.lights: list[Light] = []
        self._parts: dict[tuple[str, int], list[Part]] = {}
        self._hidden: dict[int, tuple[Material, Material]] = {}

    def add(self, thing: Any, to_world: np.ndarray) -> None:
        """Add an evaluated object at a transform."""
        if thing.type == "LIGHT":
            self._add_lamp(thing, to_world)
        elif thing.type in SOLID:
            self._add_solid(thing, to_world)
        elif thing.type not in SILENT:
            self.notices.add(f"object {thing.name!r}", f"objects of the type {thing.type.title()} are not supported")

    def _add_lamp(self, thing: Any, to_world: np.ndarray) -> None:
        made = lamp(thing.data, to_world, thing.name, self.notices)
        if isinstance(made, Mesh):
            self._keep(made, thing, "")
        elif made is not None:
            self.lights.append(made)

    def _add_solid(self, thing: Any, to_world: np.ndarray) -> None:
        self._name_visibility(thing)
        slots = [slot.material for slot in thing.material_slots]
        found = [self.materials.of(material) for material in slots] or [self.materials.of(None)]
        maps = {made.uv_maps[0] for made in found if _needs_tangents(made.material)}
        key = (thing.name_full, 0 if thing.data is None else thing.data.as_pointer())
        if key not in self._parts:
            self._parts[key] = self._read(thing, tuple(sorted(maps)))
        for part in self._parts[key]:
            made = found[min(part.slot, len(found) - 1)]
            self._name_missing_maps(thing, part, made)
            self._keep(placed(part, to_world, made, thing.name), thing, thing.name_full)

    def _keep(self, mesh: Mesh, thing: Any, source: str) -> None:
        """Add a mesh of an object; like Cycles, the camera sees lamps only where Blender says so."""
        if not getattr(thing, "visible_camera", True):
            original = mesh.material
            if id(original) not in self._hidden:
                self._hidden[id(original)] = original, replace(original, hidden_from_camera=True)
            mesh = replace(mesh, material=self._hidden[id(original)][1])
        self.meshes.append(mesh)
        self.sources.append(source)

    def _read(self, thing: Any, tangents: tuple[str, ...]) -> list[Part]:
        mesh = thing.to_mesh()
        if mesh is None:
            return []
        try:
            return read_parts(mesh, tangents, self.notices, f"object {thing.name!r}")
        finally:
            thing.to_mesh_clear()

    def _name_missing_maps(self, thing: Any, part: Part, made: Made) -> None:
        if not made.uses_images:
            return
        for name in made.uv_maps:
            if name not in part.uvs:
                which = f"UV map {name!r}" if name else "UV map"
                self.notices.add(f"object {thing.name!r}", f"it has no {which}, which the images of a material need")

    def _name_visibility(self, thing: Any) -> None:
        flags = [
            name
            for name in ("diffuse", "glossy", "transmission", "shadow")
            if not getattr(thing, f"visible_{name}", True)
        ]
        if flags:
            hidden = ", ".join(flags)
            self.notices.add(f"object {thing.name!r}", f"it is visible, although it is hidden from rays of: {hidden}")
        for name in ("is_holdout", "is_shadow_catcher"):
            if getattr(thing, name, False):
                self.notices.add(f"object {thing.name!r}", f"{name[3:].replace('_', ' ')} is not supported")


def _needs_tangents(material: Any) -> bool:
    return material.normal_map is not None and material.normal_map.kind == "normal"


def translate(depsgraph: Any, draw_world: DrawWorld, notices: Notices) -> Translated:
    """Translate what the dependency graph holds: its objects with their modifiers, their instances, and its world.

    `draw_world` draws worlds that are neither a colour nor an image.
    """
    objects = _Objects(notices)
    for instance in depsgraph.object_instances:
        thing = instance.object
        if not instance.show_self and not instance.is_instance:
            continue
        objects.add(thing, np.array(instance.matrix_world, dtype=float))
        if thing.type in SOLID and any(system.settings.type == "HAIR" for system in thing.particle_systems):
            notices.add(f"object {thing.name!r}", "its hair is not supported")
    world = depsgraph.scene.world
    sky, sun = environment(world, ImageReader(notices), draw_world, notices)
    lights = [*objects.lights, *([] if sun is None else [sun])]
    if sky is None and not lights and not any(mesh.material.emission for mesh in objects.meshes):
        sky = Environment(np.zeros((1, 1, 3), np.float32))  # Without it, Éclat would add lamps to a dark scene.
    scene = Scene(
        tuple(objects.meshes),
        tuple(lights),
        sky,
        name=depsgraph.scene.name,
        up=UP,
    )
    return Translated(scene, notices, tuple(objects.sources))
