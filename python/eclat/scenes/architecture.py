# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Parts of a Renaissance courtyard, with lengths in metres. Unless stated otherwise, they stand on y = 0, centred on
the y axis."""

from __future__ import annotations

import math

import numpy as np

from eclat.scenes.geometry import Point2, Solid, box, icosphere, join, revolve


def bead(radius: float, bottom: float, top: float, bulge: float, points: int = 4) -> list[Point2]:
    """Make the profile of a half-round moulding; a negative `bulge` makes it concave."""
    return [
        (radius + bulge * math.sin(math.pi * k / (points - 1)), bottom + (top - bottom) * k / (points - 1))
        for k in range(points)
    ]


def column(height: float, radius: float, segments: int, fine: int = 4) -> Solid:
    """Make a Tuscan column: plinth, Attic base, shaft with entasis, necking, echinus, and an abacus 2.82 radii wide.

    `fine` is the number of points of each curve in its profile.
    """
    r = radius
    base = [(1.34 * r, 0.42 * r), *bead(1.26 * r, 0.42 * r, 0.74 * r, 0.12 * r, fine), (1.2 * r, 0.78 * r)]
    base += [(1.14 * r, 0.84 * r), (1.14 * r, 0.93 * r), (1.2 * r, 0.98 * r)]
    base += [*bead(1.12 * r, 1.0 * r, 1.22 * r, 0.1 * r, fine), (1.08 * r, 1.26 * r), (1.02 * r, 1.36 * r)]
    foot, neck = 1.5 * r, height - 1.62 * r
    shaft = []
    for t in np.linspace(0, 1, fine):
        shaft.append((r * (1.0 - 0.15 * t**1.8), foot + (neck - foot) * float(t)))
    capital = [*bead(0.87 * r, neck + 0.04 * r, neck + 0.2 * r, 0.09 * r, fine), (0.85 * r, neck + 0.25 * r)]
    capital += [(0.85 * r, height - 1.02 * r), (0.92 * r, height - 0.97 * r), (0.92 * r, height - 0.88 * r)]
    for angle in np.linspace(0, math.pi / 2, fine):
        capital.append((r * (0.98 + 0.33 * math.sin(angle)), height - r * (0.42 + 0.4 * math.cos(angle))))
    capital.append((1.3 * r, height - 0.34 * r))
    plinth = box((-1.4 * r, -0.02, -1.4 * r), (1.4 * r, 0.45 * r, 1.4 * r))
    slab = box((-1.36 * r, height - 0.36 * r, -1.36 * r), (1.36 * r, height - 0.11 * r, 1.36 * r))
    lip = box((-1.41 * r, height - 0.13 * r, -1.41 * r), (1.41 * r, height, 1.41 * r))
    return join([revolve(base + shaft + capital, segments), plinth, slab, lip])


def baluster(height: float, segments: int) -> Solid:
    """Make a vase-shaped baluster on a round foot."""
    shape = [(0.062, 0.0), (0.062, 0.07), (0.04, 0.12), (0.072, 0.3), (0.066, 0.4), (0.04, 0.56), (0.034, 0.74)]
    shape += [(0.052, 0.82), (0.04, 0.88), (0.06, 0.94), (0.06, 1.0)]
    return revolve([(r, y * height) for r, y in shape], segments, crease=60)


def corbel(width: float, projection: float, drop: float) -> Solid:
    """Make a bell-shaped corbel that carries a rib; half of it is inside the wall at z = 0, and its top is at y = 0."""
    shape = [(0.06, -1.0), (0.17, -0.97), (0.22, -0.9), (0.17, -0.83), (0.24, -0.78), (0.38, -0.68), (0.58, -0.5)]
    shape += [(0.75, -0.3), (0.83, -0.2), (0.95, -0.14), (0.95, 0.0)]
    return revolve(shape, 12).scaled(width / 2, drop, projection)


def fountain() -> Solid:
    """Make a fountain, about 2.9 m high: an octagonal basin on two steps, with two bowls on a stem."""
    octagons = [
        revolve([(2.35, -0.05), (2.35, 0.15)], 8, crease=1),
        revolve([(2.0, 0.1), (2.0, 0.31)], 8, crease=1),
        revolve(
            [(1.62, 0.25), (1.62, 0.38), (1.5, 0.45), (1.5, 0.8), (1.6, 0.86), (1.6, 0.98), (1.32, 0.98), (1.32, 0.5)],
            8,
            crease=20,
        ),
    ]
    stem = [(0.42, 0.4), (0.42, 0.6), *bead(0.3, 0.62, 0.78, 0.08), (0.2, 0.84), (0.16, 1.0), (0.2, 1.15), (0.27, 1.3)]
    stem += [(0.22, 1.45), (0.15, 1.55), (0.2, 1.6), (0.2, 1.66), (0.45, 1.69), (0.75, 1.78), (0.93, 1.9)]
    stem += [(0.97, 1.97), (0.94, 2.0), (0.86, 1.94), (0.6, 1.83), (0.3, 1.78)]
    upper = [(0.16, 1.7), (0.16, 1.85), *bead(0.11, 1.86, 1.96, 0.04), (0.08, 2.0), (0.07, 2.1), (0.11, 2.25)]
    upper += [(0.08, 2.34), (0.1, 2.38), (0.25, 2.41), (0.41, 2.48), (0.48, 2.56), (0.46, 2.58), (0.38, 2.53)]
    upper += [(0.15, 2.47), (0.08, 2.48), (0.06, 2.6)]
    ball = icosphere(3).scaled(0.14, 0.16, 0.14).smooth(60).moved(y=2.72)
    return join([*octagons, revolve(stem, 40), revolve(upper, 32), ball])


def pot() -> Solid:
    """Make a terracotta pot with a rim and a ledge, 0.62 m high and 0.7 m wide; it holds earth up to y = 0.55."""
    outside = [(0.2, 0.0), (0.22, 0.03), (0.235, 0.06), (0.225, 0.09), (0.25, 0.2), (0.285, 0.38), (0.29, 0.4)]
    outside += [(0.302, 0.41), (0.302, 0.44), (0.293, 0.45), (0.3, 0.52), (0.34, 0.54), (0.35, 0.57), (0.35, 0.6)]
    return revolve([*outside, (0.34, 0.62), (0.3, 0.62), (0.285, 0.5)], 20)


def earth() -> Solid:
    """Make the earth that fills the pot."""
    return revolve([(0.27, 0.45), (0.29, 0.55), (0.2, 0.57)], 20)


def trunk() -> Solid:
    """Make the trunk of a young tree, from the earth up into its crown."""
    return revolve([(0.035, 0.5), (0.028, 0.7), (0.024, 1.1), (0.026, 1.6)], 10)


def crown(radius: float, seed: int, subdivisions: int = 4) -> Solid:
    """Make a clipped tree crown about the origin: a sphere whose surface is displaced by waves in random directions."""
    ball = icosphere(subdivisions)
    random = np.random.default_rng(seed)
    bumps = np.zeros(len(ball.positions))
    for frequency, height in ((5.0, 0.035), (11.0, 0.025), (19.0, 0.018)):
        waves = random.normal(size=(7, 3))
        waves *= frequency / np.linalg.norm(waves, axis=1, keepdims=True)
        bumps += height / 2 * np.sin(ball.positions @ waves.T + random.uniform(0, 2 * math.pi, 7)).sum(axis=1)
    return Solid(ball.positions * (radius * (1 + bumps))[:, None], ball.triangles).smooth(80)


def jar() -> Solid:
    """Make a large oil jar with a neck and a lip, 1.05 m high."""
    belly = [(0.17, 0.0), (0.19, 0.02), (0.2, 0.06), (0.27, 0.2), (0.345, 0.4), (0.38, 0.58), (0.37, 0.72)]
    belly += [(0.31, 0.84), (0.23, 0.91), (0.19, 0.95), (0.19, 0.98), (0.235, 1.02), (0.24, 1.05), (0.17, 1.05)]
    return revolve([*belly, (0.15, 0.96), (0.2, 0.88)], 36)


def tondo() -> tuple[Solid, Solid]:
    """Make a round relief for a wall at z = 0 that faces +z: its frame and the glazed dish inside."""
    frame = [(0.31, -0.03), (0.31, 0.02), (0.29, 0.048), (0.26, 0.055), (0.225, 0.03)]
    dish = [(0.23, -0.02), (0.23, 0.015), (0.14, 0.006), (0.06, 0.03)]
    rim = revolve([*frame, (0.225, -0.01)], 24)
    return rim.turned(90, axis=0), revolve(dish, 24).turned(90, axis=0)


def door(width: float, height: float) -> tuple[Solid, Solid]:
    """Make a door for a wall at z = 0 that faces +z: its frame with a cornice, and its panelled leaves.

    `width` and `height` are those of the opening. The leaves are 6 cm in front of the wall, so that they cover the dado
    and its rail.
    """
    half, jamb = width / 2, 0.2
    frame = [
        box((-half - jamb, -0.01, -0.05), (-half, height + 0.02, 0.13)),
        box((half, -0.01, -0.05), (half + jamb, height + 0.02, 0.13)),
        box((-half - jamb - 0.01, height, -0.05), (half + jamb + 0.01, height + 0.22, 0.135)),
        box((-half - 0.25, height + 0.21, -0.05), (half + 0.25, height + 0.3, 0.11)),
        box((-half - 0.34, height + 0.29, -0.05), (half + 0.34, height + 0.36, 0.2)),
        box((-half - 0.39, height + 0.35, -0.05), (half + 0.39, height + 0.41, 0.25)),
    ]
    leaves = [box((-half - 0.02, -0.012, -0.04), (half + 0.02, height + 0.01, 0.062))]
    rows = [(0.12, 0.36 * height), (0.4 * height, 0.66 * height), (0.7 * height, height - 0.12)]
    inner = half / 2 - 0.1
    for x in (-half / 2, half / 2):
        leaves.append(box((x - half / 2 + 0.006, -0.011, 0.03), (x + half / 2 - 0.006, height + 0.005, 0.075)))
        for low, high in rows:
            leaves.append(box((x - inner, low, 0.04), (x + inner, high, 0.09)))
            leaves.append(box((x - inner + 0.05, low + 0.05, 0.05), (x + inner - 0.05, high - 0.05, 0.105)))
    return join(frame), join(leaves)
