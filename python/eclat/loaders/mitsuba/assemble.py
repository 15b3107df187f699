# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Makes a `Scene` of the neutral tree, and warns about properties and objects that are not used."""

from __future__ import annotations

from collections import defaultdict

from eclat.errors import did_you_mean, warn
from eclat.loaders.mitsuba.emitters import Light, make_emitter, merge_environments
from eclat.loaders.mitsuba.kinds import IGNORED_TAGS, PLUGINS, SILENT_PROPERTIES
from eclat.loaders.mitsuba.node import Node
from eclat.loaders.mitsuba.sensors import make_camera, up_axis
from eclat.loaders.mitsuba.settings import tell_of_settings
from eclat.loaders.mitsuba.shapes import Shapes
from eclat.loaders.mitsuba.tessellation import Tessellation
from eclat.loaders.parts import Parts
from eclat.scene import Camera, Environment, Mesh, Scene


def assemble(tree: Node, name: str) -> Scene:
    """The scene that `tree`, of tag scene and with references resolved, describes.

    A shape or emitter that cannot be read is left out with a warning. Raises EclatError if none can be read.
    """
    shapes = Shapes(tessellation=Tessellation(tree))
    meshes: list[Mesh] = []
    lights: list[Light] = []
    cameras: list[Camera] = []
    environment: Environment | None = None
    parts = Parts()
    for _, node in tree.children:
        if node.tag == "shape":
            with parts.one():
                meshes.extend(shapes.of(node))
        elif node.tag == "emitter":
            with parts.one():
                found, surrounding = make_emitter(node, shapes.materials.textures)
                lights.extend(found)
                environment = merge_environments(environment, surrounding, node.where)
        elif node.tag == "sensor":
            camera = make_camera(node)
            cameras.extend([camera] if camera is not None else [])
        else:
            _report_object(node)
    parts.finish()
    _report_unread(tree)
    tell_of_settings(tree)
    up = up_axis(cameras[0]) if cameras else (0.0, 1.0, 0.0)
    return Scene(tuple(meshes), tuple(lights), environment, tuple(cameras), name, up)


def _report_object(node: Node) -> None:
    """Warn about an object that has no meaning for us; definitions for others to refer to have one."""
    if node.tag in ("bsdf", "texture", "spectrum", "scene"):
        return
    if node.tag not in IGNORED_TAGS:
        known = [plugin for plugins in PLUGINS.values() for plugin in plugins]
        near = did_you_mean(node.type, known) if node.tag == "unknown" else ""
        warn(f"{node.where}: an object of this kind is not supported{near}; ignored")
    elif node.type not in PLUGINS[node.tag]:
        warn(f"{node.where}: an unknown {node.tag}, ignored (the picture does not depend on it)")


def _report_unread(tree: Node) -> None:
    """Warn about given properties that are not used, once for each kind of object."""
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
            warn(f"{where[0]}{others}: the property {name!r} of a {tag} of type {kind} is not used")
        else:
            warn(f"{where[0]}{others}: a {tag} inside an object is not supported, ignored")
