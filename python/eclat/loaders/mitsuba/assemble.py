# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Build a `Scene` from the tree of nodes, and warn about properties and objects that are not used."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field, replace
from typing import TypeVar

from eclat.errors import did_you_mean, warn
from eclat.loaders.mitsuba.emitters import make_emitter, merge_environments
from eclat.loaders.mitsuba.kinds import IGNORED_TAGS, PLUGINS, SILENT_PROPERTIES
from eclat.loaders.mitsuba.moving import MovingTransform, at_time
from eclat.loaders.mitsuba.node import Node
from eclat.loaders.mitsuba.sensors import make_camera, up_axis
from eclat.loaders.mitsuba.settings import hides_emitters, warn_about_settings
from eclat.loaders.mitsuba.shapes import Shapes
from eclat.loaders.mitsuba.tessellation import Tessellation
from eclat.loaders.parts import Parts
from eclat.loaders.posing import later
from eclat.motion.animation import Motion, Pose
from eclat.scene import Camera, Environment, Light, Mesh, Scene

T = TypeVar("T")


def assemble(tree: Node, name: str) -> Scene:
    """Build the scene called `name` from `tree`, whose root has the tag scene and whose references are resolved.

    A shape or an emitter that is invalid is left out with a warning. Raises EclatError if all of them are invalid.
    """
    moving = moving_nodes(tree)
    shapes = Shapes(tessellation=Tessellation(tree), moving=frozenset(moving), hide_emitters=hides_emitters(tree))
    found = _Found()
    parts = Parts()
    for number, (_, node) in enumerate(tree.children):
        if node.tag in ("shape", "emitter"):
            with parts.one():
                found.add(number, node, shapes)
        elif node.tag == "sensor":
            found.add(number, node, shapes)
        else:
            _report_object(node)
    parts.finish()
    _report_unread(tree)
    rest = found.pose()
    warn_about_settings(tree, sky=rest.environment is not None)
    cameras = tuple(rest.cameras.values())
    up = up_axis(cameras[0]) if cameras else (0.0, 1.0, 0.0)
    return Scene(
        tuple(rest.meshes.values()), tuple(rest.lights.values()), rest.environment, cameras, name, up,
        animation=_motion(tree, shapes, moving, rest),
    )  # fmt: skip


@dataclass
class _Found:
    """The objects of the nodes that have been converted, by the number of the node among the children of the scene."""

    meshes: dict[Hashable, Mesh] = field(default_factory=dict)
    lights: dict[Hashable, Light] = field(default_factory=dict)
    cameras: dict[Hashable, Camera] = field(default_factory=dict)
    environment: Environment | None = None

    def add(self, number: int, node: Node, shapes: Shapes) -> None:
        """Convert a shape, an emitter or a sensor."""
        if node.tag == "shape":
            self.meshes |= {(number, part): mesh for part, mesh in enumerate(shapes.of(node))}
        elif node.tag == "emitter":
            lights, surrounding = make_emitter(node, shapes.materials.textures)
            self.lights |= {(number, part): light for part, light in enumerate(lights)}
            self.environment = merge_environments(self.environment, surrounding, node.where)
        else:
            camera = make_camera(node)
            self.cameras |= {} if camera is None else {(number, 0): camera}

    def pose(self) -> Pose:
        return Pose(self.meshes, self.lights, self.cameras, self.environment)


def moving_nodes(tree: Node) -> dict[int, tuple[float, float]]:
    """Return the nodes below `tree` that move or contain a node that does, by `id`, and the times of their first and last
    key in seconds.
    """
    known: dict[int, tuple[float, float] | None] = {}

    def span_of(node: Node) -> tuple[float, float] | None:
        if id(node) not in known:
            own = [value.span for value in node.properties.values() if isinstance(value, MovingTransform)]
            spans = own + [span for _, child in node.children if (span := span_of(child)) is not None]
            known[id(node)] = (min(s[0] for s in spans), max(s[1] for s in spans)) if spans else None
        return known[id(node)]

    span_of(tree)
    return {key: span for key, span in known.items() if span is not None}


def _motion(tree: Node, shapes: Shapes, moving: dict[int, tuple[float, float]], rest: Pose) -> Motion | None:
    """Return the motion of the scene, whose rest pose is given, or None if nothing moves."""
    nodes = {number: node for number, (_, node) in enumerate(tree.children) if id(node) in moving}
    nodes = {number: node for number, node in nodes.items() if node.tag in ("shape", "emitter", "sensor")}
    if not nodes:
        return None

    def pose(time: float) -> Pose:
        found, again = _Found(), shapes.later()
        with at_time(time):
            for number, node in nodes.items():
                found.add(number, node, again)

        # Materials do not change over time, but those without a BSDF in the file are made for each shape.
        kept = {key: rest.meshes[key].material for key in found.meshes.keys() & rest.meshes.keys()}
        found.meshes |= {key: replace(found.meshes[key], material=material) for key, material in kept.items()}

        def joined(old: Mapping[Hashable, T], new: Mapping[Hashable, T]) -> dict[Hashable, T]:
            return {key: value for key, value in old.items() if key[0] not in nodes} | dict(new)  # type: ignore[index]

        return Pose(
            joined(rest.meshes, found.meshes), joined(rest.lights, found.lights), joined(rest.cameras, found.cameras),
            found.environment or rest.environment,
        )  # fmt: skip

    spans = [moving[id(node)] for node in nodes.values()]
    names = {number: node.id or node.type for number, node in nodes.items()}
    return Motion(
        rest=rest,
        pose=later(pose),
        start=min(first for first, _ in spans),
        end=max(last for _, last in spans),
        objects=tuple(name for number, name in names.items() if nodes[number].tag == "shape"),
        lights=tuple(name for number, name in names.items() if nodes[number].tag == "emitter"),
        cameras=tuple(name for number, name in names.items() if nodes[number].tag == "sensor"),
    )


def _report_object(node: Node) -> None:
    """Warn about an object of the scene that is not used, unless other objects may refer to it."""
    if node.tag in ("bsdf", "texture", "spectrum", "scene"):
        return
    if node.tag not in IGNORED_TAGS:
        known = [plugin for plugins in PLUGINS.values() for plugin in plugins]
        near = did_you_mean(node.type, known) if node.tag == "unknown" else ""
        warn(f"{node.where}: objects of this kind are not supported and are ignored{near}")
    elif node.type not in PLUGINS[node.tag]:
        warn(
            f"{node.where}: the {node.tag} type {node.type!r} is unknown and is ignored; "
            "the image does not depend on it"
        )


def _report_unread(tree: Node) -> None:
    """Warn about the properties in the file that are not used, once for each type of object."""
    unread: dict[tuple[str, str, str], list[str]] = defaultdict(list)
    seen: set[int] = set()
    stack = [child for _, child in tree.children if child.tag in ("shape", "emitter", "sensor")]
    while stack:
        node = stack.pop()
        if id(node) in seen:
            continue
        seen.add(id(node))
        for _, child in node.children:
            if child.tag in ("medium", "phase", "volume", "subsurface"):
                unread[child.tag, child.type, ""].append(child.where)
            else:
                stack.append(child)
        if node.asked and node.tag not in IGNORED_TAGS:
            for name in node.properties.keys() - node.used - SILENT_PROPERTIES:
                unread[node.tag, node.type, name].append(node.where)
    for (tag, kind, name), where in sorted(unread.items()):
        others = f" (and {len(where) - 1} more)" if len(where) > 1 else ""
        if name:
            warn(f"{where[0]}{others}: the property {name!r} of the {tag} type {kind!r} is not used")
        else:
            warn(f"{where[0]}{others}: objects that contain a {tag} are not supported; the {tag} is ignored")
