# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The estimated error of a cache, its 95 % confidence interval, and the text that states both."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

CHECK_SHARE = 0.25
"""Largest number of rays of an error estimate, relative to those of the solve that it checks."""

SIGMAS = 1.96
"""Half the width of a 95 % confidence interval, in standard errors."""

ERROR_IN_ONE_TILE = "error_in_one_tile"
"""Name, in statistics, of the share of the squared error that one tile of the picture carries."""

MOST_IN_ONE_TILE = 0.2
"""Share of the squared error in one tile up to which the estimate is stated with its margin; above it, as "at least"."""

RESOLVED = 1.5
"""Largest ratio of the upper end of the interval to the estimate at which the estimate is quoted; above it, the upper
end is quoted as a bound."""


@dataclass(frozen=True)
class ErrorEstimate:
    """An estimate of a relative error as in `metrics.relative_rmse`, which is between `low` and `high` with 95 %
    confidence.

    `in_one_tile` is the share of the squared error that one tile of the picture carries, 0 if that is unknown. Where it is
    large there are likely to be more such places that no probe met.

    `unserved` is the share of the tested points at which no record is used: either the light is traced there, with
    noise instead of an error, or no diffuse surface is visible.
    """

    error: float
    low: float
    high: float
    unserved: float = 0.0
    in_one_tile: float = 0.0

    @staticmethod
    def of_squared(squared: float, deviation: float, unserved: float) -> ErrorEstimate:
        """Make an estimate from the squared error, which is unbiased, and its standard error; the interval is that of
        the square. Noise can make the square negative; however negative, it says no more than that the error is small beside
        its standard error."""
        bounds = (squared, squared - SIGMAS * deviation, max(0.0, squared) + SIGMAS * deviation)
        error, low, high = (math.sqrt(max(0.0, bound)) for bound in bounds)
        return ErrorEstimate(error, low, high, unserved)

    @property
    def quoted(self) -> float:
        """The number that is reported as the error: the estimate or, if it is uncertain, the upper end of its interval."""
        return self.error if self.high <= RESOLVED * self.error else self.high

    def statistics(self) -> dict[str, float]:
        """Return the estimate as entries for the statistics of a Solution or a picture."""
        statistics = {
            "estimated_error": self.quoted, "estimated_error_low": self.low, "estimated_error_high": self.high,
            "unserved": self.unserved,
        }  # fmt: skip
        return statistics | ({ERROR_IN_ONE_TILE: self.in_one_tile} if self.in_one_tile else {})

    def noise_statistics(self) -> dict[str, float]:
        """Return the estimate of the noise that remains in a picture, as entries for its statistics."""
        return {"noise_left": self.quoted, "noise_left_low": self.low, "noise_left_high": self.high}

    def with_noise(self, noise: float) -> ErrorEstimate:
        """Return the estimated error of a picture that reads the cache and has the given relative noise."""
        error, low, high = (math.hypot(part, noise) for part in (self.error, self.low, self.high))
        return ErrorEstimate(error, low, high, self.unserved)

    def less_certain(self, deviation: float) -> ErrorEstimate:
        """Return the estimate with a further, independent standard error of its square."""
        above, below = (math.hypot(abs(end**2 - self.error**2), SIGMAS * deviation) for end in (self.high, self.low))
        low, high = (math.sqrt(max(0.0, self.error**2 + part)) for part in (-below, above))
        return replace(self, low=low, high=high)

    def joined(self, other: ErrorEstimate) -> ErrorEstimate:
        """Return the estimate of the sum of two independent errors: their squares add up, and so do the squares of the
        distances from the squared errors to the ends of their intervals."""
        error = math.hypot(self.error, other.error)
        above = math.hypot(*(e.high**2 - e.error**2 for e in (self, other)))
        below = math.hypot(*(e.error**2 - e.low**2 for e in (self, other)))
        low, high = (math.sqrt(max(0.0, error**2 + part)) for part in (-below, above))
        return ErrorEstimate(error, low, high, self.unserved)


LIGHT_BY_CHANCE = "light_by_chance"
"""Name, in statistics, of the share of the light of the lamps that gather rays and error probes find only by chance:
light from small lamps that arrives by way of mirrors, metals or glass."""

LIGHT_BY_CHANCE_ERROR = "light_by_chance_error"
"""Name, in statistics, of the largest error that such light makes likely, relative to all light: where a record finds it
with a few lucky rays, it takes it for many times what it is."""

CHANCE_ENTRIES = (LIGHT_BY_CHANCE, LIGHT_BY_CHANCE_ERROR)

LEAST_BY_CHANCE = 0.005
"""Share of the light of the lamps up to which such light is neglected and not reported."""


def light_by_chance(share: float, spread: float) -> dict[str, float]:
    """Return the entries of the statistics for light that is found only by chance; none if it is negligible.

    Parameters
    ----------
    share : fraction of the lamps' light that is found only by chance.
    spread : root of the mean square error of records in that light, relative to it: 1 if they always miss it, more if a
        few find it. Twice this is the largest likely error, as for other errors that are stated with 95 %.
    """
    if not share > LEAST_BY_CHANCE:
        return {}
    return {LIGHT_BY_CHANCE: share, LIGHT_BY_CHANCE_ERROR: 2 * share * max(1.0, spread)}


def with_light_by_chance(statistics: Mapping[str, float], entries: Mapping[str, float]) -> dict[str, float]:
    """Return the entries of the statistics that account for light that is found only by chance. `entries` are any
    statistics that may have those of `light_by_chance`. Error probes do not measure this light, so the estimated error
    is increased by what it is if all of this light is missed, and the upper end of its interval by what it is where this
    light is found by luck. There are no entries if it is negligible.
    """
    if LIGHT_BY_CHANCE not in entries:
        return {}
    kept = {name: entries[name] for name in CHANCE_ENTRIES}
    return kept | {name: math.hypot(statistics[name], kept[part]) for name, part in _RAISED.items()}


def without_light_by_chance(statistics: Mapping[str, float]) -> dict[str, float]:
    """Return the statistics with the error that the probes measured, which is the only part that finer settings
    reduce."""
    parts = {name: statistics.get(part, 0.0) for name, part in _RAISED.items()}
    return dict(statistics) | {name: math.sqrt(max(0.0, statistics[name] ** 2 - x**2)) for name, x in parts.items()}


_RAISED = {"estimated_error": LIGHT_BY_CHANCE, "estimated_error_high": LIGHT_BY_CHANCE_ERROR}


def error_text(statistics: Mapping[str, float]) -> str:
    """Format the estimated error as in `estimated error 0.9 % ± 0.1 (95 %)`; the text is empty if there is no estimate.

    The text also states whether light is found only by chance, or whether gloss is not included. It states a noise
    instead of an error if only the noise of the samples was measured.
    """
    if "estimated_error" not in statistics:
        return _interval_text("noise", *_percents(statistics, "noise_left")) if "noise_left" in statistics else ""
    if LIGHT_BY_CHANCE in statistics:
        rest = without_light_by_chance(statistics)
        del rest[LIGHT_BY_CHANCE]
        least = 100 * statistics["estimated_error"]
        return (
            f"estimated error {least:.2g} % or more: {chance_text(statistics)}; for all other light: {error_text(rest)}"
        )
    if statistics.get("gloss_estimated") == 0 and statistics.get("radiance_records"):
        return error_text({**statistics, "gloss_estimated": 1.0}) + " of irradiance, gloss not included"
    quoted, low, high = _percents(statistics, "estimated_error")
    share = statistics.get(ERROR_IN_ONE_TILE, 0.0)
    if share > MOST_IN_ONE_TILE and low > 0:
        likely = f"about {quoted:.2g} %" if quoted < high else f"perhaps {high:.2g} %"
        return f"estimated error at least {low:.2g} % (95 %), {likely}: {100 * share:.0f} % of its square lies in one place"
    return _interval_text("estimated error", quoted, low, high)


def chance_text(statistics: Mapping[str, float]) -> str:
    """Tell how much light is found only by chance, and how wrong records may be because of it. The text is empty if the
    statistics have no such light."""
    if LIGHT_BY_CHANCE not in statistics:
        return ""
    share, most = 100 * statistics[LIGHT_BY_CHANCE], 100 * statistics[LIGHT_BY_CHANCE_ERROR]
    by_chance = f"{share:.2g} % of the light comes from small lamps by way of mirrors, metals or glass"
    wrong = f"{most:.0f}" if most >= 100 else f"{most:.2g}"
    return (
        f"{by_chance}, and records and error probes find it only by chance: they miss it, or are up to {wrong} % wrong"
    )


def chance_warning(statistics: Mapping[str, float]) -> str:
    """Tell how much light at points is found only by chance where no estimated error includes it; empty if none is."""
    if LIGHT_BY_CHANCE not in statistics or "estimated_error" in statistics:
        return ""
    return (
        f"{100 * statistics[LIGHT_BY_CHANCE]:.2g} % of the light comes from small lamps by way of mirrors, metals or glass; "
        "rays from points find it only by chance or never, so points miss it, and a few may be far too bright"
    )


def _percents(statistics: Mapping[str, float], name: str) -> list[float]:
    return [100 * statistics[f"{name}{end}"] for end in ("", "_low", "_high")]


def _interval_text(what: str, quoted: float, low: float, high: float) -> str:
    if high == 0:
        return f"{what} 0 % (95 %)"
    if quoted >= high:
        return f"{what} at most {high:.2g} % (95 %)"
    margin = (high - low) / 2
    digits = max(0, 1 - math.floor(math.log10(high)))
    digits += digits < 2 and margin < 0.5 / 10**digits  # "± 0" would sound certain
    return f"{what} {quoted:.{digits}f} % ± {margin:.{digits}f} (95 %)"
