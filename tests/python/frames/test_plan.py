# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Numbers, times and files of frames."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from eclat.errors import EclatError
from eclat.frames.plan import coarse_to_fine, make_plan, parse_frames, parse_shard


def test_names_and_times() -> None:
    plan = make_plan(range(3), 2.0, "out/%04d.exr", None)
    assert [(f.number, f.time, str(f.path)) for f in plan.frames] == [
        (0, 0.0, "out/0000.exr"), (1, 0.5, "out/0001.exr"), (2, 1.0, "out/0002.exr"),
    ]  # fmt: skip
    assert plan.mine == plan.frames
    assert str(make_plan([12], 24, "still.png", None).frames[0].path) == "still.png"
    assert str(make_plan([12], 24, "%d.PNG", None).frames[0].path) == "12.PNG"


def test_shards_share_all_frames() -> None:
    shards = [make_plan(range(10), 24, "%d.png", (i, 3)).mine for i in (1, 2, 3)]
    assert [len(shard) for shard in shards] == [4, 3, 3]
    assert sorted(frame.number for shard in shards for frame in shard) == list(range(10))


def test_the_frames_of_a_video() -> None:
    plan = make_plan(range(2), 24, "a/walk.mp4", None)
    assert plan.video == Path("a/walk.mp4")
    assert str(plan.frames[1].path) == "a/walk.frames/000001.png"


@pytest.mark.parametrize(
    ("frames", "fps", "output", "shard", "words"),
    [
        ([], 24, "%d.png", None, "frames: expected 1 to"),
        ([1, 1], 24, "%d.png", None, "different numbers"),
        ([-1], 24, "%d.png", None, "at least 0"),
        ([1], 0, "%d.png", None, "fps"),
        ([1], float("nan"), "%d.png", None, "fps"),
        ([1, 2], 24, "a.png", None, "one %d"),
        ([1], 24, "%d-%d.png", None, "one %d"),
        ([1], 24, "%d.pfm", None, r"expected a name that ends in \.exr, \.png or \.mp4"),
        ([1], 24, "%d.png", (3, 2), "shard"),
    ],
)
def test_mistakes_are_named(frames: Any, fps: float, output: str, shard: Any, words: str) -> None:
    with pytest.raises(EclatError, match=words):
        make_plan(frames, fps, output, shard)


def test_texts() -> None:
    assert parse_frames("0:119") == range(120)
    assert parse_frames("5") == range(5, 6)
    assert list(parse_frames("0:10:5")) == [0, 5, 10]
    assert parse_shard("2/3") == (2, 3)
    for text in ("", "a", "5:4", "0:9:0", "1:2:3:4", "-1:4", "9" * 40):
        with pytest.raises(EclatError, match="FIRST:LAST"):
            parse_frames(text)
    for text in ("", "0/3", "4/3", "1/0", "x"):
        with pytest.raises(EclatError, match="I/N"):
            parse_shard(text)


@pytest.mark.parametrize("count", [1, 2, 3, 8, 9, 120])
def test_the_order_of_views_is_coarse_to_fine(count: int) -> None:
    order = coarse_to_fine(count)
    assert sorted(order) == list(range(count))
    if count == 9:
        assert order[:4] == [0, 8, 4, 2]
