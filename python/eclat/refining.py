# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""How a solve goes on where its error is too large: finer settings, by laws of how each part of the error falls."""

from __future__ import annotations

from dataclasses import replace

from eclat.error_estimate import ErrorEstimate
from eclat.options import IrradianceCache, RadianceCache
from eclat.solution import core_options, core_radiance_options

CHECK_SHARE_OF_REFINEMENT = 1.0
"""Rays of a check that decides about another step, at most, in units of those of the step that it checks."""

MOST_RAYS = 2_000_000_000
"""Of one step: some minutes on two cores."""

RAYS_EXPONENT = 7 / 3
"""Rays grow with the error's inverse to this power: records with its inverse, the rays of each with its rows' square."""

SMALLEST_STEP, LARGEST_STEP = 0.8, 0.25
"""Of the error, in one step: less is not worth a solve, and more trusts the laws too far."""

MARGIN = 0.8
"""Of the wanted error that a step aims at, since laws are not exact."""


def finer(options: IrradianceCache, ratio: float) -> IrradianceCache:
    """Options that bring all parts of the error to `ratio` (below 1) of what they are, by numbers that are written out.

    Extrapolation errs with the square of a record's radius, and what its lower bound in pixels hides is at least as wide
    as that bound; a gather of M rows, stratified in the plane, errs with M^(-3/2). The same holds for far records, which
    become more with the square of their density. Of gloss, what the harmonics leave of a lobe is part of the error too: less
    of it is allowed, and more lobes are traced.
    """
    now = core_options(options)
    rows = ratio ** (-2 / 3)
    if isinstance(options, RadianceCache):
        gloss = core_radiance_options(options)
        options = replace(
            options,
            gloss_spacing=max(0.01, gloss.spacing * ratio**0.5),
            gloss_rows=min(256, round(gloss.rows * rows)),
            gloss_error=max(0.001, options.gloss_error * ratio),
        )
    return replace(
        options,
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
    """Ratio of the errors of the next step and this one."""
    wanted = MARGIN * max_error / max(estimate.quoted, 1e-12)
    return min(SMALLEST_STEP, max(LARGEST_STEP, wanted))


def rays_after(rays: float, ratio: float) -> float:
    """Rays of the next step."""
    return float(rays * ratio**-RAYS_EXPONENT)
