# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Parse the statements of an OBJ file to arrays.

Statements of the usual form are parsed many at a time. If some lines have another form, the lines are parsed one by one.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.loaders.text_files import decoded, logical_lines
from eclat.loaders.triangles import check_positions, finite_rows

IntArray = NDArray[np.int64]

_ABSENT = int(np.iinfo(np.int64).min)
"""The value of an index that a face corner does not have, while the file is parsed."""
_LARGEST_INDEX = 1 << 40
"""The value that larger indices are clipped to. No file has as many vertices, and the sums of clipped indices cannot
overflow."""

_HEXADECIMAL = re.compile(rb"[0-9A-Fa-f]*")
_KINDS = ("v", "vt", "vn")


@dataclass(frozen=True, eq=False)
class ObjText:
    """The contents of an OBJ file with F faces, which have C corners in total."""

    positions: NDArray[np.float64]
    """(V, 3) the vertices. All coordinates are finite."""
    colors: NDArray[np.float64] | None
    """(V, 3) the vertex colours as in the file. A vertex without a colour has NaN."""
    uvs: NDArray[np.float32]
    """(U, 2) texture coordinates, with v upwards as in the file."""
    normals: NDArray[np.float32]
    """(N, 3) normals, which need not have unit length."""
    corners: IntArray
    """(C, 3) for each corner, its indices into `positions`, `uvs` and `normals`. All are in range, or −1 for none."""
    counts: IntArray
    """(F,) the number of corners of each face."""
    face_materials: IntArray
    """(F,) indices into `material_names`. The name "" means that no `usemtl` precedes the face."""
    face_groups: IntArray
    """(F,) indices into `group_names`."""
    face_smoothing: IntArray
    """(F,) the smoothing group of each face, from 1, or 0 for none."""
    material_names: list[str]
    group_names: list[str]
    libraries: list[tuple[int, str]]
    """The line and the argument of each `mtllib` statement."""


@dataclass
class _Statements:
    """The lines of an OBJ file, sorted by statement and not yet parsed."""

    rows: dict[bytes, list[bytes]] = field(default_factory=lambda: {b"v": [], b"vt": [], b"vn": []})
    lines: dict[bytes, list[int]] = field(default_factory=lambda: {b"v": [], b"vt": [], b"vn": []})
    faces: list[bytes] = field(default_factory=list)
    face_lines: list[int] = field(default_factory=list)
    face_seen: list[tuple[int, int, int]] = field(default_factory=list)
    """The numbers of v, vt and vn statements that precede each face. Negative indices count back from them."""
    face_materials: list[int] = field(default_factory=list)
    face_groups: list[int] = field(default_factory=list)
    face_smoothing: list[int] = field(default_factory=list)
    smoothing: dict[bytes, int] = field(default_factory=lambda: {b"": 0, b"0": 0, b"off": 0})
    materials: dict[bytes, int] = field(default_factory=lambda: {b"": 0})
    groups: dict[bytes, int] = field(default_factory=lambda: {b"": 0})
    libraries: list[tuple[int, bytes]] = field(default_factory=list)
    ignored: dict[bytes, int] = field(default_factory=dict)
    painted: list[bytes] = field(default_factory=list)
    """The arguments of the comments `#MRGB`, in which ZBrush writes the colours of vertices."""


def read_obj_text(data: bytes, where: str) -> ObjText:
    """Parse the bytes of the OBJ file called `where`.

    Raises
    ------
    EclatError : the file has no vertices or no faces, a line is malformed, an index is out of range, or a coordinate
        is not finite.
    """
    found = _sort_lines(data, where)
    if found.ignored:
        kinds = ", ".join(f"{decoded(key)[:20]!r} (line {line})" for key, line in list(found.ignored.items())[:8])
        more = f" and {len(found.ignored) - 8} more kinds" if len(found.ignored) > 8 else ""
        warn(f"{where}: these unknown statements are ignored: {kinds}{more}")
    if not found.rows[b"v"] or not found.faces:
        raise EclatError(
            f"{where}: expected an OBJ file with vertices (v) and faces (f), "
            f"got {len(found.rows[b'v'])} vertices and {len(found.faces)} faces"
        )
    vertices = _table(found, b"v", (3, 6), 3, where)
    check_positions(vertices[:, :3], where, numbers=found.lines[b"v"])
    corners, counts = _corners(found, where)
    return ObjText(
        positions=np.ascontiguousarray(vertices[:, :3]),
        colors=_colors(vertices, found.painted, where),
        uvs=finite_rows(_table(found, b"vt", (1, 2), 1, where), "texture coordinates (vt)", where),
        normals=finite_rows(_table(found, b"vn", (3,), 3, where), "normals (vn)", where),
        corners=corners,
        counts=counts,
        face_materials=np.array(found.face_materials, dtype=np.int64),
        face_groups=np.array(found.face_groups, dtype=np.int64),
        face_smoothing=np.array(found.face_smoothing, dtype=np.int64),
        material_names=[decoded(name) for name in found.materials],
        group_names=[decoded(name) for name in found.groups],
        libraries=[(line, decoded(name)) for line, name in found.libraries],
    )


def _sort_lines(data: bytes, where: str) -> _Statements:
    found = _Statements()
    rows, lines = found.rows, found.lines
    v, vt, vn = rows[b"v"], rows[b"vt"], rows[b"vn"]
    material = group = smoothing = 0
    for number, line in logical_lines(data, where):
        words = line.split(None, 1)
        if not words:
            continue
        key = words[0]
        rest = words[1] if len(words) == 2 else b""
        if key in rows:
            rows[key].append(rest)
            lines[key].append(number)
        elif key == b"f" or key == b"fo":
            found.faces.append(rest)
            found.face_lines.append(number)
            found.face_seen.append((len(v), len(vt), len(vn)))
            found.face_materials.append(material)
            found.face_groups.append(group)
            found.face_smoothing.append(smoothing)
        elif key == b"usemtl":
            material = found.materials.setdefault(rest.strip(), len(found.materials))
        elif key == b"g" or key == b"o":
            group = found.groups.setdefault(b" ".join(rest.split()), len(found.groups))
        elif key == b"mtllib":
            found.libraries.append((number, rest.strip()))
        elif key == b"s":
            name = rest.partition(b"#")[0].strip().lower()
            smoothing = found.smoothing.setdefault(name, len(found.smoothing) - 2)
        elif key == b"#MRGB":
            found.painted.append(rest)
        elif not key.startswith(b"#"):
            found.ignored.setdefault(key, number)
    return found


def _colors(vertices: NDArray[np.float64], painted: list[bytes], where: str) -> NDArray[np.float64] | None:
    """Return the sRGB colours (V, 3) of the vertices, or None if there are none.

    They are the numbers after the positions, or come from `#MRGB` comments. Such a comment holds up to 64 groups of eight
    hexadecimal digits, one for each vertex: a mask, which is not used, and red, green and blue.
    """
    colors = vertices[:, 3:] if vertices.shape[1] == 6 else None
    if not painted:
        return colors
    digits = b"".join(b"".join(painted).split())
    reason = ""
    if colors is not None:
        reason = "because the vertices (v) have colours of their own"
    elif not _HEXADECIMAL.fullmatch(digits) or len(digits) != 8 * len(vertices):
        reason = f"because they do not have eight hexadecimal digits for each of the {len(vertices)} vertices"
    if reason:
        warn(f"{where}: the vertex colours in #MRGB comments are ignored, {reason}")
        return colors
    groups = np.frombuffer(bytes.fromhex(digits.decode("ascii")), np.uint8).reshape(-1, 4)
    return groups[:, 1:] / 255.0


def _uncommented(rows: list[bytes]) -> list[bytes]:
    return [row.partition(b"#")[0] if b"#" in row else row for row in rows]


def _table(found: _Statements, kind: bytes, widths: tuple[int, ...], least: int, where: str) -> NDArray[np.float64]:
    """Parse the numbers of all statements of one `kind` to a table, one row for each statement.

    Each row must have at least `least` numbers. The number of columns is the largest of `widths` that the rows reach,
    but at least two. Numbers beyond it are dropped, and missing numbers become NaN.
    """
    rows = _uncommented(found.rows[kind])
    if not rows:
        return np.zeros((0, max(least, 2)))
    width = len(rows[0].split())
    table = _uniform_table(rows, width) if width >= least else None
    if table is None:
        table = _uneven_table(rows, found.lines[kind], max(widths), least, decoded(kind), where)
    usable = max(w for w in widths if w <= table.shape[1])
    table = table[:, :usable]
    return table if usable > 1 else np.column_stack([table, np.zeros(len(table))])


def _uniform_table(rows: list[bytes], width: int) -> NDArray[np.float64] | None:
    """Parse all rows at once if each has exactly `width` numbers, otherwise return None."""
    tokens = b" ; ".join(rows).split()
    stride = width + 1
    if len(tokens) != stride * len(rows) - 1 or tokens[width::stride].count(b";") != len(rows) - 1:
        return None
    del tokens[width::stride]
    try:
        return np.array(list(map(float, tokens))).reshape(-1, width)
    except ValueError:
        return None


def _uneven_table(
    rows: list[bytes], lines: list[int], width: int, least: int, kind: str, where: str
) -> NDArray[np.float64]:
    table = np.full((len(rows), width), np.nan)
    junk = 0
    for i, row in enumerate(rows):
        words = row.split()
        values = _leading_numbers(words[:width])
        if len(values) < least:
            got = decoded(row).strip()[:60]
            raise EclatError(f"{where}, line {lines[i]}: expected {least} or more numbers after {kind}, got {got!r}")
        junk += len(values) < min(len(words), width)
        # Four numbers are a position with a weight, and five are one with an incomplete colour. The rest is not used.
        count = width if len(values) == width else least if width == 6 else len(values)
        table[i, :count] = values[:count]
    if kind == "vt":
        table[np.isnan(table[:, 1]), 1] = 0
    if junk:
        warn(f"{where}: {junk} {kind} lines have other text after the numbers, which is ignored")
    return table


def _leading_numbers(words: list[bytes]) -> list[float]:
    values = []
    for word in words:
        try:
            values.append(float(word))
        except ValueError:
            break
    return values


def _corners(found: _Statements, where: str) -> tuple[IntArray, IntArray]:
    """Parse the face corners.

    Returns
    -------
    (C, 3) indices of position, texture coordinates and normal from 0, with −1 for none, and (F,) corners of each face.
    """
    rows = _uncommented(found.faces)
    counts = np.array(list(map(len, map(bytes.split, rows))), dtype=np.int64)
    words = b" ".join(rows).split()
    lines = np.repeat(np.array(found.face_lines, dtype=np.int64), counts)
    indices = _uniform_corners(words) if words else np.zeros((0, 3), dtype=np.int64)
    if indices is None:
        indices = np.array(
            [_corner(word, line, where) for word, line in zip(words, lines.tolist(), strict=True)], dtype=np.int64
        )
    seen = np.repeat(np.array(found.face_seen, dtype=np.int64), counts, axis=0)
    totals = np.array([len(found.rows[kind.encode()]) for kind in _KINDS])
    # Cinema 4D writes the index 0 if a corner has no normal, although indices count from 1.
    zero = indices[:, 1:] == 0
    if zero.any():
        corner, column = (int(i) for i in np.argwhere(zero)[0])
        warn(
            f"{where}: {int(zero.any(axis=1).sum())} face corners have the index 0 of vt or vn (the first one in line "
            f"{lines[corner]}, {_KINDS[column + 1]}), although indices count from 1; the index is ignored"
        )
        indices[:, 1:][zero] = _ABSENT
    given = indices != _ABSENT
    places = np.where(indices > 0, indices - 1, seen + np.where(given, indices, 0))
    wrong = given & ((indices == 0) | (places < 0) | (places >= totals))
    if wrong.any():
        corner, column = (int(i) for i in np.argwhere(wrong)[0])
        raise EclatError(
            f"{where}, line {lines[corner]}: expected a {_KINDS[column]} index in 1..{totals[column]} "
            f"or a negative one, which counts back from this line, got {indices[corner, column]}"
        )
    return np.where(given, places, -1), counts


def _uniform_corners(words: list[bytes]) -> IntArray | None:
    """Parse all corners at once if all have the same form (v, v/t, v//n or v/t/n), otherwise return None."""
    slashes = words[0].count(b"/")
    joined = b" ".join(words)
    if b"//" in words[0]:
        columns, tokens, separator = [0, 2], joined.replace(b"//", b" ! ").split(), b"!"
    else:
        columns, tokens, separator = list(range(slashes + 1)), joined.replace(b"/", b" / ").split(), b"/"
    stride = 2 * len(columns) - 1
    if slashes > 2 or len(tokens) != stride * len(words):
        return None
    try:
        values = [np.array(list(map(int, tokens[2 * i :: stride])), dtype=np.int64) for i in range(len(columns))]
    except (ValueError, OverflowError):
        return None
    if any(tokens[i::stride].count(separator) != len(words) for i in range(1, stride, 2)):
        return None
    result = np.full((len(words), 3), _ABSENT)
    result[:, columns] = np.stack(values, axis=1)
    return result if np.abs(np.stack(values)).max() < _LARGEST_INDEX else None


def _corner(word: bytes, line: int, where: str) -> list[int]:
    parts = word.split(b"/")
    try:
        if len(parts) > 3 or not parts[0]:
            raise ValueError
        numbers = [int(part) if part else _ABSENT for part in parts]
    except ValueError:
        raise EclatError(
            f"{where}, line {line}: expected a face corner like 7, 7/3, 7//2 or 7/3/2, got {decoded(word)[:40]!r}"
        ) from None
    # Clipped indices fit into the arrays and are still out of range, so that the range check reports them.
    limited = [n if n == _ABSENT else max(-_LARGEST_INDEX, min(n, _LARGEST_INDEX)) for n in numbers]
    return limited + [_ABSENT] * (3 - len(parts))
