# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What runs: versions and instruction set, for `eclat --version` and reports of faults; and the option `--isa`."""

from __future__ import annotations

import importlib
import sys
from typing import Any

import click

import eclat
from eclat.cli.command import option
from eclat.cli.parameters import Name
from eclat.instruction_set import (
    CORE,
    INSTRUCTION_SETS,
    VARIABLE,
    check_instruction_set,
    check_variable,
    use_instruction_set,
)


def build_facts() -> dict[str, str]:
    """The versions of Éclat, of the libraries that run and of Python, and the instruction set.

    Raises EclatError if the instruction set that was asked for is not to be had.
    """
    check_variable()
    facts = {"eclat": eclat.__version__}
    python = ".".join(map(str, sys.version_info[:3]))
    try:
        core: Any = importlib.import_module(CORE)
    except ImportError as error:
        return {**facts, "Python": python, "core": f"cannot be loaded: {error}"}
    libraries = core.versions()
    built = ", compiled for this machine" if core.built_for_one_machine() else ""
    return {
        **facts,
        "Embree": libraries["embree"],
        "oneTBB": libraries["onetbb"],
        "Python": python,
        "instruction set": f"{core.instruction_set()}{built}",
    }


def _pin(context: click.Context, parameter: click.Parameter, name: str | None) -> None:
    if name is not None:
        check_instruction_set(name, "--isa")
        use_instruction_set(name)


isa_option = option(
    "--isa",
    type=Name("NAME", *INSTRUCTION_SETS),
    section="Work",
    # Before the work begins, since the core is loaded once, and before --version, which tells it.
    is_eager=True,
    expose_value=False,
    callback=_pin,
    help=f"Let Éclat and Embree use this instruction set only, one of {', '.join(INSTRUCTION_SETS)} [the environment "
    f"variable {VARIABLE}, else the best that the machine has]. Builds from the sources have no choice.",
)
"""Adds the option `--isa`."""
