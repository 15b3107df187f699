# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What is told of a finished picture: a line, and why its error is larger than wanted."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from eclat.cli.reporting import Reporter
from eclat.measure.error_estimate import error_text

if TYPE_CHECKING:
    from eclat.images.image import Image

LARGE_PART_OF_ERROR = 0.5
"""Part of the stated error from which on that of the records is named as its reason."""


def why_above(flags: Mapping[str, Any], statistics: Mapping[str, float]) -> str:
    """Explain why the stated error is above `--max-error` although the noise is small enough. The text is empty if the
    error is not above it, if the samples or the time were given, or if a warning has explained it.
    """
    error, records = statistics.get("estimated_error", 0.0), statistics.get("cache_error", 0.0)
    steered = flags["samples"] is None and flags["time"] is None
    if not steered or error <= flags["max_error"] or statistics.get("light_by_chance"):
        return ""
    above = f"the error is above --max-error {flags['max_error']:g}"
    if "gathered_samples" in statistics and statistics.get("noise_left", 0.0) > flags["max_error"]:
        taken = f"{statistics['gathered_samples']:,.0f} samples that read the records only after a matte surface"
        return f"{above}: {taken} do not suffice, and many more would be needed"
    if records > LARGE_PART_OF_ERROR * error and "gathered_samples" not in statistics:
        return f"{above}, because the records alone have {100 * records:.2g} %; --refine makes them finer"
    if statistics.get("noise_left", math.inf) <= flags["max_error"]:
        return f"{above}: it was measured anew after the last sample, and the estimate that ended sampling was lower"
    return ""


def say_result(reporter: Reporter, image: Image, outputs: list[str], chosen: list[str], exposure: float | None) -> None:
    """Print the summary line. `chosen` holds the options that `--time` chose, and `exposure` is the exposure in stops
    that `auto` chose.
    """
    statistics = image.metadata.get("statistics", {})
    parts = [f"{image.width}x{image.height}", str(image.metadata.get("method", ""))]
    if "seconds" in statistics:
        parts.append(f"{statistics['seconds']:.1f} s")
    for name in ("samples", "rays", "records"):
        if statistics.get(name):
            parts.append(f"{statistics[name]:,.0f} {name}")
    if "samples_done" in image.metadata:
        parts.append("interrupted")
    parts.append(error_text(statistics))
    if image.metadata.get("denoised"):
        parts.append("denoised")
    if exposure is not None:
        parts.append(f"exposure {exposure:+g} stops")
    if chosen:
        parts.append("records by --set " + " --set ".join(chosen))
    text = f"{', '.join(map(str, outputs))}: {', '.join(filter(None, parts))}"
    reporter.result(text, files=[str(Path(o)) for o in outputs], metadata=image.metadata)
