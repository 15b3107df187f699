# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Which frames an animation has, when each is taken, and which files they become."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from eclat.errors import EclatError, shown

SUFFIXES = (".exr", ".png")
"""The suffixes of files of frames. Both hold metadata, by which finished frames are known."""
VIDEO = ".mp4"
MOST_FRAMES = 1_000_000
_NUMBER = re.compile(r"%(0(\d+))?d")


@dataclass(frozen=True)
class Frame:
    """A frame: its number, its time in seconds, and its file."""

    number: int
    time: float
    path: Path


@dataclass(frozen=True)
class Plan:
    """All frames of an animation, those of them that are this process's share, and the video, if one is wanted."""

    frames: tuple[Frame, ...]
    mine: tuple[Frame, ...]
    fps: float
    video: Path | None


def make_plan(frames: Sequence[int], fps: float, output: str | os.PathLike[str], shard: tuple[int, int] | None) -> Plan:
    """Plan an animation. Frame n shows the scene at n / `fps` seconds.

    Parameters
    ----------
    frames : the numbers of the frames, which differ.
    fps : frames per second.
    output : the name of the files, with %d or %04d in the place of the number, or that of a video, whose frames then lie in
        a folder of its name beside it.
    shard : (i, n) for each n-th frame from the i-th on, counted from 1; None for all frames.

    Raises
    ------
    EclatError : there are no frames or too many, a number is negative or occurs twice, or another argument is invalid.
    """
    numbers = [int(n) for n in frames]
    if not 1 <= len(numbers) <= MOST_FRAMES or len(set(numbers)) != len(numbers) or min(numbers) < 0:
        raise EclatError(f"frames: expected 1 to {MOST_FRAMES:,} different numbers of at least 0, got {shown(frames)}")
    if not 0 < fps <= 1e6:
        raise EclatError(f"fps: expected a number of frames per second above 0, got {fps!r}")
    if shard is not None and not 1 <= shard[0] <= shard[1]:
        raise EclatError(f"shard: expected i/n with 1 ≤ i ≤ n, got {shard[0]}/{shard[1]}")
    name = os.fspath(output)
    video = Path(name) if Path(name).suffix.lower() == VIDEO else None
    if video is not None:
        name = str(video.with_suffix(".frames") / "%06d.png").replace("%%", "%")
    planned = tuple(Frame(n, n / fps, Path(_named(name, n, len(numbers)))) for n in numbers)
    mine = planned if shard is None else planned[shard[0] - 1 :: shard[1]]
    return Plan(planned, mine, fps, video)


def parse_frames(text: str) -> range:
    """Parse `first:last` or `first:last:step`, both ends inclusive, or a single number. Raises EclatError."""
    match = re.fullmatch(r"(\d{1,9})(?::(\d{1,9})(?::(\d{1,9}))?)?", text.strip())
    first, last, step = (match[1], match[2] or match[1], match[3] or "1") if match else ("1", "0", "1")
    if int(last) < int(first) or int(step) < 1:
        raise EclatError(f"expected frames as FIRST:LAST or FIRST:LAST:STEP, such as 0:119, got {shown(text)}")
    return range(int(first), int(last) + 1, int(step))


def parse_shard(text: str) -> tuple[int, int]:
    """Parse `i/n`. Raises EclatError."""
    match = re.fullmatch(r"(\d{1,6})/(\d{1,6})", text.strip())
    if not match or not 1 <= int(match[1]) <= int(match[2]):
        raise EclatError(f"expected I/N with 1 ≤ I ≤ N, such as 2/3, got {shown(text)}")
    return int(match[1]), int(match[2])


def _named(name: str, number: int, count: int) -> str:
    """Return the name of the file of a frame."""
    if Path(name).suffix.lower() not in SUFFIXES:
        raise EclatError(f"output: expected a name that ends in {', '.join(SUFFIXES)} or {VIDEO}, got {name!r}")
    places = list(_NUMBER.finditer(name))
    if len(places) > 1 or (not places and count > 1):
        raise EclatError(f"output: expected one %d or %04d for the number of the frame, got {name!r}")
    if not places:
        return name
    place = places[0]
    return name[: place.start()] + str(number).zfill(int(place[2] or 0)) + name[place.end() :]


def coarse_to_fine(count: int) -> list[int]:
    """Order the indices 0 to `count` − 1 so that each further one lies in a large gap: by the bits of the index, reversed
    [van der Corput's sequence], the ends first.
    """
    bits = max(1, (count - 1).bit_length())
    order = sorted(range(1 << bits), key=lambda i: int(format(i, f"0{bits}b")[::-1], 2))
    inner = [i for i in order if 0 < i < count - 1]
    return [0, *([count - 1] if count > 1 else []), *inner]
