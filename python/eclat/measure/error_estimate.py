# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The reported error of a cache: an estimate, its 95 % confidence interval, and the sentence that states both."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

CHECK_SHARE = 0.25
"""Rays of a check in units of those of the solve that it checks."""

SIGMAS = 1.96
"""Half an interval of 95 % in units of the standard error."""

RESOLVED = 1.5
"""Up to this ratio of the interval's end to the estimate the estimate is quoted; beyond it, the end, as a bound."""


@dataclass(frozen=True)
class ErrorEstimate:
    """Relative error (the measure of `metrics.relative_rmse`) between `low` and `high` with 95 % confidence.

    `unserved` is the fraction of the probed places where no record is used: either light is traced there, which gives
    noise instead of an error, or no diffuse surface is visible.
    """

    error: float
    low: float
    high: float
    unserved: float = 0.0

    @staticmethod
    def of_squared(squared: float, deviation: float, unserved: float) -> ErrorEstimate:
        """From the squared error, whose mean is unbiased, and its standard deviation: the interval is that of the square."""
        bounds = (squared + sign * SIGMAS * deviation for sign in (0, -1, 1))
        error, low, high = (math.sqrt(max(0.0, bound)) for bound in bounds)
        return ErrorEstimate(error, low, high, unserved)

    @property
    def quoted(self) -> float:
        """The number to report as the error: the estimate, or the interval's upper end where the estimate is uncertain."""
        return self.error if self.high <= RESOLVED * self.error else self.high

    def statistics(self) -> dict[str, float]:
        """The estimate as entries for the statistics of a Solution or a picture."""
        return {
            "estimated_error": self.quoted, "estimated_error_low": self.low, "estimated_error_high": self.high,
            "unserved": self.unserved,
        }  # fmt: skip

    def with_noise(self, noise: float) -> ErrorEstimate:
        """The estimate for a picture that reads the cache and has this much noise of its own."""
        error, low, high = (math.hypot(part, noise) for part in (self.error, self.low, self.high))
        return ErrorEstimate(error, low, high, self.unserved)


LIGHT_BY_CHANCE = "light_by_chance"
LEAST_BY_CHANCE = 0.005  # of the light of lamps; less is not worth a word


def with_light_by_chance(statistics: Mapping[str, float], share: float) -> dict[str, float]:
    """`share` of the light of lamps, which comes from small ones by mirrors, metals and glass, as `light_by_chance`, and what
    is claimed of the error with it: no probe sees that light, so that as much may be wrong."""
    if not share > LEAST_BY_CHANCE:
        return {}
    raised = {name: math.hypot(statistics[name], share) for name in ("estimated_error", "estimated_error_high")}
    return raised | {LIGHT_BY_CHANCE: share}


def without_light_by_chance(statistics: Mapping[str, float]) -> dict[str, float]:
    """The error that the probes measured, which is the only part that finer settings reduce."""
    share = statistics.get(LIGHT_BY_CHANCE, 0.0)
    names = ("estimated_error", "estimated_error_high")
    return dict(statistics) | {name: math.sqrt(max(0.0, statistics[name] ** 2 - share**2)) for name in names}


def error_text(statistics: Mapping[str, float]) -> str:
    """`estimated error 0.9 % ± 0.1 (95 %)`; empty where nothing was estimated. It says where records of radiance are left out."""
    if "estimated_error" not in statistics:
        return ""
    if share := statistics.get(LIGHT_BY_CHANCE, 0.0):
        rest = without_light_by_chance(statistics)
        del rest[LIGHT_BY_CHANCE]
        least, percent = 100 * statistics["estimated_error"], 100 * share
        by_chance = f"{percent:.2g} % of the light of lamps comes from small ones by mirrors, metals or glass"
        return f"error {least:.2g} % or more: {by_chance}, which records and probes find by chance only; else {error_text(rest)}"
    if statistics.get("gloss_estimated") == 0 and statistics.get("radiance_records"):
        return error_text({**statistics, "gloss_estimated": 1.0}) + " of irradiance, gloss not included"
    quoted, low, high = (100 * statistics[f"estimated_error{end}"] for end in ("", "_low", "_high"))
    if high == 0:
        return "estimated error 0 % (95 %)"
    if quoted >= high:
        return f"estimated error at most {high:.2g} % (95 %)"
    margin = (high - low) / 2
    digits = max(0, 1 - math.floor(math.log10(high)))
    return f"estimated error {quoted:.{digits}f} % ± {margin:.{digits}f} (95 %)"
