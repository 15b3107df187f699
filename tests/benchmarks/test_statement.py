# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""benchmarks/statement.py: what it counts, that it goes on where it was stopped, and its scenes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import eclat
import statement
from harness import references
from harness.benchmark import Settings
from harness.scenes import BenchmarkScene
from harness.variants import ROOMS, overcast, small_lamp, turned


def run_row(max_error: float, error: float, stated: float, high: float, reason: str = "") -> dict[str, Any]:
    return {"max_error": max_error, "seed": 0, "error": error, "stated": stated, "high": high, "reason": reason,
            "processor": 2.0}  # fmt: skip


def test_the_table_counts_broken_promises() -> None:
    runs = [
        run_row(0.05, 0.04, 0.045, 0.05), run_row(0.05, 0.048, 0.045, 0.05), run_row(0.05, 0.07, 0.06, 0.065, "records"),
        run_row(0.05, 0.02, 0.055, 0.06), run_row(0.03, 0.03, 0.025, 0.029),
    ]  # fmt: skip
    text = statement.tables({"scenes": {"room": {"runs": runs}}})
    assert "| room | 5 % | 4 | 4.40 % | 5.00 % | 1.17 | 2 | 1 | 2 | 1 | 2 s |" in text
    assert "| room | 3 % | 1 | 3.00 % | 2.50 % | 1.20 | 1 | 1 | 0 | 0 | 2 s |" in text
    assert "| all |  | 5 |" in text


def test_a_run_keeps_the_reason_that_the_command_line_gives() -> None:
    statistics = {
        "estimated_error": 0.06,
        "estimated_error_low": 0.05,
        "estimated_error_high": 0.07,
        "cache_error": 0.05,
    }
    kept = statement.judged(statistics, 0.055, 0.03)
    assert (kept["error"], kept["stated"], kept["cache_error"]) == (0.055, 0.06, 0.05)
    assert "records" in kept["reason"] and statement.judged(statistics, 0.055, 0.07)["reason"] == ""


def test_it_goes_on_where_it_was_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(statement, "RUNS", tmp_path)
    monkeypatch.setattr(statement, "MAX_ERRORS", (0.2,))
    monkeypatch.setattr(references, "FOLDER", tmp_path / "references")
    settings = Settings(False, ("furnace",), 1, 2, 64, 16)
    place = BenchmarkScene("furnace", (16, 16))
    first = statement.run("furnace", place, settings)["runs"]
    assert len(first) == 1 and first[0]["error"] < 0.2 and first[0]["high"] >= first[0]["stated"]
    (stored,) = tmp_path.glob("*.json")
    stored.write_text(json.dumps([first[0] | {"error": 0.125}]))
    again = statement.run("furnace", place, settings)["runs"]
    assert [row["error"] for row in again] == [0.125]


def test_variants_keep_the_light_of_the_lamp_and_turn_the_sky() -> None:
    box = eclat.load("cornell-box")
    lamp, small = box.meshes[0], small_lamp(box).meshes[0]
    assert np.ptp(small.positions, axis=0) == pytest.approx(np.ptp(lamp.positions, axis=0) / 4, rel=1e-5)
    assert small.positions.mean(axis=0) == pytest.approx(lamp.positions.mean(axis=0), abs=1e-6)
    assert lamp.material.emission is not None and small.material.emission is not None
    assert small.material.emission.constant[0] == pytest.approx(16 * lamp.material.emission.constant[0])
    atrium = eclat.load("atrium")
    sky, before = turned(atrium).environment, atrium.environment
    assert sky is not None and before is not None
    assert sky.to_world @ np.linalg.inv(before.to_world) @ (0, 0, 1) == pytest.approx((1, 0, 0), abs=1e-6)
    assert overcast(atrium).lights == ()


def test_there_are_twenty_scenes_and_the_built_in_ones_load() -> None:
    assert len(ROOMS) == 20
    for place in ROOMS.values():
        if "/" not in place.source:
            assert place.load().meshes
