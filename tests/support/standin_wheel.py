# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A stand-in for a wheel with a core for each instruction set, of which a build from the sources has one only."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

import eclat
from eclat import _core

LEVELS = ("x86-64-v2", "x86-64-v3", "x86-64-v4")

_SAYS_ITS_LEVEL = """
import sys
from eclat.instruction_set import chosen

level = chosen()
sys.modules["eclat._core"].instruction_set = lambda: level
"""


def standin_wheel(root: Path, *, says_its_level: bool = False) -> Path:
    """Make in a folder a copy of the package, whose cores for all levels are the one that is installed here.

    The environment variable LEVEL, by default 3, is the highest level that its machine runs. With `says_its_level`, each core
    says that it has the level for which it was loaded.
    """
    core = Path(_core.__file__)
    package = root / "eclat"
    ignored = shutil.ignore_patterns("_core*.so", "_cores", "__pycache__")
    shutil.copytree(Path(eclat.__file__).parent, package, ignore=ignored)
    for level in LEVELS:
        folder = package / "_cores" / level
        folder.mkdir(parents=True)
        shutil.copy(core, folder / core.name)
    (package / "_processor.py").write_text("import os\ndef supported_level(): return int(os.environ.get('LEVEL', 3))\n")
    if says_its_level:
        loader = package / "_core.py"
        loader.write_text(loader.read_text() + _SAYS_ITS_LEVEL)
    return root


def paths_with(root: Path) -> str:
    """The value of PYTHONPATH with which the package in a folder is found first."""
    return os.pathsep.join([str(root), *(os.path.abspath(path) for path in sys.path if path)])
