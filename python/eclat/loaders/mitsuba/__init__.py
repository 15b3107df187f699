# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Load Mitsuba scenes from XML files of the versions 0.4 to 3 or from the dicts of Mitsuba 3.

The modules `parse` and `dicts` read both forms into the same tree of nodes (`node`), and `assemble` builds the scene
from the tree.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from eclat.errors import EclatError, did_you_mean, shown
from eclat.loaders.budget import count_file
from eclat.loaders.mitsuba.assemble import assemble
from eclat.loaders.mitsuba.dicts import parse_bsdf, parse_dict
from eclat.loaders.mitsuba.materials import Materials, known_kinds
from eclat.loaders.mitsuba.parse import parse_xml
from eclat.scene import Material, Scene

__all__ = ["load_dict", "load_material", "load_xml"]

_DICT_SIZE = 232
"""The number of bytes that a dict of a few entries takes in the caller's memory. It counts as the size of a file does for the
memory that the scene may take."""


def load_xml(path: Path, parameters: dict[str, str] | None = None) -> Scene:
    """Load the scene in a Mitsuba XML file.

    Anything that is unknown or not supported is replaced or left out, with an `EclatWarning`.

    Parameters
    ----------
    path : the file. Relative paths of meshes and textures start from its folder.
    parameters : the values of `$name` in the file. They take precedence over the `<default>` elements of the file.

    Raises
    ------
    EclatError : the XML or a number is malformed, a reference or a parameter is unknown, or no mesh can be loaded.
        The message names the file and the line.
    """
    path = Path(path)
    return assemble(parse_xml(path, dict(parameters or {})), path.stem)


def load_dict(d: Mapping[str, Any], base_folder: Path | None = None) -> Scene:
    """Load a scene from a dict of the form that `mitsuba.load_dict` takes. Mitsuba need not be installed.

    Parameters
    ----------
    d : the scene, `{'type': 'scene', …}`. Transforms are 4×4 arrays, or objects with an attribute `matrix`.
    base_folder : the folder that relative file names start from. The default is the current folder.

    Raises
    ------
    EclatError : as `load_xml`. The message names the keys that lead to the invalid entry.

    Examples
    --------
    >>> white = {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.8, 0.8, 0.8]}}
    >>> scene = load_dict({"type": "scene", "floor": {"type": "rectangle", "bsdf": white}})
    >>> len(scene.meshes)
    1
    """
    folder = Path(base_folder) if base_folder is not None else Path()
    tree = parse_dict(d, folder)
    count_file(folder, _DICT_SIZE * _count_dicts(d))
    return assemble(tree, "dict")


def _count_dicts(tree: Mapping[str, Any]) -> int:
    """Return how many different dicts there are in `tree`. A dict that occurs several times counts once."""
    seen: set[int] = set()
    stack: list[Mapping[str, Any]] = [tree]
    while stack:
        found = stack.pop()
        if id(found) not in seen:
            seen.add(id(found))
            stack.extend(value for value in found.values() if isinstance(value, Mapping))
    return len(seen)


def load_material(bsdf: Mapping[str, Any], base_folder: Path | None = None) -> Material:
    """Build a material from a dict for a BSDF in Mitsuba's form, such as `{'type': 'plastic', 'int_ior': 1.4}`.

    Parameters
    ----------
    bsdf : the dict.
    base_folder : the folder that relative file names start from. The default is the current folder.

    Raises
    ------
    EclatError : a value is invalid, or a type or a property is unknown. In scenes, unknown names only give warnings.
    """
    kinds = known_kinds()
    kind = bsdf.get("type")
    if not isinstance(kind, str) or kind not in kinds:
        raise EclatError(
            f"expected a BSDF whose type is one of {', '.join(kinds)}, got {shown(kind)}{did_you_mean(str(kind), kinds)}"
        )
    node = parse_bsdf(bsdf, Path(base_folder) if base_folder is not None else Path())
    material = Materials().of(node)
    for name in node.properties:
        if name not in node.used:
            raise EclatError(
                f"expected a property of the BSDF type {kind}, got {name!r}{did_you_mean(name, sorted(node.asked))}"
            )
    return material
