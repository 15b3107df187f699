# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Probes in the layouts of engines: what each stores, so that its own shader shows the irradiance that Éclat computed.

===========  ===================================================================================================
three.js     `LightProbe.sh.fromArray` takes the 27 numbers of a probe as files hold them; `web/eclat-probes.js`
             reads files.
Godot        `LightmapGIData` holds nine colours a probe, whose shader multiplies the albedo by
             Σ A_l c Y: the coefficients divided by π.
Unity        `SphericalHarmonicsL2` holds A_l / π · K · c, where K is the constant of the harmonic, so that
             `ShadeSH9` multiplies the albedo by a polynomial of the normal; axes are left-handed.
===========  ===================================================================================================
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from eclat.errors import EclatError
from eclat.probe_grid.grid import ProbeGrid
from eclat.probe_grid.quadric import BANDS, COSINE_LOBE
from eclat.scene import FloatArray

HARMONIC_CONSTANTS = np.sqrt(np.array([1, 3, 3, 3, 15, 15, 5 / 4, 15, 15 / 4]) / (4 * math.pi))
"""The constant K of each harmonic, such that Y is K times 1, y, z, x, xy, yz, 3z² − 1, xz, x² − y²."""

ODD = {"x": (3, 4, 7), "y": (1, 4, 5), "z": (2, 5, 7)}
"""The coefficients that change their sign where an axis is mirrored."""


@dataclass(frozen=True, eq=False)
class GodotProbes:
    """`points` (N, 3) in metres, and `colors` (N, 9, 3): nine colours a point, as `LightmapGIData` stores them."""

    points: FloatArray
    colors: FloatArray


@dataclass(frozen=True, eq=False)
class UnityProbes:
    """`positions` (N, 3) in metres; `harmonics` (N, 3, 9), the numbers `sh[channel, coefficient]` of a
    `SphericalHarmonicsL2`; and `shader` (N, 7, 4), the vectors unity_SHAr, SHAg, SHAb, SHBr, SHBg, SHBb and SHC."""

    positions: FloatArray
    harmonics: FloatArray
    shader: FloatArray


def for_godot(grid: ProbeGrid) -> GodotProbes:
    """Convert a grid for Godot, whose axes are those of Éclat: x to the right, y up, right-handed."""
    positions, coefficients = grid.rows()
    return GodotProbes(positions, coefficients.astype(np.float64) / math.pi)


def for_unity(grid: ProbeGrid, mirrored: Literal["x", "z"] = "x") -> UnityProbes:
    """Convert a grid for Unity, whose axes are left-handed.

    `mirrored` is the axis that importers of the scene negate: "x" for glTFast and for Unity's own importer of .obj and
    .fbx, "z" for importers that turn to the other side. Raises EclatError for another axis.
    """
    if mirrored not in ("x", "z"):
        raise EclatError(f"mirrored: expected 'x' or 'z', got {mirrored!r}")
    positions, coefficients = grid.rows()
    positions = positions * np.where(np.array(["x", "y", "z"]) == mirrored, -1.0, 1.0)
    sh = coefficients.transpose(0, 2, 1) * (np.take(COSINE_LOBE, BANDS) / math.pi * HARMONIC_CONSTANTS)
    sh[..., ODD[mirrored]] *= -1
    a = np.stack([sh[..., 3], sh[..., 1], sh[..., 2], sh[..., 0] - sh[..., 6]], axis=-1)
    b = np.stack([sh[..., 4], sh[..., 5], 3 * sh[..., 6], sh[..., 7]], axis=-1)
    c = np.concatenate([sh[..., 8], np.ones((len(sh), 1))], axis=1)
    return UnityProbes(positions, sh, np.concatenate([a, b, c[:, None]], axis=1))
