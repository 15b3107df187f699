# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Flags about quality and effort, each defined once: the commands differ only in what they say and in defaults."""

from __future__ import annotations

from collections.abc import Callable

from eclat.bridge.arguments import MAX_ERROR_RANGE
from eclat.cli.command import F, option
from eclat.cli.parameters import Depth, Exposure, Number
from eclat.errors import EclatError

QUALITY = "Quality"


def max_error_option(help: str, default: float | None = 0.01) -> Callable[[F], F]:
    """`--max-error`."""
    kind = Number(float, *MAX_ERROR_RANGE)
    return option("--max-error", type=kind, default=default, section=QUALITY, help=help + _shown(default))


def max_depth_option() -> Callable[[F], F]:
    """`--max-depth`."""
    help = "Most edges of a light path: 1 shows emission only, 2 adds direct light, -1 sets no limit [-1]."
    return option("--max-depth", type=Depth(int, -1, 10**6), default=-1, section=QUALITY, help=help)


def samples_option(
    help: str, default: int | None = None, name: str = "--samples", section: str = QUALITY
) -> Callable[[F], F]:
    """`--samples`, or another number of samples."""
    return option(name, type=Number(int, 1, 2**24), default=default, section=section, help=help + _shown(default))


def time_option(help: str) -> Callable[[F], F]:
    """`--time`."""
    return option("--time", type=Number(float, 0, 1e7, above=True), section=QUALITY, help=help)


def no_check_option() -> Callable[[F], F]:
    """`--no-check`."""
    help = "Skip the error estimate of the records, which costs up to a quarter as many rays as the records."
    return option("--no-check", "check", flag_value=False, default=True, section=QUALITY, help=help)


def refine_option(help: str) -> Callable[[F], F]:
    """`--refine`."""
    return option("--refine", is_flag=True, section=QUALITY, help=help)


def exposure_option(help: str, default: float | None, *, auto: bool = False) -> Callable[[F], F]:
    """`--exposure`. `auto`: whether the word is a value as well."""
    number = Exposure() if auto else Number(float, -64, 64)
    return option("--exposure", type=number, default=default, section="Output", help=help)


def output_option(help: str, *, default: str | None = None, multiple: bool = False) -> Callable[[F], F]:
    """`-o`, `--output`."""
    return option("-o", "--output", metavar="FILE", default=default, multiple=multiple, section="Output", help=help)


def cache_option() -> Callable[[F], F]:
    """`--cache`."""
    help = "Read the records that `eclat solve` wrote."
    return option("--cache", metavar="FILE", section="Method", help=help)


def check_cache_alone(flags: dict[str, object], method_given: bool) -> None:
    """Raise EclatError where `--cache` is combined with flags that it would override."""
    if flags["cache"] and (flags["settings"] or method_given):
        raise EclatError("--cache cannot be combined with --method or --set: the file holds the method and its options")


def _shown(default: float | None) -> str:
    return "." if default is None else f" [{default:g}]."
