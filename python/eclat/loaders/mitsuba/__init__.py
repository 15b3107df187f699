# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Loads Mitsuba scenes: XML of versions 0.4 to 3, or the dict of Mitsuba 3.

`parse` and `dicts` make the same neutral tree (`node`), from which `assemble` makes the scene.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from eclat.errors import EclatError, did_you_mean, shown
from eclat.loaders.mitsuba.assemble import assemble
from eclat.loaders.mitsuba.dicts import parse_bsdf, parse_dict
from eclat.loaders.mitsuba.materials import Materials, known_kinds
from eclat.loaders.mitsuba.parse import parse_xml
from eclat.scene import Material, Scene

__all__ = ["load_dict", "load_material", "load_xml"]


def load_xml(path: Path, parameters: dict[str, str] | None = None) -> Scene:
    """The scene in a Mitsuba XML file.

    Parameters
    ----------
    path : the file; meshes and textures are looked for beside it.
    parameters : values of `$name` in the file, before its own `<default>`s.

    Raises
    ------
    EclatError : malformed XML and numbers, unknown references and parameters, missing meshes, with file and line.
        Whatever is only unknown or unsupported is replaced or left out with an `EclatWarning`.
    """
    path = Path(path)
    return assemble(parse_xml(path, dict(parameters or {})), path.stem)


def load_dict(d: Mapping[str, Any], base_folder: Path | None = None) -> Scene:
    """The scene in a dict as `mitsuba.load_dict` takes it; Mitsuba itself is not needed.

    Parameters
    ----------
    d : `{'type': 'scene', …}`; transforms are 4×4 arrays or objects with a `matrix`.
    base_folder : where relative file names begin, by default the current folder.

    Raises
    ------
    EclatError : as `load_xml`, with the path of keys.

    Examples
    --------
    >>> white = {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.8, 0.8, 0.8]}}
    >>> scene = load_dict({"type": "scene", "floor": {"type": "rectangle", "bsdf": white}})
    >>> len(scene.meshes)
    1
    """
    return assemble(parse_dict(d, Path(base_folder) if base_folder is not None else Path()), "dict")


def load_material(bsdf: Mapping[str, Any], base_folder: Path | None = None) -> Material:
    """The material that a dict describes as `mitsuba.load_dict` takes it, such as `{'type': 'plastic', 'int_ior': 1.4}`.

    Raises EclatError. Unlike in scenes, this includes unknown types and properties, which are the caller's own.
    """
    kinds = known_kinds()
    kind = bsdf.get("type")
    if not isinstance(kind, str) or kind not in kinds:
        raise EclatError(
            f"expected a bsdf of type {', '.join(kinds)}, got {shown(kind)}{did_you_mean(str(kind), kinds)}"
        )
    node = parse_bsdf(bsdf, Path(base_folder) if base_folder is not None else Path())
    material = Materials().of(node)
    for name in node.properties:
        if name not in node.used:
            raise EclatError(f"{kind} has no property {name!r}{did_you_mean(name, sorted(node.asked))}")
    return material
