# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read a scene from a dict of the form that `mitsuba.load_dict` takes into a tree of nodes.

Mitsuba need not be installed.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from eclat.errors import EclatError, did_you_mean, shown
from eclat.loaders.mitsuba import kinds
from eclat.loaders.mitsuba.node import MAX_DEPTH, Color, Node, Rgb, Uniform, check_number, snake_case
from eclat.loaders.mitsuba.references import Identifiers, resolve_references
from eclat.loaders.mitsuba.spectra import check_curve, parse_rgb, parse_spectrum, read_spd
from eclat.loaders.mitsuba.transforms import check_matrix

_IMAGE_DATA = ("bitmap", "data")
"""The properties of textures and environment maps that contain an image instead of a file name."""


def parse_dict(scene: Mapping[str, Any], folder: Path) -> Node:
    """Read a scene from a dict into a tree of nodes, and resolve its references.

    Relative file names start from `folder`. Raises EclatError with the keys that lead to the invalid entry.
    """
    if not isinstance(scene, Mapping):
        raise EclatError(f"expected a dict that describes a scene, got {type(scene).__name__}")
    kind = scene.get("type")
    # The comparison of an array with a string would give an array.
    if not isinstance(kind, str) or kind != "scene":
        raise EclatError(f"dict: expected 'type': 'scene', got {shown(kind)}")
    identifiers = Identifiers()
    root = _node(scene, "scene", "", folder, identifiers, 0)
    resolve_references(root, identifiers)
    return root


def parse_bsdf(bsdf: Mapping[str, Any], folder: Path) -> Node:
    """Read a BSDF from a dict into a tree of nodes. File names and errors are treated as in `parse_dict`."""
    identifiers = Identifiers()
    root = _node(bsdf, "bsdf", "", folder, identifiers, 0)
    resolve_references(root, identifiers)
    return root


def _node(given: Mapping[str, Any], tag: str, path: str, folder: Path, identifiers: Identifiers, depth: int) -> Node:
    where = f"dict{path}"
    if depth > MAX_DEPTH:
        raise EclatError(f"{where}: expected at most {MAX_DEPTH} levels of nested objects, got more")
    node = Node(tag, str(given["type"]), f"{where} (type {given['type']!r})", (folder,), id=str(given.get("id", "")))
    for key, value in given.items():
        if key in ("type", "id"):
            continue
        name, here = str(key), f"{where}[{key!r}]"
        if isinstance(value, Mapping):
            _add_object(node, name, value, f"{path}[{key!r}]", folder, identifiers, depth)
        elif tag != "scene":
            node.properties[snake_case(name)] = _value(value, here, keep=snake_case(name) in _IMAGE_DATA)
    return node


def _add_object(
    node: Node, name: str, given: Mapping[str, Any], path: str, folder: Path, identifiers: Identifiers, depth: int
) -> None:
    where = f"dict{path}"
    kind = given.get("type")
    if not isinstance(kind, str):
        raise EclatError(f"{where}: expected an object whose 'type' is a string, got {shown(kind)}")
    if kind == "ref":
        target = given.get("id")
        if not isinstance(target, str):
            raise EclatError(f"{where}: expected a reference whose 'id' is a string, got {shown(target)}")
        node.children.append((name, Node("ref", "", where, (folder,), id=target)))
        return
    _refuse_misspelt(kind, where)
    tag = kinds.tag_of(kind, name, node.tag)
    if tag == "spectrum":
        color = _color(given, where, folder)
        if color is not None:
            node.properties[snake_case(name)] = color
            return
    child = _node(given, tag, path, folder, identifiers, depth + 1)
    # As in Mitsuba, the key of an object of the scene is its id.
    child.id = child.id or (name if node.tag == "scene" else "")
    identifiers.add(child.id, child)
    node.children.append((name, child))


def _refuse_misspelt(kind: str, where: str) -> None:
    """Raise EclatError if a type is unknown but resembles one of Mitsuba's types, because it is probably misspelt.

    A type that resembles no known one may be a custom plugin. It is left out with a warning later, as in files.
    """
    known = [name for names in kinds.PLUGINS.values() for name in names]
    near = "" if kind in known else did_you_mean(kind[:60], known)
    if near:
        raise EclatError(f"{where}: expected the type of a Mitsuba plugin, got {shown(kind)}{near}")


def _color(given: Mapping[str, Any], where: str, folder: Path) -> Color | None:
    """Return the colour in a dict of type 'rgb', 'srgb' or 'spectrum', or None for other types, which become nodes."""
    kind, value = given["type"], given.get("value", given.get("color"))
    if kind not in ("rgb", "srgb", "spectrum"):
        return None
    if value is None and kind == "spectrum" and "filename" in given:
        holder = Node("spectrum", "", where, (folder,), properties={"filename": given["filename"]})
        return read_spd(holder.file("filename"), where)
    if value is None:
        others = [key for key in given if key != "type"]
        near = "".join(did_you_mean(str(key), ["value"]) for key in others[:1])
        raise EclatError(f"{where}: expected the entry 'value' in a dict of type {kind!r}, got {shown(others)}{near}")
    if isinstance(value, str):
        return parse_rgb(value, where) if kind != "spectrum" else parse_spectrum(value, where)
    array = _array(value, where)
    if array.size == 1:
        grey = check_number(float(array.ravel()[0]), where)
        return Uniform(grey) if kind == "spectrum" else Rgb((grey, grey, grey))
    if kind == "spectrum" and array.ndim == 2 and array.shape[1] == 2:
        return check_curve(array[:, 0].tolist(), array[:, 1].tolist(), where)
    if array.shape != (3,):
        raise EclatError(f"{where}: expected one number or three numbers, got an array of shape {array.shape}")
    r, g, b = (check_number(x, where) for x in array.tolist())
    return Rgb((r, g, b))


def _value(value: Any, where: str, keep: bool) -> Any:
    """Convert the value of a property: a number, a string, three numbers or a matrix.

    With `keep`, any other value is returned as it is, because it may be an image. Raises EclatError.
    """
    if isinstance(value, (str, bool, np.bool_)):
        return bool(value) if isinstance(value, np.bool_) else value
    if isinstance(value, (int, float, np.integer, np.floating)):
        return check_number(_as_float(value, where), where)
    if isinstance(value, Path):
        return str(value)
    if keep:
        return value
    matrix = getattr(value, "matrix", None)
    array = _array(value if matrix is None else matrix, where)
    if array.shape == (4, 4):
        return check_matrix(array, where)
    if array.shape == (3, 3):
        affine = np.eye(4)
        affine[:3, :3] = array
        return check_matrix(affine, where)
    if array.ndim == 1:
        return tuple(check_number(x, where) for x in array.tolist())
    raise EclatError(f"{where}: expected a number, three numbers or a 4×4 matrix, got an array of shape {array.shape}")


def _as_float(value: Any, where: str) -> float:
    try:
        return float(value)
    except OverflowError:
        raise EclatError(f"{where}: expected a finite number, got an integer that is too large for a float") from None


def _array(value: Any, where: str) -> np.ndarray:
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        raise EclatError(f"{where}: expected numbers, got a {type(value).__name__}") from None
