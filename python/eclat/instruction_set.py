# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Which of the compiled cores runs: wheels for x86-64 hold one for each of the levels v2, v3 and v4.

The highest level that the machine can run is taken, unless `use_instruction_set` or the environment variable
`ECLAT_ISA` names another. Embree gets the same limit, so that a level gives the same bits on every machine that has the
same mathematical library. Where Éclat was built from the sources, there is one core, and nothing to choose.
"""

from __future__ import annotations

import importlib.machinery
import importlib.util
import os
import sys
from pathlib import Path
from types import ModuleType

from eclat.errors import EclatError, did_you_mean

INSTRUCTION_SETS = ("x86-64-v2", "x86-64-v3", "x86-64-v4")
"""The names that `use_instruction_set`, `--isa` and `ECLAT_ISA` accept: levels of the x86-64 psABI. The level v2 has
SSE4.2 (every processor since 2009), v3 has AVX2 and FMA (most since 2013 to 2015), v4 has AVX-512."""

VARIABLE = "ECLAT_ISA"
CORE = "eclat._core"
_FOLDER = Path(__file__).parent / "_cores"
_SUFFIXES = tuple(importlib.machinery.EXTENSION_SUFFIXES)

_wanted: list[str] = []
"""The name that `use_instruction_set` was last given, if any."""


def use_instruction_set(name: str) -> None:
    """Have the core and Embree use the instructions of this level only: "x86-64-v2", "x86-64-v3" or "x86-64-v4".

    It must be called before the core is loaded, which the first call that computes light does.

    Raises EclatError if there is no such level, if the machine or this build does not have it, or if a core for another
    one is loaded already.
    """
    check_instruction_set(name, "instruction set")
    loaded = sys.modules.get(CORE)
    if loaded is not None and loaded.instruction_set() != name:
        raise EclatError(
            f"instruction set: the core for {loaded.instruction_set()} is loaded already; choose {name} before anything "
            f"is computed, or by the environment variable {VARIABLE}"
        )
    _wanted[:] = [name]


def check_instruction_set(name: str, where: str) -> None:
    """Raise EclatError, which begins with `where`, unless a core of this build has that level and the machine runs it."""
    if name not in INSTRUCTION_SETS:
        expected = ", ".join(INSTRUCTION_SETS)
        raise EclatError(f"{where}: expected one of {expected}, got {name!r}{did_you_mean(name, INSTRUCTION_SETS)}")
    if not _FOLDER.is_dir():
        raise EclatError(
            f"{where}: {name} cannot be chosen, because this Éclat was built from the sources with one core"
        )
    runs = supported()
    if name not in runs:
        raise EclatError(f"{where}: this machine cannot run {name}, only {', '.join(runs) or 'older instruction sets'}")


def check_variable() -> None:
    """Raise EclatError if the environment variable asks for what cannot be had; a core built from the sources would not
    notice it.
    """
    name = os.environ.get(VARIABLE, "")
    if name and not _wanted:
        check_instruction_set(name, f"environment variable {VARIABLE}")


def supported() -> tuple[str, ...]:
    """The levels that this machine runs, the lowest first."""
    from eclat import _processor

    return INSTRUCTION_SETS[: max(0, _processor.supported_level() - 1)]


def chosen() -> str:
    """The level whose core is loaded, or will be.

    Raises EclatError if the environment variable names one that is not to be had, or if the processor is too old.
    """
    if _wanted:
        return _wanted[0]
    check_variable()
    name = os.environ.get(VARIABLE, "")
    if name:
        return name
    runs = supported()
    if not runs:
        raise EclatError(f"this processor is too old: it lacks the instructions of {INSTRUCTION_SETS[0]} (SSE4.2)")
    return runs[-1]


def load_core() -> ModuleType:
    """Load the core of the chosen level as the module `eclat._core`.

    Raises EclatError as `chosen` does, and ImportError if Éclat was not built.
    """
    if not _FOLDER.is_dir():
        raise ImportError(
            f"no compiled core lies in {Path(__file__).parent}: install Éclat, by pip install for example"
        )
    folder = _FOLDER / chosen()
    files = [file for suffix in _SUFFIXES if (file := folder / f"_core{suffix}").exists()]
    if not files:
        raise ImportError(f"{folder} has no core for Python {sys.version_info.major}.{sys.version_info.minor}")
    spec = importlib.util.spec_from_file_location(CORE, files[0])
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[CORE] = module
    spec.loader.exec_module(module)
    return module
