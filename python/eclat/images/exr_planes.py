# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read the channels of an OpenEXR file on its display window, as RGB with Rec. 709 primaries.

A file may differ from this form in three ways. Its data window may cover a part of the display window or exceed it. Its
primaries may differ from those of Rec. 709. Its colours may be stored as luminance and chroma (Y, RY, BY), with the
chroma at half the resolution.
"""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import OpenEXR
from numpy.typing import NDArray

from eclat.errors import EclatError, warn

REC_709 = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
"""The chromaticities x, y of red, green, blue and white in Rec. 709 [ITU-R BT.709, table 1]."""

_SAME = 2e-3
"""The largest difference at which chromaticities count as equal. Files write them with three or more digits."""

Float32 = NDArray[np.float32]
Float64 = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Planes:
    """The part of an OpenEXR file that is read.

    `channels` has the channels (H, W) by name, and `converted` is whether their colours have been converted.
    """

    header: dict[str, Any]
    channels: dict[str, Float32]
    converted: bool


def read_planes(data: bytes, where: str, check_size: Callable[[int, int], None]) -> Planes:
    """Read the channels of one part of an OpenEXR file: the first part with colours, or without colours the first one.
    Other parts are left out, with a warning.

    Each channel has the size of the display window. Pixels without data in the file are zero. The channels R, G, B (or
    Y, RY, BY) of each layer are converted to R, G, B with Rec. 709 primaries. The conversion keeps the XYZ colour,
    without chromatic adaptation to another white point, as in other programs.

    Parameters
    ----------
    data : the bytes of the file.
    where : the file, for warnings.
    check_size : a function that raises EclatError if a width and a height are too large.

    Raises
    ------
    EclatError : `check_size` raises it, the data window is outside the display window, or the pixels are missing.
    Exception : the library may raise any type of exception if the file is invalid.
    """
    headers = [dict(part.header) for part in OpenEXR.File(io.BytesIO(data), header_only=True).parts]
    for header in headers:  # The library reads the pixels of all parts.
        for x0, y0, x1, y1 in _windows(header):
            check_size(x1 - x0, y1 - y0)
    which = next((i for i, header in enumerate(headers) if _has_colors(header)), 0)
    header = headers[which]
    window, display = _windows(header)
    if max(window[0], display[0]) >= min(window[2], display[2]) or max(window[1], display[1]) >= min(
        window[3], display[3]
    ):
        raise EclatError(f"expected a data window that overlaps the display window {display}, got {window}")
    file = OpenEXR.File(io.BytesIO(data), separate_channels=True)
    if not file.parts:
        raise EclatError("expected the pixels that the header announces, but the file is truncated or damaged")
    if len(headers) > 1:
        names = ", ".join(repr(str(h.get("name", ""))[:40]) for i, h in enumerate(headers[:8]) if i != which)
        warn(f"{where}: {len(headers) - 1} of {len(headers)} parts of the file are ignored: {names}")
    channels = {}
    with np.errstate(all="ignore"):  # Pixels may be infinite or NaN.
        for name, channel in file.channels(which).items():
            plane = _full_size(np.asarray(channel.pixels), (channel.xSampling, channel.ySampling), window)
            if plane is not None:
                channels[name] = _cropped(plane, window, display)
        to_xyz = _rgb_to_xyz(header.get("chromaticities"), where)
        converted = _undo_luminance_chroma(channels, to_xyz[1])
        if not np.array_equal(to_xyz, _rgb_to_xyz(None, where)):
            _convert(channels, np.linalg.inv(_rgb_to_xyz(None, where)) @ to_xyz)
            converted = True
    return Planes(header, channels, converted)


def rgb_to_xyz(chromaticities: tuple[float, ...]) -> Float64 | None:
    """Return the 3×3 matrix from RGB to XYZ for which white has Y = 1 [SMPTE RP 177].

    `chromaticities` are x and y of red, green, blue and white. The result is None if they are not valid primaries.
    """
    if len(chromaticities) != 8 or not np.isfinite(chromaticities).all():
        return None
    x, y = np.asarray(chromaticities, dtype=np.float64).reshape(4, 2).T
    columns = np.array([x, y, 1 - x - y])
    primaries, white = columns[:, :3], columns[:, 3]
    if white[1] <= 0 or abs(np.linalg.det(primaries)) < 1e-6:
        return None
    return np.asarray(primaries * np.linalg.solve(primaries, white / white[1]), dtype=np.float64)


def _rgb_to_xyz(chromaticities: Any, where: str) -> Float64:
    """Return the 3×3 matrix from RGB to XYZ for the header attribute `chromaticities`.

    It is the matrix of Rec. 709 if the attribute is absent, nearly equal or, with a warning, invalid.
    """
    standard = rgb_to_xyz(REC_709)
    assert standard is not None
    if chromaticities is None:
        return standard
    given = tuple(float(value) for value in np.ravel(chromaticities))
    if len(given) == 8 and np.abs(np.subtract(given, REC_709)).max() < _SAME:
        return standard
    found = rgb_to_xyz(given)
    if found is None:
        warn(f"{where}: the chromaticities {given} are not valid primaries; those of Rec. 709 are used instead")
        return standard
    return found


def _window(corners: Any) -> tuple[int, int, int, int]:
    """Return the corners of a window as (x0, y0, x1, y1), where x1 and y1 are exclusive."""
    (x0, y0), (x1, y1) = corners
    return int(x0), int(y0), int(x1) + 1, int(y1) + 1


def _windows(header: dict[str, Any]) -> tuple[tuple[int, int, int, int], tuple[int, int, int, int]]:
    """Return the data window and the display window of a part."""
    return _window(header["dataWindow"]), _window(header.get("displayWindow", header["dataWindow"]))


def _has_colors(header: dict[str, Any]) -> bool:
    """Return whether a part has the channels R, G and B, or Y, in a layer or in none."""
    letters = {str(channel.name).rpartition(".")[2] for channel in header["channels"]}
    return {"R", "G", "B"} <= letters or "Y" in letters


def _full_size(
    plane: NDArray[Any], sampling: tuple[int, int], window: tuple[int, int, int, int]
) -> NDArray[Any] | None:
    """Interpolate a subsampled channel to one value for each pixel of `window`.

    `sampling` is the distance of its samples in x and y. The result is None if the size of the channel does not match.
    """
    x0, y0, x1, y1 = window
    for axis, step, start, end in ((1, sampling[0], x0, x1), (0, sampling[1], y0, y1)):
        if step == 1:
            if plane.ndim != 2 or plane.shape[axis] != end - start:
                return None
            continue
        # Samples are at the multiples of the sampling [OpenEXR file layout, channels]. Between them, the interpolation
        # is linear.
        places = np.arange(-(-start // step), (end - 1) // step + 1) * step
        if plane.ndim != 2 or not 0 < plane.shape[axis] <= len(places):
            return None
        places = places[: plane.shape[axis]]
        at = np.clip(np.arange(start, end), places[0], places[-1])
        low = (at - places[0]) // step
        high = np.minimum(low + 1, len(places) - 1)
        weight = ((at - places[low]) / step).astype(np.float32)
        weight = weight if axis == 1 else weight[:, None]
        first, second = np.take(plane, low, axis=axis), np.take(plane, high, axis=axis)
        plane = first * (1 - weight) + second * weight
    return plane


def _cropped(plane: NDArray[Any], window: tuple[int, int, int, int], display: tuple[int, int, int, int]) -> Float32:
    """Crop a channel that covers `window` to the `display` window. Pixels outside `window` become zero."""
    plane = plane.astype(np.float32)
    if window == display:
        return plane
    (x0, y0, x1, y1), (dx0, dy0, dx1, dy1) = window, display
    result = np.zeros((dy1 - dy0, dx1 - dx0), np.float32)
    left, top, right, bottom = max(x0, dx0), max(y0, dy0), min(x1, dx1), min(y1, dy1)
    result[top - dy0 : bottom - dy0, left - dx0 : right - dx0] = plane[top - y0 : bottom - y0, left - x0 : right - x0]
    return result


def _layers_of(channels: dict[str, Float32], letters: tuple[str, ...]) -> list[str]:
    """Return the prefix of each layer that has a channel for each of the `letters`: "", or the layer's name with a dot."""
    starts = [name.removesuffix(letters[0]) for name in channels if name.rpartition(".")[2] == letters[0]]
    return [start for start in starts if all(f"{start}{letter}" in channels for letter in letters)]


def _undo_luminance_chroma(channels: dict[str, Float32], weights: Float64) -> bool:
    """Convert luminance and chroma channels in place to R, G, B [OpenEXR, ImfRgbaYca].

    The channels are Y, RY = (R − Y)/Y and BY = (B − Y)/Y, where Y is the sum of R, G, B with the `weights` (3,). Returns
    whether there were such channels.
    """
    starts = _layers_of(channels, ("Y", "RY", "BY"))
    for start in starts:
        y, ry, by = (channels.pop(f"{start}{letter}") for letter in ("Y", "RY", "BY"))
        red, blue = (ry + 1) * y, (by + 1) * y
        wr, wg, wb = (np.float32(weight) for weight in weights)
        channels |= {f"{start}R": red, f"{start}G": (y - wr * red - wb * blue) / wg, f"{start}B": blue}
    return bool(starts)


def _convert(channels: dict[str, Float32], matrix: Float64) -> None:
    """Multiply the colours of all layers in place by the 3×3 `matrix`."""
    for start in _layers_of(channels, ("R", "G", "B")):
        names = [f"{start}{letter}" for letter in "RGB"]
        red, green, blue = (channels[name] for name in names)
        for name, (r, g, b) in zip(names, matrix.astype(np.float32), strict=True):
            channels[name] = r * red + g * green + b * blue
