# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A log-log plot as inline SVG, with lines and markers, ticks at 1, 2 and 5, and names at the ends of the lines."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from html import escape

Points = Sequence[tuple[float, float]]

WIDTH, HEIGHT = 760.0, 400.0
"""Size of the plot in SVG units."""
LEFT, RIGHT, TOP, BOTTOM = 76.0, 150.0, 16.0, 48.0
"""Margins around the axes in SVG units."""

COLORS = ("#d55e00", "#0072b2", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
"""Colours of the lines, which colour-blind people can distinguish too [Okabe and Ito 2008, *Color Universal
Design*]."""

LABEL_SPACING = 15.0
"""Least distance between the names at the right in SVG units, a little more than their height."""


def log_log_plot(series: Mapping[str, Points], x_label: str, y_label: str, y_text: Callable[[float], str]) -> str:
    """Draw the plot as an `<svg>` element. Points that have no logarithm are left out; if no point is left, return a
    sentence.

    Parameters
    ----------
    series : maps the name of each line to its points (x, y), which are drawn in order of x.
    y_text : function that formats the number at a tick of the y axis.
    """
    drawn = {name: sorted(p for p in points if _positive(p)) for name, points in series.items()}
    every = [point for points in drawn.values() for point in points]
    if not every:
        return "<p>No point can be drawn.</p>"
    x_low, x_high = _limits([x for x, _ in every])
    y_low, y_high = _limits([y for _, y in every])

    def place(point: tuple[float, float]) -> tuple[float, float]:
        across = math.log(point[0] / x_low) / math.log(x_high / x_low)
        along = math.log(point[1] / y_low) / math.log(y_high / y_low)
        return LEFT + across * (WIDTH - LEFT - RIGHT), HEIGHT - BOTTOM - along * (HEIGHT - TOP - BOTTOM)

    parts = [
        f'<svg viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="img" aria-label="{escape(y_label)} against {escape(x_label)}">'
    ]
    for value in ticks(x_low, x_high):
        x, _ = place((value, y_low))
        parts += [_line(x, TOP, x, HEIGHT - BOTTOM), _text(x, HEIGHT - BOTTOM + 18, f"{value:g}", "middle")]
    for value in ticks(y_low, y_high):
        _, y = place((x_low, value))
        parts += [_line(LEFT, y, WIDTH - RIGHT, y), _text(LEFT - 8, y + 4, y_text(value), "end")]
    parts.append(_text((LEFT + WIDTH - RIGHT) / 2, HEIGHT - 8, x_label, "middle"))
    middle = (TOP + HEIGHT - BOTTOM) / 2
    parts.append(f'<g transform="rotate(-90 14 {middle:g})">{_text(14, middle, y_label, "middle")}</g>')
    ends: list[tuple[float, float, str, str]] = []
    for i, (name, points) in enumerate(drawn.items()):
        if points:
            color, placed = COLORS[i % len(COLORS)], [place(point) for point in points]
            parts += [_curve(placed, color), *(_marker(x, y, color, i) for x, y in placed)]
            ends.append((placed[-1][1], placed[-1][0], name, color))
    return "\n".join([*parts, *_names(ends), "</svg>"])


def ticks(low: float, high: float) -> list[float]:
    """List 1, 2 and 5 times the powers of ten from `low` to `high`, or only the powers of ten if there are more than
    twelve."""
    first, last = math.floor(math.log10(low)), math.ceil(math.log10(high))
    within = (low * (1 - 1e-9), high * (1 + 1e-9))
    values = [m * 10.0**e for e in range(first, last + 1) for m in (1, 2, 5) if within[0] <= m * 10.0**e <= within[1]]
    return values if len(values) <= 12 else [v for v in values if abs(math.log10(v) - round(math.log10(v))) < 1e-9]


def _limits(values: Sequence[float]) -> tuple[float, float]:
    """Return the nearest ticks outside the values, so that no point lies on the frame and both ends have a number."""
    steps = [m * 10.0**e for e in range(-30, 31) for m in (1, 2, 5)]
    low = max((s for s in steps if s < 0.95 * min(values)), default=steps[0])
    high = min((s for s in steps if s > 1.05 * max(values)), default=steps[-1])
    return low, high


def _positive(point: tuple[float, float]) -> bool:
    return all(math.isfinite(value) and value > 0 for value in point)


def _line(x0: float, y0: float, x1: float, y1: float) -> str:
    return f'<line x1="{x0:.1f}" y1="{y0:.1f}" x2="{x1:.1f}" y2="{y1:.1f}" stroke="currentColor" stroke-opacity=".15"/>'


def _text(x: float, y: float, text: str, anchor: str, color: str = "currentColor") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{color}" font-size="13">{escape(text)}</text>'


def _curve(points: Points, color: str) -> str:
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    return f'<polyline points="{path}" fill="none" stroke="{color}" stroke-width="2"/>'


def _marker(x: float, y: float, color: str, shape: int) -> str:
    if shape % 3 == 0:
        return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{color}"/>'
    if shape % 3 == 1:
        return f'<rect x="{x - 4:.1f}" y="{y - 4:.1f}" width="8" height="8" fill="{color}"/>'
    return f'<path d="M{x:.1f},{y - 5:.1f}l5,9h-10z" fill="{color}"/>'


def _names(ends: Sequence[tuple[float, float, str, str]]) -> list[str]:
    """Write the names beside the last points, moved down where they would overlap."""
    parts: list[str] = []
    lowest = -math.inf
    for y, x, name, color in sorted(ends):
        lowest = max(y, lowest + LABEL_SPACING)
        parts.append(_text(x + 9, lowest + 4, name, "start", color))
    return parts
