# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""MTL files as statements: numbers, colours and texture maps with their options. `mtl_materials` gives them meaning."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from eclat.errors import EclatError, did_you_mean, warn
from eclat.loaders.files import read_bytes, read_texture, resolve, stand_in
from eclat.loaders.text_files import decoded, logical_lines
from eclat.loaders.triangles import LARGEST
from eclat.scene import Texture

UNDERSTOOD = (
    *("kd", "ks", "ke", "ns", "ni", "d", "tr", "tf", "illum", "pr", "pm"),
    *("map_kd", "map_ks", "map_ke", "map_ns", "map_d", "map_tr", "map_pr", "map_pm", "map_bump", "norm"),
)
_SAME = {"bump": "map_bump", "map_kn": "norm", "map_opacity": "map_d"}
_MEANINGLESS = ("ka", "map_ka", "map_aat")
"""Ambient light and antialiasing hints: nothing that a physical renderer could lose."""

_LIBRARY_NAME = re.compile(r"\S.*?\.mtl(?=\s|$)", re.IGNORECASE)
_LONGEST_LINE = 4096
_MOST_LIBRARIES = 256
_MOST_SUGGESTIONS = 8
_OPTION = re.compile(r"-([A-Za-z]+)\s+")
_WORD = re.compile(r"(\S+)\s*")
_ARGUMENTS = {"blendu": 1, "blendv": 1, "boost": 1, "texres": 1, "clamp": 1, "bm": 1, "imfchan": 1}
_ARGUMENTS |= {"mm": 2, "o": 3, "s": 3, "t": 3, "cc": 1, "type": 1}
_WITHOUT_EFFECT = ("mm", "t", "cc", "type")


@dataclass(frozen=True)
class Entry:
    """One `newmtl`: for each statement the line and what follows; the last of its kind counts."""

    name: str
    path: Path
    statements: dict[str, tuple[int, str]] = field(default_factory=dict)

    def where(self, key: str) -> str:
        """File, line and material of a statement, for messages."""
        return f"{self.path.name}, line {self.statements[key][0]}, material {self.name!r}"


@dataclass(frozen=True)
class Library:
    """The materials of all MTL files of an OBJ file, and the textures read so far."""

    entries: dict[str, Entry] = field(default_factory=dict)
    folded: dict[str, Entry] = field(default_factory=dict)
    """The same by their names without capitals."""
    incomplete: bool = False
    """An MTL file is missing, which was said."""
    textures: dict[tuple[Path, bool, bool], Texture] = field(default_factory=dict)
    unknown: set[str] = field(default_factory=set)
    """Materials that were asked for in vain, which was said."""


@dataclass(frozen=True)
class Map:
    """A texture statement: its file and its options."""

    name: str
    scale: tuple[float, float] = (1.0, 1.0)
    offset: tuple[float, float] = (0.0, 0.0)
    clamp: bool = False
    bump_multiplier: float = 1.0
    channel: str = ""

    @property
    def uv_transform(self) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
        """The map uv · scale + offset for v that grows downwards: 1 − ((1 − v) · scale + offset)."""
        (su, sv), (ou, ov) = self.scale, self.offset
        return ((su, 0.0, ou), (0.0, sv, 1.0 - sv - ov))


def load_library(obj_path: Path, names: list[tuple[int, str]]) -> Library:
    """Read the MTL files that `mtllib` statements (line, argument) name; those that are missing get a warning.

    Raises
    ------
    EclatError : an MTL file that cannot be parsed.
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
    """The files of one `mtllib`, None for each that is missing: the whole argument, or several names."""
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
            warn(f"{where}: the material file {name[:200]!r} is missing; its materials are grey")
        paths.append(path)
    return paths


def _library_path(obj_path: Path, name: str, where: str) -> Path | None:
    """The file called `name` where there is one."""
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
                f"{path.name}, line {number}: expected at most {_LONGEST_LINE} characters, got {len(rest)}"
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
        warn(f"{path.name}: statements that are not understood are ignored: {kinds}{more}")
    return entries


def find_entry(library: Library, name: str) -> Entry | None:
    """The material called `name`, where case does not matter if no name matches exactly; else None, with a warning."""
    entry = library.entries.get(name)
    if entry is None:
        entry = library.folded.get(name.casefold())
    if entry is None and not library.incomplete and name not in library.unknown:
        library.unknown.add(name)
        if len(library.unknown) <= _MOST_SUGGESTIONS:
            near = did_you_mean(name, library.entries) if len(name) < 100 else ""
            warn(f"material {name[:100]!r} is in no MTL file{near}; it is grey")
        elif len(library.unknown) == _MOST_SUGGESTIONS + 1:
            warn("more materials are in no MTL file; they are grey")
    return entry


def number(entry: Entry, key: str, least: float = 0.0, most: float = LARGEST) -> float | None:
    """The first number of a statement, or None if it is absent. Raises EclatError if it is not in `least`..`most`."""
    if key not in entry.statements:
        return None
    text = entry.statements[key][1].partition("#")[0].removeprefix("-halo")
    return _numbers(entry, key, text.split()[:1], least, most)[0]


def color(entry: Entry, key: str) -> tuple[float, float, float] | None:
    """The linear RGB of a statement, None where it is absent; one number means grey."""
    if key not in entry.statements:
        return None
    words = entry.statements[key][1].partition("#")[0].split()
    if words and words[0].lower() in ("spectral", "xyz"):
        warn(f"{entry.where(key)}: {words[0]} colours are not understood; the default is used")
        return None
    values = _numbers(entry, key, words[:3] if len(words) >= 3 else words[:1], 0.0, LARGEST)
    return (values[0], values[1], values[2]) if len(values) == 3 else (values[0],) * 3


def _numbers(entry: Entry, key: str, words: list[str], least: float, most: float) -> list[float]:
    try:
        values = [float(word) for word in words]
        if values and all(least <= value <= most and math.isfinite(value) for value in values):
            return values
    except ValueError:
        pass
    bounds = f"of at least {least:g}" if most == LARGEST else f"in {least:g}..{most:g}"
    got = entry.statements[key][1][:40]
    raise EclatError(f"{entry.where(key)}: expected finite numbers {bounds} after {key}, got {got!r}")


def texture_map(entry: Entry, key: str) -> Map | None:
    """A texture statement's file and options; None where it is absent, or names no file (with a warning)."""
    if key not in entry.statements:
        return None
    rest = entry.statements[key][1]
    options: dict[str, list[str]] = {}
    while (match := _OPTION.match(rest)) and match[1].lower() in _ARGUMENTS:
        name = match[1].lower()
        options[name], rest = _arguments(rest[match.end() :], name)
    name = rest.strip().strip('"')
    if not name:
        warn(f"{entry.where(key)}: expected the name of an image after {key}; the map is ignored")
        return None
    without = [option for option in _WITHOUT_EFFECT if option in options]
    if without:
        warn(f"{entry.where(key)}: texture options without effect: {', '.join('-' + option for option in without)}")
    return Map(
        name=name,
        scale=_pair(options.get("s"), 1.0),
        offset=_pair(options.get("o"), 0.0),
        clamp=options.get("clamp", ["off"])[0].lower() == "on",
        bump_multiplier=_pair(options.get("bm"), 1.0)[0],
        channel=options.get("imfchan", [""])[0].lower(),
    )


def _arguments(rest: str, option: str) -> tuple[list[str], str]:
    """The words that belong to an option, and what follows; -o, -s and -t have one to three numbers."""
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
    """The image of a texture statement, read once per library; a stand-in with a warning where it is missing."""
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
