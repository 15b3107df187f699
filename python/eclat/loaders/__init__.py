# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Scenes from files, dicts and built-in names: `load` is the front door, with the one table of suffixes."""

from __future__ import annotations

import importlib
import os
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from eclat import scenes
from eclat.errors import EclatError, did_you_mean, heard_warnings
from eclat.scene import Scene

__all__ = ["SUFFIXES", "load", "load_dict"]

SUFFIXES: dict[str, tuple[str, str]] = {
    ".gltf": ("eclat.loaders.gltf", "load_gltf"),
    ".glb": ("eclat.loaders.gltf", "load_gltf"),
    ".obj": ("eclat.loaders.obj", "load_obj_scene"),
    ".ply": ("eclat.loaders.ply", "load_ply_scene"),
    ".xml": ("eclat.loaders.mitsuba", "load_xml"),
}
"""Suffix → module and function that take a path and return a scene; imported when first needed."""


def load(path: str | os.PathLike[str], **parameters: object) -> Scene:
    """Load a scene from a file, or a built-in scene by its name.

    Parameters
    ----------
    path : a file with one of `SUFFIXES` (capitals do not matter), or one of `eclat.scenes.NAMES`.
    parameters : the parameters of a built-in scene (`eclat.scenes.build`), or the values of `$name` in an XML file.

    Returns
    -------
    The scene. What the loader replaced, ignored or guessed is in its `warnings`, and was issued as `EclatWarning` too.

    Raises
    ------
    EclatError : the file does not exist, its suffix or the name is unknown, or the file is wrong.

    Examples
    --------
    >>> scene = load("cornell-box")
    >>> len(scene.meshes) > 0
    True
    """
    if isinstance(path, str) and path in scenes.NAMES:
        name = path
        return _collecting_warnings(lambda: scenes.build(name, **parameters))
    file = Path(path)
    module, function = _loader_of(file)
    _check_is_file(file)
    if parameters and file.suffix.lower() != ".xml":
        raise EclatError(f"{file}: expected no parameters for a file of this kind, got {', '.join(parameters)}")
    read = getattr(importlib.import_module(module), function)
    if parameters:
        values = {name: str(value) for name, value in parameters.items()}
        return _collecting_warnings(lambda: read(file, values))
    return _collecting_warnings(lambda: read(file))


def load_dict(description: Mapping[str, Any], base_folder: str | os.PathLike[str] | None = None) -> Scene:
    """A scene from a dict as `mitsuba.load_dict` takes it; file names in it begin at `base_folder` (default: here).

    Like `load`, it keeps warnings in the scene. Raises EclatError with the path of keys.
    """
    from eclat.loaders import mitsuba

    folder = None if base_folder is None else Path(base_folder)
    return _collecting_warnings(lambda: mitsuba.load_dict(description, folder))


def _loader_of(file: Path) -> tuple[str, str]:
    suffix = file.suffix.lower()
    if suffix in SUFFIXES:
        return SUFFIXES[suffix]
    kinds, names = ", ".join(SUFFIXES), ", ".join(scenes.NAMES)
    if suffix and file.name != suffix:
        near = did_you_mean(suffix, SUFFIXES)
        raise EclatError(f"{file}: expected a scene file ({kinds}), got one with the suffix {file.suffix!r}{near}")
    what = "a folder" if _is_folder(file) else f"{str(file)!r}"
    near = did_you_mean(str(file), scenes.NAMES)
    raise EclatError(f"{file}: expected a scene file ({kinds}) or a built-in scene ({names}), got {what}{near}")


def _check_is_file(file: Path) -> None:
    try:
        if file.is_file():
            return
        if file.exists():
            what = "a folder" if file.is_dir() else "neither file nor folder"
            raise EclatError(f"{file}: expected a scene file, got {what}")
        siblings = [name for name in os.listdir(file.parent) if Path(name).suffix.lower() in SUFFIXES]
    except (OSError, ValueError) as error:
        if isinstance(error, EclatError):
            raise
        siblings = []
    raise EclatError(f"{file}: expected a scene file, got no such file{did_you_mean(file.name, siblings)}")


def _is_folder(file: Path) -> bool:
    try:
        return file.is_dir()
    except (OSError, ValueError):
        return False


def _collecting_warnings(make: Callable[[], Scene]) -> Scene:
    """The scene that `make` returns, with the text of every `EclatWarning` on the way."""
    from eclat.loaders.images import image_budget

    with heard_warnings() as messages, image_budget():
        scene = make()
    return replace(scene, warnings=tuple(dict.fromkeys([*scene.warnings, *messages])))
