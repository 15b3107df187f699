# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The options about quality and effort that several commands share; only help texts and defaults differ."""

from __future__ import annotations

from collections.abc import Callable

from eclat.bridge.arguments import MAX_ERROR_RANGE
from eclat.cli.command import F, option
from eclat.cli.parameters import Adaptive, Depth, Exposure, Number
from eclat.errors import EclatError

QUALITY = "Quality"

LEAST_SHARE = 0.25
"""The least share of the time that is left for the picture, however long the scene takes to load. A picture of a single
sample would not be worth the wait."""


def max_error_option(help: str, default: float | None = 0.01) -> Callable[[F], F]:
    """Make the option `--max-error`."""
    kind = Number(float, *MAX_ERROR_RANGE)
    return option("--max-error", type=kind, default=default, section=QUALITY, help=help + _shown(default))


def max_depth_option() -> Callable[[F], F]:
    """Make the option `--max-depth`."""
    help = "Greatest number of edges of a light path: 1 is emission only, 2 adds direct light, -1 sets no limit [-1]."
    return option("--max-depth", type=Depth(int, -1, 10**6), default=-1, section=QUALITY, help=help)


def samples_option(
    help: str, default: int | None = None, name: str = "--samples", section: str = QUALITY
) -> Callable[[F], F]:
    """Make the option `--samples`, or an option of another name whose value is a number of samples."""
    return option(name, type=Number(int, 1, 2**24), default=default, section=section, help=help + _shown(default))


def adaptive_option(default: str) -> Callable[[F], F]:
    """Make the option `--adaptive`; `default` says what it is when it is not given."""
    help = (
        "Give pixels more samples that err more, by their noise or by what the denoiser leaves of it (denoised), and others "
        f"fewer, or all the same number (off); --samples is then the average [{default}]."
    )
    return option("--adaptive", type=Adaptive(), default=None, section=QUALITY, help=help)


def time_option(help: str) -> Callable[[F], F]:
    """Make the option `--time`, in seconds."""
    return option("--time", type=Number(float, 0, 1e7, above=True), section=QUALITY, help=help)


def time_left(seconds: float | None, taken: float) -> float | None:
    """Return how many of the `seconds` of `--time` are left after `taken` seconds, in which the scene was loaded. None
    stays None, and at least `LEAST_SHARE` is left.
    """
    return None if seconds is None else max(LEAST_SHARE * seconds, seconds - taken)


def no_check_option() -> Callable[[F], F]:
    """Make the option `--no-check`."""
    help = "Do not estimate the error of the records; the estimate takes up to a quarter as many rays as the records."
    return option("--no-check", "check", flag_value=False, default=True, section=QUALITY, help=help)


def refine_option(help: str) -> Callable[[F], F]:
    """Make the option `--refine`."""
    return option("--refine", is_flag=True, section=QUALITY, help=help)


def exposure_option(help: str, default: float | None, *, auto: bool = False) -> Callable[[F], F]:
    """Make the option `--exposure`, in stops; with `auto` it also accepts the word auto."""
    number = Exposure() if auto else Number(float, -64, 64)
    return option("--exposure", type=number, default=default, section="Output", help=help)


def output_option(help: str, *, default: str | None = None, multiple: bool = False) -> Callable[[F], F]:
    """Make the option `-o`, `--output`."""
    return option("-o", "--output", metavar="FILE", default=default, multiple=multiple, section="Output", help=help)


def cache_option() -> Callable[[F], F]:
    """Make the option `--cache`."""
    help = "Use the solution in this file, which `eclat solve` wrote, with its method and options."
    return option("--cache", metavar="FILE", section="Method", help=help)


def check_cache_alone(flags: dict[str, object], method_given: bool) -> None:
    """Raise EclatError if `--cache` is combined with `--method` or `--set`, which the file already determines."""
    if flags["cache"] and (flags["settings"] or method_given):
        raise EclatError("--cache cannot be combined with --method or --set: the file holds the method and its options")


def _shown(default: float | None) -> str:
    return "." if default is None else f" [{default:g}]."
