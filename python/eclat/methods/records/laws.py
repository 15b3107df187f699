# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The scaling laws that relate the error of records to their options and to the number of rays.

`core_options` computes options from `max_error`, `finer` scales all options for a smaller error, `first_options`
returns the options of a cheap first solve, and `rays_after` predicts the number of rays of a finer solve.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from eclat import _core
from eclat.measure.error_estimate import ErrorEstimate
from eclat.methods.ranges import core_enum
from eclat.methods.records.options import RadianceOptions, RecordOptions

Settings = TypeVar("Settings", bound=RecordOptions)

REFERENCE_ERROR = 0.01
"""Value of `max_error` for which the numbers in `core_options` were chosen."""

CHECK_SHARE_OF_REFINEMENT = 1.0
"""Largest number of rays of an error estimate that decides about another step, relative to the rays of the step that it
checks."""

MOST_RAYS = 2_000_000_000
"""Largest number of rays that one step may take, which is some minutes on two cores."""

RAYS_EXPONENT = 7 / 3
"""The number of rays is proportional to error^(−7/3): the number of records is proportional to error⁻¹, the number M of
rows of a gather to error^(−2/3), and its rays to M²."""

SMALLEST_STEP, LARGEST_STEP = 0.8, 0.25
"""Largest and smallest factor by which one step multiplies the error: a smaller change is not worth a solve, and for a
larger one the scaling laws are not reliable."""

MARGIN = 0.8
"""Share of the wanted error at which a step aims, because the scaling laws are not exact."""


ERROR_OF_PIXELS = 0.02
"""Value of `max_error` for which records may be as small as a pixel. Each time that it doubles, their least radius does; values
between give hardly fewer records, because the distance of the places of records is a power of two."""

MOST_PIXELS = 4.0
"""Largest lower bound of the radius of a record, in pixels, that `max_error` chooses."""

FEWEST_ROWS = 6
"""Smallest number of rows of a gather that `max_error` chooses."""

FIRST_PIXELS = 4.0
"""Lower bound of the radius of a record in the first solve, in pixels; it is also the distance between the pixels at
which records may be placed."""


def core_options(
    options: RecordOptions, *, max_depth: int = -1, seed: int = 0, threads: int = 0
) -> _core.IrradianceCacheOptions:
    """Make the options of the core. Fields that are None are computed from `max_error`.

    The error of first-order extrapolation is proportional to the square of the radius of a record, and the noise of a
    gather falls with the number M of rows of its grid of about π·M² rays. The spacing is never more than √2 times the
    spacing for an error of 1 %, because records that are larger than the objects near them require many small records
    between them. In furnished rooms most records are as small as they may be, so for large errors the lower bound of their
    radius rises, and details that are too fine for them are left to paths. The errors of far records are averaged over the
    hemisphere of each gather, so the number of far records and of their rays decreases more slowly than `max_error`
    increases.
    """
    out = _core.IrradianceCacheOptions()
    relative = options.max_error / REFERENCE_ERROR
    usual = 0.4 if options.metric in ("minimum", "harmonic") else 0.8
    out.spacing = options.spacing if options.spacing is not None else usual * min(2.0, relative) ** 0.5
    out.rows = options.rows if options.rows is not None else int(np.clip(round(14 * relative**-0.5), FEWEST_ROWS, 64))
    least = float(np.clip(2.0 ** math.floor(math.log2(options.max_error / ERROR_OF_PIXELS)), 1.0, MOST_PIXELS))
    out.least_pixels = options.least_pixels if options.least_pixels is not None else min(options.largest_pixels, least)
    out.far_records = options.far_records if options.far_records is not None else round(2000 * relative ** (-1 / 3))
    out.far_rows = options.far_rows if options.far_rows is not None else round(9 * relative**-0.2)
    out.disagreement = 2 * options.max_error if options.shrink_disagreeing else math.inf
    out.metric = core_enum(_core.Metric, options.metric)
    out.balanced = core_enum(_core.Balanced, options.balanced)
    out.weight = core_enum(_core.Weight, options.weight)
    for name in (
        "relaxation", "rotation_gradient", "translation_gradient", "neighbor_clamping", "gradient_limit", "obstacle_limit",
        "largest_pixels", "far_spacing",
    ):  # fmt: skip
        setattr(out, name, getattr(options, name))
    out.max_depth, out.seed, out.threads = max_depth, seed, threads
    return out


def core_radiance_options(
    options: RadianceOptions, *, max_depth: int = -1, seed: int = 0, threads: int = 0
) -> _core.RadianceCacheOptions:
    """Make the core's options for records of radiance. Fields that are None are computed from `max_error`, as in
    `core_options`."""
    out = _core.RadianceCacheOptions()
    out.irradiance = core_options(options, max_depth=max_depth, seed=seed, threads=threads)
    relative = options.max_error / REFERENCE_ERROR
    out.order = options.order
    out.spacing = options.gloss_spacing if options.gloss_spacing is not None else out.irradiance.spacing
    rows = int(np.clip(round(16 * relative**-0.5), 10, 96))
    out.rows = options.gloss_rows if options.gloss_rows is not None else rows
    return out


def finer(options: Settings, ratio: float) -> Settings:
    """Return options that scale all parts of the error by `ratio` (below 1), in which no field is None.

    The error of extrapolation is proportional to the square of the radius of a record. Details that are smaller than
    the lower bound of the radii, in pixels, are lost, so this bound is scaled by `ratio`. The noise of a gather of M
    rows, which is stratified in two dimensions, is proportional to M^(-3/2). The same laws hold for far records, whose
    number grows with the square of their density. For glossy lobes, the part of a lobe that the harmonics cannot
    represent also counts as error: less of it is allowed, so more lobes are traced.
    """
    now = core_options(options)
    rows = ratio ** (-2 / 3)
    gloss: dict[str, Any] = {}
    if isinstance(options, RadianceOptions):
        glossy = core_radiance_options(options)
        gloss = {
            "gloss_spacing": max(0.01, glossy.spacing * ratio**0.5),
            "gloss_rows": min(256, round(glossy.rows * rows)),
            "gloss_error": max(0.001, options.gloss_error * ratio),
        }
    return replace(
        options,
        **gloss,
        max_error=max(0.0005, options.max_error * ratio),
        spacing=max(0.01, now.spacing * ratio**0.5),
        rows=min(256, round(now.rows * rows)),
        least_pixels=max(0.25, now.least_pixels * ratio),
        far_spacing=max(0.01, options.far_spacing * ratio**0.5),
        far_rows=min(256, round(now.far_rows * rows)),
        far_records=min(10**7, round(now.far_records / ratio)),
        far_photons=min(10**8, round(options.far_photons / ratio)),
    )


def step_towards(estimate: ErrorEstimate, max_error: float) -> float:
    """Return the factor by which the next step should multiply the error."""
    wanted = MARGIN * max_error / max(estimate.quoted, 1e-12)
    return min(SMALLEST_STEP, max(LARGEST_STEP, wanted))


def rays_after(rays: float, ratio: float) -> float:
    """Predict the number of rays of a step that multiplies the error by `ratio`, from the number of rays of the last
    step."""
    return float(rays * ratio**-RAYS_EXPONENT)


def first_options(options: Settings) -> Settings:
    """Return the options of a cheap solve, which measures how long rays take."""
    coarse = core_options(replace(options, max_error=0.08, spacing=None, rows=None))
    return replace(
        options,
        spacing=coarse.spacing,
        rows=coarse.rows,
        least_pixels=min(options.largest_pixels, max(core_options(options).least_pixels, FIRST_PIXELS)),
        far_records=min(coarse.far_records, 500),
        far_rows=coarse.far_rows,
    )
