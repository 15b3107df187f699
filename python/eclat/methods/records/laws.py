# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The laws by which `max_error` decides how fine records are, and how they become finer.

`core_options` turns `max_error` into numbers, `finer` scales all numbers towards a smaller error, `first_options` are
the options of a cheap solve that will be refined, and `rays_after` says what a finer solve costs.
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

USUAL_ERROR = 0.01
"""For which the usual numbers below were chosen."""

CHECK_SHARE_OF_REFINEMENT = 1.0
"""Rays of a check that decides about another step, at most, in units of those of the step that it checks."""

MOST_RAYS = 2_000_000_000
"""Most rays that one step may take: some minutes on two cores."""

RAYS_EXPONENT = 7 / 3
"""Rays grow with the error's inverse to this power: records with its inverse, the rays of each with its rows' square."""

SMALLEST_STEP, LARGEST_STEP = 0.8, 0.25
"""Factors of the error in one step: a smaller change is not worth a solve, a larger one trusts the laws too far."""

MARGIN = 0.8
"""Share of the wanted error that a step aims at, since the laws are not exact."""


FIRST_PIXELS = 4.0
"""Lower bound of a record's radius in the first solve, and so the pixels between the places that it looks at."""


def core_options(
    options: RecordOptions, *, max_depth: int = -1, seed: int = 0, threads: int = 0
) -> _core.IrradianceCacheOptions:
    """The core's options. Fields that are None follow from `max_error`.

    The error of first-order extrapolation grows with the square of a record's radius, a gather's noise falls with the
    number of its rows. Records are never more than √2 times as far apart as at 1 %: where they are wider than what
    stands beside them, others must be crowded in between. What far records do not know is averaged over hemispheres, so
    that they are spared more slowly than the error grows.
    """
    out = _core.IrradianceCacheOptions()
    relative = options.max_error / USUAL_ERROR
    usual = 0.4 if options.metric in ("minimum", "harmonic") else 0.8
    out.spacing = options.spacing if options.spacing is not None else usual * min(2.0, relative) ** 0.5
    out.rows = options.rows if options.rows is not None else int(np.clip(round(14 * relative**-0.5), 8, 64))
    out.far_records = options.far_records if options.far_records is not None else round(2000 * relative ** (-1 / 3))
    out.far_rows = options.far_rows if options.far_rows is not None else round(9 * relative**-0.2)
    out.disagreement = 2 * options.max_error if options.shrink_disagreeing else math.inf
    out.metric = core_enum(_core.Metric, options.metric)
    out.balanced = core_enum(_core.Balanced, options.balanced)
    out.weight = core_enum(_core.Weight, options.weight)
    for name in (
        "relaxation", "rotation_gradient", "translation_gradient", "neighbor_clamping", "gradient_limit", "obstacle_limit",
        "least_pixels", "largest_pixels", "far_spacing",
    ):  # fmt: skip
        setattr(out, name, getattr(options, name))
    out.max_depth, out.seed, out.threads = max_depth, seed, threads
    return out


def core_radiance_options(
    options: RadianceOptions, *, max_depth: int = -1, seed: int = 0, threads: int = 0
) -> _core.RadianceCacheOptions:
    """The core's options for records of radiance. Fields that are None follow from `max_error` as in `core_options`."""
    out = _core.RadianceCacheOptions()
    out.irradiance = core_options(options, max_depth=max_depth, seed=seed, threads=threads)
    relative = options.max_error / USUAL_ERROR
    out.order = options.order
    out.spacing = options.gloss_spacing if options.gloss_spacing is not None else out.irradiance.spacing
    rows = int(np.clip(round(16 * relative**-0.5), 10, 96))
    out.rows = options.gloss_rows if options.gloss_rows is not None else rows
    return out


def finer(options: Settings, ratio: float) -> Settings:
    """Options that scale all parts of the error by `ratio` (below 1). All their numbers are explicit.

    Extrapolation errs with the square of a record's radius, and what its lower bound in pixels hides is at least as wide
    as that bound; a gather of M rows, stratified in the plane, errs with M^(-3/2). The same holds for far records, which
    become more with the square of their density. Of gloss, what the harmonics leave of a lobe is part of the error too: less
    of it is allowed, and more lobes are traced.
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
        least_pixels=max(0.25, options.least_pixels * ratio),
        far_spacing=max(0.01, options.far_spacing * ratio**0.5),
        far_rows=min(256, round(now.far_rows * rows)),
        far_records=min(10**7, round(now.far_records / ratio)),
        far_photons=min(10**8, round(options.far_photons / ratio)),
    )


def step_towards(estimate: ErrorEstimate, max_error: float) -> float:
    """The error after the next step divided by the error now."""
    wanted = MARGIN * max_error / max(estimate.quoted, 1e-12)
    return min(SMALLEST_STEP, max(LARGEST_STEP, wanted))


def rays_after(rays: float, ratio: float) -> float:
    """The number of rays of the next step."""
    return float(rays * ratio**-RAYS_EXPONENT)


def first_options(options: Settings) -> Settings:
    """The options of a cheap solve that measures how long rays take."""
    coarse = core_options(replace(options, max_error=0.08, spacing=None, rows=None))
    return replace(
        options,
        spacing=coarse.spacing,
        rows=coarse.rows,
        least_pixels=min(options.largest_pixels, max(options.least_pixels, FIRST_PIXELS)),
        far_records=min(coarse.far_records, 500),
        far_rows=coarse.far_rows,
    )
