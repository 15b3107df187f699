# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Load scenes from files, from Mitsuba-style dicts and by built-in name. `SUFFIXES` lists the file formats."""

from __future__ import annotations

import importlib
import os
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from eclat import scenes
from eclat.errors import EclatError, did_you_mean, heard_warnings, shown
from eclat.files.confinement import check_confined, confined_to
from eclat.scene import Scene

__all__ = ["SUFFIXES", "load", "load_dict"]

SUFFIXES: dict[str, tuple[str, str]] = {
    ".gltf": ("eclat.loaders.gltf", "load_gltf"),
    ".glb": ("eclat.loaders.gltf", "load_gltf"),
    ".obj": ("eclat.loaders.obj", "load_obj_scene"),
    ".ply": ("eclat.loaders.ply", "load_ply_scene"),
    ".xml": ("eclat.loaders.mitsuba", "load_xml"),
    ".usd": ("eclat.loaders.usd", "load_usd"),
    ".usda": ("eclat.loaders.usd", "load_usd"),
    ".usdc": ("eclat.loaders.usd", "load_usd"),
    ".usdz": ("eclat.loaders.usd", "load_usd"),
}
"""The loader of each file suffix: a module, which is imported on first use, and a function in it.

The function takes the path of the file and returns a scene.
"""


def load(
    path: str | os.PathLike[str] | Mapping[str, Any],
    *,
    root: str | os.PathLike[str] | None = None,
    **parameters: object,
) -> Scene:
    """Load a scene from a file or a dict, or a built-in scene by its name.

    Parameters
    ----------
    path : a file with one of the `SUFFIXES` in upper or lower case, or one of `eclat.scenes.NAMES`; or a
        dict as `load_dict` takes it.
    root : a folder. Every file that the scene reads, itself included, must lie below it after all symbolic links and
        `..` in the path are followed. What a loader does about a file outside of it is what it does about one that
        does not exist. None lets files lie anywhere that the format allows.
    parameters : the parameters of a built-in scene (`eclat.scenes.build`), or the values of `$name` in an XML file.
        Other formats take no parameters.

    Returns
    -------
    The scene. Its `warnings` list everything that the loader replaced, ignored or guessed. Each of them is also
    issued as an `EclatWarning`.

    Raises
    ------
    EclatError : the file does not exist, its suffix or the name is unknown, its content is invalid, it takes no
        parameters, or it lies outside `root`.

    Examples
    --------
    >>> scene = load("cornell-box")
    >>> len(scene.meshes) > 0
    True
    """
    if isinstance(path, Mapping) and not parameters:
        return load_dict(path, root=root)
    if not isinstance(path, str | os.PathLike):
        raise EclatError(
            f"load: expected the path of a scene file, the name of a built-in scene or a dict, got {shown(path)}"
        )
    with confined_to(root):
        return _load(path, parameters)


def load_dict(
    description: Mapping[str, Any],
    base_folder: str | os.PathLike[str] | None = None,
    *,
    root: str | os.PathLike[str] | None = None,
) -> Scene:
    """Load a scene from a dict of the form that `mitsuba.load_dict` takes.

    Parameters
    ----------
    description : the scene as nested dicts.
    base_folder : the folder that relative file names in the dict start from. The default is the current folder.
    root : the folder below which all files must lie, as in `load`.

    Returns
    -------
    The scene, with the warnings of the loader as in `load`.

    Raises
    ------
    EclatError : an entry is invalid. The message names the keys that lead to it.
    """
    from eclat.loaders import mitsuba

    if not isinstance(description, Mapping):
        raise EclatError(f"load_dict: expected a dict, got {shown(description)}")
    folder = None if base_folder is None else Path(base_folder)
    with confined_to(root):
        return _collecting_warnings(lambda: mitsuba.load_dict(description, folder))


def _load(path: str | os.PathLike[str], parameters: Mapping[str, object]) -> Scene:
    if isinstance(path, str) and path in scenes.NAMES:
        name = path
        return _collecting_warnings(lambda: scenes.build(name, **parameters))
    file = Path(path)
    module, function = _loader_of(file)
    _check_is_file(file)
    if parameters and file.suffix.lower() != ".xml":
        raise EclatError(
            f"{file}: expected no parameters, because only XML files and built-in scenes have them, "
            f"got {', '.join(parameters)}"
        )
    read = getattr(importlib.import_module(module), function)
    if parameters:
        values = {name: str(value) for name, value in parameters.items()}
        return _collecting_warnings(lambda: read(file, values))
    return _collecting_warnings(lambda: read(file))


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
        check_confined(file, str(file))
        if file.is_file():
            return
        if file.exists():
            what = "a folder" if file.is_dir() else "something that is neither a file nor a folder"
            raise EclatError(f"{file}: expected a scene file, got {what}")
        siblings = [name for name in os.listdir(file.parent) if Path(name).suffix.lower() in SUFFIXES]
    except (OSError, ValueError) as error:
        if isinstance(error, EclatError):
            raise
        siblings = []
    raise EclatError(f"{file}: expected a scene file, but no such file exists{did_you_mean(file.name, siblings)}")


def _is_folder(file: Path) -> bool:
    try:
        return file.is_dir()
    except (OSError, ValueError):
        return False


def _collecting_warnings(make: Callable[[], Scene]) -> Scene:
    """Call `make` and return its scene, with the text of every `EclatWarning` that was issued meanwhile."""
    from eclat.loaders.budget import geometry_budget
    from eclat.loaders.images import image_budget

    with heard_warnings() as messages, image_budget(), geometry_budget():
        scene = make()
    return replace(scene, warnings=tuple(dict.fromkeys([*scene.warnings, *messages])))
