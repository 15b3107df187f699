# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Profiles with closed forms, and a photometric file by hand."""

from __future__ import annotations

import numpy as np

from eclat.intensity_profile import IntensityProfile

DOWNLIGHT = """IESNA:LM-63-2002
[TEST] by hand
[MANUFAC] nobody
TILT=NONE
1 1000 2.5 4 3 1 2 0 0
0.1
0.8 1 20
0 30, 60 90
0 45 90
100 90 50 0
100 80 40 0
100 70 30 0
"""
"""Type C, with two planes of symmetry; the multipliers make 2.5 · 0.8 = 2."""


def cosine_lamp(step: float = 1.0) -> IntensityProfile:
    """I = 100 cos V in the lower hemisphere, whose flux is 100 π lm."""
    vertical = np.arange(0, 90 + step / 2, step)
    return IntensityProfile("C", vertical, [0], [100 * np.cos(np.radians(vertical))], name="cosine")


def lopsided_lamp(step: float = 2.0) -> IntensityProfile:
    """A lamp without symmetry, in type C: I = 100 (1 + cos H / 2 + sin H / 4) sin² V in all directions."""
    vertical, horizontal = np.arange(0, 180 + step / 2, step), np.arange(0, 360 + step / 2, step)
    v, h = np.radians(vertical), np.radians(horizontal)[:, None]
    return IntensityProfile("C", vertical, horizontal, 100 * (1 + np.cos(h) / 2 + np.sin(h) / 4) * np.sin(v) ** 2)
