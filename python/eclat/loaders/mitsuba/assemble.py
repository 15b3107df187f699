# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Build a `Scene` from the tree of nodes, and warn about properties and objects that are not used."""

from __future__ import annotations

from collections import defaultdict

from eclat.errors import did_you_mean, warn
from eclat.loaders.mitsuba.emitters import make_emitter, merge_environments
from eclat.loaders.mitsuba.kinds import IGNORED_TAGS, PLUGINS, SILENT_PROPERTIES
from eclat.loaders.mitsuba.node import Node
from eclat.loaders.mitsuba.sensors import make_camera, up_axis
from eclat.loaders.mitsuba.settings import warn_about_settings
from eclat.loaders.mitsuba.shapes import Shapes
from eclat.loaders.mitsuba.tessellation import Tessellation
from eclat.loaders.parts import Parts
from eclat.scene import Camera, Environment, Light, Mesh, Scene


def assemble(tree: Node, name: str) -> Scene:
    """Build the scene called `name` from `tree`, whose root has the tag scene and whose references are resolved.

    A shape or an emitter that is invalid is left out with a warning. Raises EclatError if all of them are invalid.
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
    warn_about_settings(tree)
    up = up_axis(cameras[0]) if cameras else (0.0, 1.0, 0.0)
    return Scene(tuple(meshes), tuple(lights), environment, tuple(cameras), name, up)


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
