# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read the statements of MTL files: numbers, colours and texture maps with options.

`mtl_materials` builds materials from these statements.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from eclat.errors import EclatError, did_you_mean, warn
from eclat.files.confinement import is_outside
from eclat.loaders.files import read_bytes, read_texture, resolve, stand_in
from eclat.loaders.text_files import decoded, logical_lines
from eclat.loaders.triangles import LARGEST
from eclat.scene import Texture

UNDERSTOOD = (
    *("kd", "ks", "ke", "ns", "ni", "d", "tr", "tf", "illum", "pr", "pm"),
    *("map_ka", "map_kd", "map_ks", "map_ke", "map_ns", "map_d", "map_tr", "map_pr", "map_pm", "map_bump", "norm"),
)
"""The statements that are read, in lower case."""
_SAME = {"bump": "map_bump", "map_kn": "norm", "map_opacity": "map_d"}
"""Other spellings of statements, and the spelling in `UNDERSTOOD` that each of them stands for."""
_MEANINGLESS = ("ka", "map_aat")
"""Statements that are ignored without a warning: ambient light and antialiasing hints do not apply to a physically
based renderer."""

_LIBRARY_NAME = re.compile(r"\S.*?\.mtl(?=\s|$)", re.IGNORECASE)
_LONGEST_LINE = 4096
"""The largest number of characters after a keyword. Real lines have fewer than a hundred."""
_MOST_LIBRARIES = 256
"""The largest number of `mtllib` statements, and of file names in one of them. Real files have one or two."""
_MOST_SUGGESTIONS = 8
"""The number of unknown materials that get a warning with a suggestion each. One more warning stands for all others."""
_OPTION = re.compile(r"-([A-Za-z]+)\s+")
_WORD = re.compile(r"(\S+)\s*")
_ARGUMENTS = {"blendu": 1, "blendv": 1, "boost": 1, "texres": 1, "clamp": 1, "bm": 1, "imfchan": 1}
_ARGUMENTS |= {"mm": 2, "o": 3, "s": 3, "t": 3, "cc": 1, "type": 1}
"""The options of texture maps, and the largest number of arguments of each."""
_WITHOUT_EFFECT = ("mm", "t", "cc", "type")
"""The options of texture maps that are ignored with a warning."""


@dataclass(frozen=True)
class Entry:
    """The definition of one material, which starts with `newmtl`.

    `statements` maps each keyword, in lower case, to its line number and the text after it. If a keyword occurs
    several times, its last occurrence counts.
    """

    name: str
    path: Path
    statements: dict[str, tuple[int, str]] = field(default_factory=dict)

    def where(self, key: str) -> str:
        """Return the file, line and material of the statement `key`, for messages."""
        return f"{self.path.name}, line {self.statements[key][0]}, material {self.name!r}"


@dataclass(frozen=True)
class Library:
    """The materials of all MTL files of an OBJ file, and the textures read so far."""

    entries: dict[str, Entry] = field(default_factory=dict)
    folded: dict[str, Entry] = field(default_factory=dict)
    """The same entries by their case-folded names."""
    incomplete: bool = False
    """Whether an MTL file is missing. A warning about it has been issued."""
    textures: dict[tuple[Path, bool, bool], Texture] = field(default_factory=dict)
    """The textures read so far, by path, whether the texture is sRGB, and whether it is clamped."""
    unknown: set[str] = field(default_factory=set)
    """The names of materials that were looked up and not found. Warnings about them have been issued."""


@dataclass(frozen=True)
class Map:
    """A texture statement: the name of the image file and the options."""

    name: str
    scale: tuple[float, float] = (1.0, 1.0)
    offset: tuple[float, float] = (0.0, 0.0)
    clamp: bool = False
    bump_multiplier: float = 1.0
    channel: str = ""

    @property
    def uv_transform(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """The affine map of texture coordinates, 2 rows of 3 numbers, for a v that grows downwards.

        The file's map is uv · scale + offset with v upwards. It becomes v′ = 1 − ((1 − v) · scale + offset).
        """
        (su, sv), (ou, ov) = self.scale, self.offset
        return ((su, 0.0, ou), (0.0, sv, 1.0 - sv - ov))


def load_library(obj_path: Path, names: list[tuple[int, str]]) -> Library:
    """Read the MTL files of an OBJ file. Missing files get a warning.

    Parameters
    ----------
    obj_path : the OBJ file.
    names : the line and the argument of each `mtllib` statement.

    Raises
    ------
    EclatError : an MTL file cannot be parsed, or there are too many of them.
    """
    entries: dict[str, Entry] = {}
    incomplete = False
    seen: set[Path] = set()
    arguments = {argument: line for line, argument in reversed(names)}
    if len(arguments) > _MOST_LIBRARIES:
        raise EclatError(f"{obj_path.name}: expected at most {_MOST_LIBRARIES} mtllib statements, got {len(arguments)}")
    for argument, line in reversed(arguments.items()):
        for path in _library_paths(obj_path, line, argument):
            if path is None:
                incomplete = True
            elif path not in seen:
                seen.add(path)
                for name, entry in _parse(path).items():
                    entries.setdefault(name, entry)
    folded = {name.casefold(): entry for name, entry in entries.items()}
    return Library(entries, folded, incomplete)


def _library_paths(obj_path: Path, line: int, argument: str) -> list[Path | None]:
    """Return the paths of the files that one `mtllib` statement names, with None for each missing file.

    The argument may be one file name with spaces or several file names.
    """
    where = f"{obj_path.name}, line {line}"
    paths: list[Path | None] = []
    whole = _library_path(obj_path, argument, where) if " " not in argument or len(argument) < 256 else None
    if whole is not None:
        return [whole]
    names = _LIBRARY_NAME.findall(argument) if len(argument) < _LONGEST_LINE else argument.split()
    names = list(dict.fromkeys(names)) or [argument]
    if len(names) > _MOST_LIBRARIES:
        raise EclatError(f"{where}: expected at most {_MOST_LIBRARIES} material files, got {len(names)}")
    for name in names:
        path = _library_path(obj_path, name, where)
        if path is None:
            reason = "lies outside the root folder" if is_outside(obj_path.parent / name) else "is missing"
            warn(f"{where}: the material file {name[:200]!r} {reason}; its materials are replaced by grey ones")
        paths.append(path)
    return paths


def _library_path(obj_path: Path, name: str, where: str) -> Path | None:
    """Return the path of the file called `name`, or None if it does not exist."""
    try:
        path = resolve(obj_path.parent, name, where=where, allow_parent=True)
        return path if path.is_file() else None
    except (EclatError, OSError):
        return None


def _parse(path: Path) -> dict[str, Entry]:
    entries: dict[str, Entry] = {}
    current: Entry | None = None
    ignored: dict[str, int] = {}
    for number, line in logical_lines(read_bytes(path, where=path.name), path.name):
        words = decoded(line).split(None, 1)
        if not words or words[0].startswith("#"):
            continue
        key, rest = words[0].lower(), words[1].strip() if len(words) == 2 else ""
        key = _SAME.get(key, key)
        if len(rest) > _LONGEST_LINE:
            raise EclatError(
                f"{path.name}, line {number}: expected at most {_LONGEST_LINE} characters after the keyword, "
                f"got {len(rest)}"
            )
        if key == "newmtl":
            current = entries.setdefault(rest, Entry(rest, path))
        elif current is not None and key in UNDERSTOOD:
            current.statements[key] = (number, rest)
        elif key not in _MEANINGLESS:
            ignored.setdefault(words[0][:20], number)
    if ignored:
        kinds = ", ".join(f"{key!r} (line {number})" for key, number in list(ignored.items())[:8])
        more = f" and {len(ignored) - 8} more kinds" if len(ignored) > 8 else ""
        warn(f"{path.name}: these unknown statements are ignored: {kinds}{more}")
    return entries


def find_entry(library: Library, name: str) -> Entry | None:
    """Find the material called `name`. If no name matches exactly, upper and lower case count as equal.

    Returns None, with a warning, if there is no such material.
    """
    entry = library.entries.get(name)
    if entry is None:
        entry = library.folded.get(name.casefold())
    if entry is None and not library.incomplete and name not in library.unknown:
        library.unknown.add(name)
        if len(library.unknown) <= _MOST_SUGGESTIONS:
            near = did_you_mean(name, library.entries) if len(name) < 100 else ""
            warn(f"material {name[:100]!r} is not defined in any MTL file{near}; a grey one is used instead")
        elif len(library.unknown) == _MOST_SUGGESTIONS + 1:
            warn("more materials are not defined in any MTL file; grey ones are used instead")
    return entry


def number(entry: Entry, key: str, least: float = 0.0, most: float = LARGEST) -> float | None:
    """Return the first number of the statement `key`, or None if the statement is absent. A statement without a number, or with
    one that is not in `least`..`most`, is removed with a warning.
    """
    if key not in entry.statements:
        return None
    text = entry.statements[key][1].partition("#")[0].removeprefix("-halo")
    values = _numbers(entry, key, text.split()[:1], least, most)
    return values[0] if values else None


def color(entry: Entry, key: str) -> tuple[float, float, float] | None:
    """Return the linear RGB colour of the statement `key`, or None if the statement is absent. One number means grey. A
    statement with a number that is malformed, negative or not finite is removed with a warning.
    """
    if key not in entry.statements:
        return None
    words = entry.statements[key][1].partition("#")[0].split()
    if words and words[0].lower() in ("spectral", "xyz"):
        warn(f"{entry.where(key)}: expected an RGB colour, got a colour of kind {words[0]!r}; the default is used")
        return None
    values = _numbers(entry, key, words[:3] if len(words) >= 3 else words[:1], 0.0, LARGEST)
    if not values:
        return None
    return (values[0], values[1], values[2]) if len(values) == 3 else (values[0],) * 3


def _numbers(entry: Entry, key: str, words: list[str], least: float, most: float) -> list[float]:
    """Convert the words; an empty list says that the statement was removed, because a file of a thousand materials is not to
    fail by one number."""
    try:
        values = [float(word) for word in words]
        if values and all(least <= value <= most and math.isfinite(value) for value in values):
            return values
    except ValueError:
        pass
    bounds = f"of at least {least:g}" if most == LARGEST else f"in {least:g}..{most:g}"
    got = entry.statements[key][1][:40]
    warn(f"{entry.where(key)}: expected finite numbers {bounds} after {key}, got {got!r}; the statement is ignored")
    del entry.statements[key]
    return []


def texture_map(entry: Entry, key: str) -> Map | None:
    """Parse the file name and the options of the texture statement `key`.

    Returns None if the statement is absent or, with a warning, if it names no file.
    """
    if key not in entry.statements:
        return None
    rest = entry.statements[key][1]
    options: dict[str, list[str]] = {}
    while (match := _OPTION.match(rest)) and match[1].lower() in _ARGUMENTS:
        name = match[1].lower()
        options[name], rest = _arguments(rest[match.end() :], name)
    name = rest.strip().strip('"')
    if not name:
        warn(f"{entry.where(key)}: expected the name of an image file after {key}, got none; the map is ignored")
        return None
    without = [option for option in _WITHOUT_EFFECT if option in options]
    if without:
        warn(
            f"{entry.where(key)}: these texture options are not supported and are ignored: "
            f"{', '.join('-' + option for option in without)}"
        )
    return Map(
        name=name,
        scale=_pair(options.get("s"), 1.0),
        offset=_pair(options.get("o"), 0.0),
        clamp=options.get("clamp", ["off"])[0].lower() == "on",
        bump_multiplier=_pair(options.get("bm"), 1.0)[0],
        channel=options.get("imfchan", [""])[0].lower(),
    )


def _arguments(rest: str, option: str) -> tuple[list[str], str]:
    """Split `rest` into the arguments of `option` and the text after them. -o, -s and -t have one to three numbers."""
    words: list[str] = []
    while len(words) < _ARGUMENTS[option] and (match := _WORD.match(rest)):
        if option in ("o", "s", "t", "bm", "mm") and not _is_number(match[1]):
            break
        words.append(match[1])
        rest = rest[match.end() :]
    return words or [""], rest


def _is_number(word: str) -> bool:
    try:
        return abs(float(word)) <= LARGEST
    except ValueError:
        return False


def _pair(words: list[str] | None, default: float) -> tuple[float, float]:
    first, second, *_ = [*(float(word) for word in words or [] if word), default, default]
    return first, second


def read_map(library: Library, entry: Entry, key: str, found: Map, *, srgb: bool) -> Texture:
    """Read the image of a texture statement, once per library. A missing image is replaced, with a warning."""
    where = entry.where(key)
    wrap: Literal["clamp", "repeat"] = "clamp" if found.clamp else "repeat"
    try:
        path = resolve(entry.path.parent, found.name, where=where, allow_parent=True)
    except EclatError as error:
        return stand_in(str(error), srgb=srgb, where=where, wrap_u=wrap, wrap_v=wrap, name=found.name)
    cached = (path, srgb, found.clamp)
    if cached not in library.textures:
        library.textures[cached] = read_texture(path, srgb=srgb, where=where, wrap_u=wrap, wrap_v=wrap)
    return library.textures[cached]
