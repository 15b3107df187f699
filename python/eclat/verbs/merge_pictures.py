# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Partial pictures, which array jobs render by `shard` or `crop`, become the whole picture."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError
from eclat.images.image import Image
from eclat.typed import typed
from eclat.verbs.continuing import KEY, Begun, checksum_of

SUMMED = ("rays", "seconds")
"""The statistics of parts that are added up. Others are kept if all parts have the same."""


@typed
def merge_pictures(parts: Sequence[Image | str | os.PathLike[str]]) -> Image:
    """Merge pictures of parts of a view, rendered with `shard`, or with `crop` and `continuable`, into the whole
    picture.

    It has the bits of a picture that was rendered at once, and can be continued like that one.

    Parameters
    ----------
    parts : Images, or names of .exr files, which cover each pixel once. They were rendered with `samples`, without
        adaptive sampling, halves or a denoiser, which is so by default if `crop` and `samples` are given.

    Raises
    ------
    EclatError : a part is no continuable picture, parts differ in more than their crop, or they overlap or leave a gap.

    Examples
    --------
    >>> import eclat
    >>> halves = [eclat.render("furnace", "path", samples=2, size=(8, 8), shard=(i, 2)) for i in (1, 2)]
    >>> whole = eclat.render("furnace", "path", samples=2, size=(8, 8))
    >>> bool((eclat.merge_pictures(halves).pixels == whole.pixels).all())
    True
    """
    if not parts:
        raise EclatError("merge: expected at least one picture, got none")
    begun = [Begun.of(part) for part in parts]
    first = begun[0]
    for part in begun:
        _require_match(part, first)
    regions = [_region(part) for part in begun]
    _require_cover(begun, regions)
    pixels = _pasted([part.image.pixels for part in begun], regions)
    layers = {
        name: _pasted([part.image.layers[name] for part in begun], regions)
        for name in first.image.layers
        if all(name in part.image.layers for part in begun)
    }
    metadata = first.image.metadata | {"statistics": _statistics(begun)}
    if isinstance(settings := metadata.get("settings"), dict):
        metadata["settings"] = settings | {"crop": None}  # those of the command that would have rendered it at once
    metadata |= _bad_samples(begun)
    metadata[KEY] = first.state | {"crop": None, "checksum": checksum_of(layers)}
    return Image(pixels, layers, metadata)


def _require_match(part: Begun, first: Begun) -> None:
    own, other = (
        {name: value for name, value in one.state.items() if name not in ("crop", "checksum")}
        | {name: one.image.metadata.get(name) for name in ("method", "options", "version")}
        | {"samples": one.samples, "pixels": one.image.pixels.shape}
        for one in (part, first)
    )
    for name in own:
        if own[name] != other.get(name):
            raise EclatError(f"{part.name}: expected {name} as in {first.name}, {other.get(name)}, got {own[name]}")
    for name in ("adaptive", "halves"):
        if part.state[name]:
            raise EclatError(
                f"{part.name}: expected a picture without {name}, whose parts depend on the whole, got one with it"
            )


def _region(part: Begun) -> tuple[slice, slice]:
    height, width = part.image.pixels.shape[:2]
    x0, y0, x1, y1 = part.state["crop"] or (0, 0, width, height)
    return np.s_[y0:y1, x0:x1]


def _require_cover(parts: list[Begun], regions: list[tuple[slice, slice]]) -> None:
    covered = np.zeros(parts[0].image.pixels.shape[:2], np.int64)
    for part, region in zip(parts, regions, strict=True):
        if covered[region].any():
            y, x = np.argwhere(covered[region])[0] + (region[0].start, region[1].start)
            raise EclatError(f"{part.name}: expected parts that do not overlap, but pixel ({x}, {y}) is in two")
        covered[region] = 1
    if not covered.all():
        y, x = np.argwhere(covered == 0)[0]
        missing = int((covered == 0).sum())
        raise EclatError(
            f"merge: expected parts that cover the picture, but {missing:,} pixels are in none, first ({x}, {y})"
        )


def _pasted(arrays: list[NDArray[np.float32]], regions: list[tuple[slice, slice]]) -> NDArray[np.float32]:
    whole = np.zeros_like(arrays[0])
    for array, region in zip(arrays, regions, strict=True):
        whole[region] = array[region]
    return whole


def _statistics(parts: list[Begun]) -> dict[str, float]:
    each = [part.image.metadata["statistics"] for part in parts]
    kept = {name: value for name, value in each[0].items() if all(one.get(name) == value for one in each)}
    return kept | {name: sum(one.get(name, 0.0) for one in each) for name in SUMMED}


def _bad_samples(parts: list[Begun]) -> dict[str, Any]:
    bad = [found for part in parts if (found := part.image.metadata.get("bad_samples"))]
    if not bad:
        return {}
    first = min((found["first"] for found in bad), key=lambda at: (at[2], at[1], at[0]))
    return {"bad_samples": {"count": sum(found["count"] for found in bad), "first": first}}
