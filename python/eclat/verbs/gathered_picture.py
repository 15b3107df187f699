# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The second part of a picture whose records err more than is wanted: what paths find that read them only after a matte surface.

The finished picture of the records is blended with that of such paths (`Prepared.final_gather`), region by region, with the
weights that leave the least error (`denoised_halves.with_picture`). A small excess of error therefore costs few samples. Sampling
goes on until the error of the blend is as small as wanted, or until it is clear that it will take too many samples.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from eclat.images.image import Image
from eclat.measure.error_estimate import SIGMAS, ErrorEstimate
from eclat.sampling.convergence import Goal, Sampling
from eclat.sampling.denoised_halves import JudgedPicture
from eclat.sampling.halves import Halves
from eclat.sampling.picture_probes import ProbedError
from eclat.verbs.continuing import GATHERED, Begun
from eclat.verbs.picture import COMMON, SEEDS, Picture
from eclat.verbs.picture_samples import sampling_of

MOST_SAMPLES = 1024
"""Largest number of these samples per pixel. In a furnished room they take about eight times as long as the solve; a
picture that would need more ends earlier, and says so."""

AIM = 0.9
"""The error at which this sampling stops, as a share of the wanted one. The error that is stated is measured anew, and more often
above than below the estimate that ended the sampling."""

ADDED = "gathered_samples"
"""Name, in statistics, of the number of these samples per pixel."""

FROM_SAMPLES = (
    "seconds", "noise", "noise_left", "noise_left_low", "noise_left_high", "estimated_error", "estimated_error_low",
    "estimated_error_high", "error_in_one_tile", "light_by_chance", "light_by_chance_error",
)  # fmt: skip
"""The statistics that the second part of a picture replaces."""


def gathered(
    picture: Picture,
    image: Image,
    goal: Goal,
    before: Sampling,
    probed: ProbedError | None,
    preview: Callable[[Image], None] | None = None,
    begun: Begun | None = None,
) -> tuple[Image, Sampling | None]:
    """Blend the finished `image` of a picture with that of paths which read its records after a matte surface, if its error is
    above that of the `goal`, or if the goal says how many samples to add. Light that paths do not find either does not count.

    `before` took the samples of `image`, and `probed` is what probes found of its error. With `begun`, the samples go on from
    those of a continued picture. `preview` is called with the blend after each pass. Return the blend with the samples that were
    added, or `image` and None.
    """
    prepared, stated = picture.prepared.final_gather(), picture.error_of(before.found, before.noise, probed)
    enough = stated is None or stated.quoted <= goal.max_error
    if prepared is None or (goal.gathered_samples is None and enough):
        return image, None
    if goal.denoised and not before.denoised:
        # A run with these numbers of samples denoises both parts, and must give the same picture.
        before.look(True)
        probed = probed and picture.probed(before, None)
        image, stated = picture.finished(before, probed), picture.error_of(before.found, before.noise, probed)
    part = replace(picture, prepared=prepared, estimate=None, first_seed=SEEDS)
    other = _judged(picture, before, stated or ErrorEstimate(0.0, 0.0, math.inf))
    try:
        sampling = sampling_of(part, Halves.each, [], False, None, begun, other, GATHERED)
        sampling.rays = before.rays
        if preview is not None:
            shown = preview

            def show() -> None:
                shown(_unfinished(_blended(part, image, sampling, None)))

            shown(_unfinished(image))
            sampling.after_pass = show
        aim, samples = AIM * goal.max_error, goal.gathered_samples
        sampling.run(replace(goal, max_error=aim, samples=samples, most_samples=MOST_SAMPLES, blended=True))
        found = None if probed is None else part.probed(sampling, None)
    except KeyboardInterrupt as stop:
        if before.keep_partial:
            stop.partial = _unfinished(image)  # type: ignore[attr-defined]
        raise
    return _blended(part, image, sampling, found), sampling


def _judged(picture: Picture, before: Sampling, stated: ErrorEstimate) -> JudgedPicture:
    """Distribute the stated error of a picture over its pixels as the differences between its halves are distributed.

    What all paths may have in common is an error of the records (`COMMON`) in the light that has been reflected, because only
    that comes by way of records.
    """
    assert before.found is not None and isinstance(before.film, Halves)
    whole = before.film.whole()
    reflected = picture.reflected(whole)
    records = stated if picture.estimate is None else picture.estimate
    local = before.found.local_error**2
    mean = float(local.mean())
    share = local / mean if mean > 0 else np.ones_like(local)
    deviation = (stated.high**2 - stated.error**2) / SIGMAS
    return JudgedPicture(
        before.found.pixels,
        stated.error**2 * share,
        deviation,
        before.found.scale,
        COMMON * (reflected * records.error) ** 2,
    )


def _unfinished(image: Image) -> Image:
    done = {"unfinished": True, "samples_done": int(image.metadata["statistics"]["samples"])}
    return replace(image, metadata=image.metadata | done)


def _blended(part: Picture, image: Image, sampling: Sampling, probed: ProbedError | None) -> Image:
    """Make the blend, with the layers of the image and with the error of the blend."""
    own, found = part.finished(sampling, probed), sampling.found
    assert found is not None and found.other_weight is not None and isinstance(sampling.film, Halves)
    statistics: dict[str, Any] = dict(image.metadata["statistics"])
    new: dict[str, Any] = own.metadata["statistics"]
    for name in FROM_SAMPLES:
        statistics.pop(name, None)
    statistics |= {name: new[name] for name in (*FROM_SAMPLES, "rays") if name in new} | {ADDED: new["samples"]}
    layers = image.layers | {
        "error": own.layers["error"],
        "record_weight": sampling.film.pasted(np.asarray(found.other_weight)),
    }
    metadata = image.metadata | {"statistics": statistics}
    if "bad_samples" in own.metadata:
        bad = own.metadata["bad_samples"]
        known = image.metadata.get("bad_samples", bad | {"count": 0})
        metadata["bad_samples"] = known | {"count": known["count"] + bad["count"]}
    return Image(sampling.film.pasted(found.pixels), layers, metadata)
