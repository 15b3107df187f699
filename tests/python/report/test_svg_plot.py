# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The plot: where points land, which numbers stand at the axes."""

from __future__ import annotations

import itertools
import math
import xml.etree.ElementTree as ElementTree

import pytest

from eclat.report.svg_plot import BOTTOM, HEIGHT, LEFT, RIGHT, TOP, WIDTH, log_log_plot, ticks


def plot(series: dict[str, list[tuple[float, float]]]) -> ElementTree.Element:
    return ElementTree.fromstring(log_log_plot(series, "seconds", "error", lambda y: f"{y:g}"))


def test_ticks_are_round_numbers() -> None:
    assert ticks(0.2, 10) == pytest.approx([0.2, 0.5, 1, 2, 5, 10])
    assert ticks(1e-4, 1e4) == pytest.approx([10.0**e for e in range(-4, 5)])


def test_points_stand_inside_on_a_straight_line_for_a_power_law() -> None:
    root = plot({"path": [(t, 0.3 / math.sqrt(t)) for t in (0.5, 2.0, 8.0)]})
    marks = [(float(c.attrib["cx"]), float(c.attrib["cy"])) for c in root.iter("circle")]
    (x0, y0), (x1, y1), (x2, y2) = marks
    assert x1 - x0 == pytest.approx(x2 - x1, abs=0.2)
    assert y1 - y0 == pytest.approx(y2 - y1, abs=0.2)
    assert LEFT < x0 < x2 < WIDTH - RIGHT
    assert TOP < y0 < y2 < HEIGHT - BOTTOM


def test_the_names_of_lines_do_not_overlap() -> None:
    root = plot({name: [(1.0, 0.1), (2.0, 0.05 * (1 + 1e-3 * i))] for i, name in enumerate("abcd")})
    places = sorted(float(text.attrib["y"]) for text in root.iter("text") if text.attrib["text-anchor"] == "start")
    assert len(places) == 4
    assert min(b - a for a, b in itertools.pairwise(places)) > 14.9


def test_points_without_logarithm_are_left_out() -> None:
    root = plot({"a": [(0.0, 1.0), (1.0, math.nan), (1.0, 0.1), (math.inf, 0.1)], "b": []})
    assert len(list(root.iter("circle"))) == 1
    assert log_log_plot({"a": [(1.0, 0.0)]}, "x", "y", str) == "<p>No point can be drawn.</p>"


def test_names_are_escaped() -> None:
    assert "<b>" not in log_log_plot({"<b>": [(1.0, 1.0)]}, "<x>", '"y"', str)
