# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What two processes must have in common so that both compute the same bits."""

from __future__ import annotations

import functools
import hashlib
import importlib
import importlib.metadata
import platform
import sys
from pathlib import Path
from typing import Any

from eclat.errors import EclatError
from eclat.instruction_set import CORE, use_instruction_set

Identity = dict[str, str]
"""Maps what must agree, by names for messages, to its value in one process."""

INSTRUCTION_SET = "instruction set"
LIBRARIES = ("numpy", "pyoidn")
"""The packages besides Éclat by which pictures are computed."""


def identity() -> Identity:
    """Describe this process. Loads the core."""
    core: Any = importlib.import_module(CORE)
    found = {
        "Éclat": str(sys.modules["eclat"].__version__),
        "Python": ".".join(map(str, sys.version_info[:2])),
        "system": f"{platform.system()} {platform.machine()}",
        "mathematical library": " ".join(filter(None, platform.libc_ver())) or "unknown",
        INSTRUCTION_SET: str(core.instruction_set()),
        # Two cores with the same version and instruction set may have been built from other sources or by other compilers.
        "build of the core": _hash_of(str(core.__file__)),
    }
    return found | {name: _version_of(name) for name in LIBRARIES}


def refusal(expected: Identity) -> str:
    """Return why this process must not compute for one that is as `expected`, or an empty text if it may.

    If no core is loaded yet, the one for the expected instruction set is taken.
    """
    wanted = expected[INSTRUCTION_SET]
    try:
        if CORE not in sys.modules:
            use_instruction_set(wanted)
    except EclatError:
        pass  # A build from the sources has one core only, and the comparison says which.
    own = identity()
    differing = [
        f"{name} {own.get(name, 'unknown')} instead of {value}"
        for name, value in expected.items()
        if own.get(name) != value
    ]
    if own[INSTRUCTION_SET] != wanted:
        differing.append(f"pin one that all have, by --isa or ECLAT_ISA, such as {min(wanted, own[INSTRUCTION_SET])}")
    return "; ".join(differing)


@functools.cache
def _hash_of(file: str) -> str:
    return hashlib.sha256(Path(file).read_bytes()).hexdigest()[:12]


def _version_of(package: str) -> str:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "none"
