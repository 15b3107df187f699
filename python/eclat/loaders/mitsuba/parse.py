# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read XML files of all versions of Mitsuba into a tree of nodes.

This includes default values, parameters, included files, aliases and references.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from eclat.errors import EclatError, did_you_mean, warn
from eclat.loaders.budget import spend
from eclat.loaders.mitsuba.elements import Element, read_elements
from eclat.loaders.mitsuba.moving import MovingTransform
from eclat.loaders.mitsuba.node import MAX_DEPTH, Node, parse_boolean, parse_number, parse_vector, snake_case
from eclat.loaders.mitsuba.references import Identifiers, resolve_references
from eclat.loaders.mitsuba.spectra import parse_blackbody, parse_rgb, parse_spectrum, read_spd
from eclat.loaders.mitsuba.transforms import read_transform

OBJECT_TAGS = {
    **{tag: tag for tag in ("scene", "shape", "bsdf", "texture", "emitter", "sensor", "film", "sampler", "integrator")},
    **{tag: tag for tag in ("rfilter", "medium", "phase", "volume", "subsurface", "spectrum")},
    "luminaire": "emitter",
    "background": "emitter",
    "camera": "sensor",
}
"""The XML tags of objects, and Mitsuba's current name of each. The last three tags are old names or come from other
renderers."""

_LIGHT_OF_DIALECTS = ("radiance", "intensity")
"""The tags that the renderers lajolla and torrey use for the colour of a light. The tag is the name of the property."""

_MAX_INCLUDES = 1000
"""The largest number of included files. Real scenes have fewer than a hundred."""
_MAX_EXPANDED = 1 << 14
"""The largest number of characters in an attribute after the substitution of parameters. Without a limit, parameters
that contain each other twice could fill the memory."""

_NODE_SIZE = 1 << 11
"""The number of bytes that an object of the scene takes, with its properties. Files that are included many times would
otherwise fill the memory."""


def parse_xml(path: Path, parameters: dict[str, str]) -> Node:
    """Read an XML scene into a tree of nodes, and resolve its references.

    `parameters` are the values of `$name`. Raises EclatError with the file and the line.
    """
    parser = _Parser(path, parameters)
    scene = Node("scene", "scene", path.name, parser.folders)
    parser.file(path, scene, str(path), (), 0)
    for name in parameters.keys() - parser.read_parameters:
        warn(f"{path.name}: the parameter {name!r} is not used{did_you_mean(name, parser.read_parameters)}")
    resolve_references(scene, parser.identifiers)
    return scene


class _Parser:
    def __init__(self, path: Path, parameters: dict[str, str]) -> None:
        self.folders: tuple[Path, ...] = (path.parent,)
        self.parameters = dict(parameters)
        self.read_parameters: set[str] = set()
        self.identifiers = Identifiers()
        self.includes = 0
        self.legacy = False

    def file(self, path: Path, scene: Node, where: str, stack: tuple[Path, ...], depth: int) -> None:
        """Read the file at `path` and add its objects to `scene`.

        `stack` are the files that include this one, `where` is the element that includes it, and `depth` is the
        nesting depth. Files that it names are also searched in the folders of the including files.
        """
        real = path.resolve()
        if real in stack:
            raise EclatError(f"{where}: the file {path.name} includes itself")
        self.includes += 1
        if self.includes > _MAX_INCLUDES:
            raise EclatError(f"{where}: expected at most {_MAX_INCLUDES} included files, got more")
        root = read_elements(path, where)
        if path.parent not in self.folders:
            self.folders = (*self.folders, path.parent)
        if OBJECT_TAGS.get(root.tag) != "scene":
            if not stack:
                raise EclatError(f"{root.where}: expected the root element <scene>, got <{root.tag}>")
            self.child(root, scene, (*stack, real), depth + 1)
            return
        if not stack:
            self.legacy = _is_legacy(root)
        for child in root.children:
            self.child(child, scene, (*stack, real), depth + 1)

    def child(self, element: Element, parent: Node, stack: tuple[Path, ...], depth: int) -> None:
        """Add the property or the object in `element` to the node `parent`, or execute the directive in it."""
        if depth > MAX_DEPTH:
            raise EclatError(
                f"{element.where}: expected at most {MAX_DEPTH} levels of nested elements and included files, got more"
            )
        element.attributes = {key: self.expand(value, element) for key, value in element.attributes.items()}
        tag, attributes = element.tag, element.attributes
        if tag == "background":
            attributes.setdefault("type", "constant")
        if tag in _LIGHT_OF_DIALECTS and parent.tag == "emitter":
            parent.properties[tag] = _rgb(element)
        elif tag == "include":
            self.include(element, parent, stack, depth)
        elif tag == "default":
            self.parameters.setdefault(_needed(element, "name"), attributes.get("value", ""))
        elif tag == "alias":
            self.identifiers.alias(_needed(element, "id"), _needed(element, "as"), element.where)
        elif tag == "path":
            self.folders = (*self.folders, self.folders[0] / _needed(element, "value", "filename"))
        elif tag == "ref":
            target = Node("ref", "", element.where, self.folders, id=_needed(element, "id"))
            # The name distinguishes references from BSDFs that are defined in a shape of type obj (see mesh_files.py).
            parent.children.append((attributes.get("name", "ref"), target))
        elif tag in OBJECT_TAGS and ("type" in attributes or tag not in ("spectrum", "scene")):
            self.object(element, parent, stack, depth)
        elif tag in _PROPERTIES or tag in ("transform", "animation"):
            self.property(element, parent)
        else:
            known = [*OBJECT_TAGS, *_PROPERTIES, "transform", "include", "default", "alias", "ref", "path"]
            warn(f"{element.where}: this element is unknown and is ignored{did_you_mean(tag, known)}")

    def include(self, element: Element, parent: Node, stack: tuple[Path, ...], depth: int) -> None:
        name = _needed(element, "filename")
        path = Node("include", "", element.where, self.folders, properties={"filename": name}).file("filename")
        self.file(path, parent, element.where, stack, depth)

    def object(self, element: Element, parent: Node, stack: tuple[Path, ...], depth: int) -> None:
        attributes = element.attributes
        spend(_NODE_SIZE, element.where)
        node = Node(OBJECT_TAGS[element.tag], _needed(element, "type"), element.where, self.folders)
        node.id, node.legacy = attributes.get("id", ""), self.legacy
        for child in element.children:
            self.child(child, node, stack, depth + 1)
        self.identifiers.add(node.id, node)
        parent.children.append((attributes.get("name", ""), node))

    def property(self, element: Element, parent: Node) -> None:
        """Set the property in `element` on the node `parent`."""
        name = element.attributes.get("name")
        if name is None and element.tag in ("transform", "animation"):
            name = "to_world"
        if name is None:
            warn(f"{element.where}: this property has no name and is ignored")
            return
        if parent.tag == "scene":
            return  # no property of the scene itself affects the image
        parent.properties[snake_case(name)] = self.value(element)

    def value(self, element: Element) -> Any:
        if element.tag == "animation":
            return self.animation(element)
        if element.tag == "transform":
            for step in element.children:
                step.attributes = {key: self.expand(value, step) for key, value in step.attributes.items()}
            return read_transform(element)
        if element.tag == "spectrum" and "filename" in element.attributes:
            holder = Node("spectrum", "", element.where, self.folders, properties=dict(element.attributes))
            return read_spd(holder.file("filename"), element.where)
        return _PROPERTIES[element.tag](element)

    def animation(self, element: Element) -> Any:
        """Read an animated transform, or a matrix if only one key is valid. Keys are sorted by time, as in Mitsuba."""
        keys: dict[float, Any] = {}
        for frame in (child for child in element.children if child.tag == "transform"):
            try:
                text = self.expand(_needed(frame, "time"), frame)
                matrix = self.value(frame)
                if keys.setdefault(parse_number(text, frame.where), matrix) is not matrix:
                    raise EclatError(f"{frame.where}: expected keys at different times, got another one at {text} s")
            except EclatError as error:
                warn(f"{error}; this key of the animation is left out")
        if not keys:
            warn(f"{element.where}: the animation has no valid key; the object is not transformed")
            return np.eye(4)
        times = sorted(keys)
        moving = MovingTransform.of(times, [keys[time] for time in times])
        return moving if moving.moves else keys[times[0]]

    def expand(self, text: str, element: Element) -> str:
        """Replace every `$name` in `text` by its value. Raises EclatError if a name has no value."""
        if "$" not in text:
            return text
        expanded = re.sub(r"\$\{?(\w+)\}?", lambda match: self.parameter(match[1], element), text)
        if len(expanded) > _MAX_EXPANDED:
            raise EclatError(
                f"{element.where}: expected at most {_MAX_EXPANDED} characters in an attribute after the substitution "
                f"of parameters, got {len(expanded)}"
            )
        return expanded

    def parameter(self, word: str, element: Element) -> str:
        """Return the value of the parameter `word`.

        If there is no such parameter, the longest parameter name that `word` starts with is replaced and the rest of
        `word` is kept, as in Mitsuba.
        """
        for end in range(min(len(word), 200), 0, -1):
            if word[:end] in self.parameters:
                self.read_parameters.add(word[:end])
                return self.parameters[word[:end]] + word[end:]
        raise EclatError(
            f"{element.where}: the parameter ${word[:60]} has neither a value nor a <default>; pass a value for it"
            f"{did_you_mean(word[:60], self.parameters)}"
        )


def _is_legacy(root: Element) -> bool:
    version = root.attributes.get("version")
    if version is None:
        warn(f"{root.where}: the attribute version is missing; version 3.0.0 is assumed")
        return False
    match = re.match(r"\s*(\d+)\.", version + ".")
    if not match:
        raise EclatError(f"{root.where}: expected a version like 3.0.0, got {version[:40]!r}")
    return int(match[1]) < 2


def _needed(element: Element, *names: str) -> str:
    """Return the value of the first attribute in `names` that `element` has. Raises EclatError if it has none of them."""
    for name in names:
        if name in element.attributes:
            return element.attributes[name]
    raise EclatError(f"{element.where}: expected the attribute {' or '.join(names)}, got none")


def _number(element: Element) -> float:
    return parse_number(_needed(element, "value"), element.where)


def _vector(element: Element) -> tuple[float, float, float]:
    if "value" in element.attributes:
        return parse_vector(element.attributes["value"], element.where)
    x, y, z = (parse_number(element.attributes.get(axis, "0"), element.where) for axis in "xyz")
    return x, y, z


def _rgb(element: Element) -> Any:
    if "value" not in element.attributes and "r" in element.attributes:
        text = " ".join(element.attributes.get(channel, "0") for channel in "rgb")
        return parse_rgb(text, element.where, encoded=element.tag == "srgb")
    return parse_rgb(_needed(element, "value"), element.where, encoded=element.tag == "srgb")


def _blackbody(element: Element) -> Any:
    scale = parse_number(element.attributes.get("scale", "1"), element.where)
    return parse_blackbody(_needed(element, "temperature", "value"), scale, element.where)


_PROPERTIES = {
    "float": _number,
    "integer": _number,
    "boolean": lambda element: parse_boolean(_needed(element, "value"), element.where),
    "string": lambda element: _needed(element, "value"),
    "point": _vector,
    "vector": _vector,
    "rgb": _rgb,
    "srgb": _rgb,
    "spectrum": lambda element: parse_spectrum(_needed(element, "value", "intensity"), element.where),
    "blackbody": _blackbody,
    "color": _rgb,
}
