# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The core with a probe between it and Embree (benchmarks/micro), in the place of `eclat._core`."""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from types import ModuleType

from harness.machine import ROOT
from harness.unavailable import UnavailableError

FOLDER = ROOT / "build" / "benchmarks"
HOW = "Linux, cmake, a C++20 compiler and nanobind are needed: make install, then pip install '.[bench]'"


def build() -> Path:
    """Build it where it is not up to date; the module's file. Raises UnavailableError where it cannot be built."""
    if not sys.platform.startswith("linux") or shutil.which("cmake") is None:
        raise UnavailableError(f"the probed core cannot be built: {HOW}")
    print("Building the probed core in build/benchmarks (some minutes the first time)", flush=True)
    generator = ["-G", "Ninja"] if shutil.which("ninja") and not (FOLDER / "CMakeCache.txt").exists() else []
    for command in (
        ["cmake", "-S", str(ROOT), "-B", str(FOLDER), *generator, "-DECLAT_BENCHMARKS=ON", "-DCMAKE_BUILD_TYPE=Release",
         f"-DPython_EXECUTABLE={sys.executable}"],
        ["cmake", "--build", str(FOLDER), "--target", "_probed_core"],
    ):  # fmt: skip
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            raise UnavailableError(f"the probed core cannot be built ({HOW}):\n{(done.stdout + done.stderr)[-2000:]}")
    return FOLDER / "benchmarks" / "micro" / f"_core{sysconfig.get_config_var('EXT_SUFFIX')}"


def install() -> ModuleType:
    """Build it where it is not up to date, and make `eclat` use it. Call this before `eclat` needs its core.

    With the probe at rest it is as fast as the ordinary core. Raises UnavailableError where it cannot be built.
    """
    loaded = sys.modules.get("eclat._core")
    if loaded is not None:
        if hasattr(loaded, "start_timing"):
            return loaded
        raise RuntimeError("the ordinary core is loaded already: install the probed one first")
    path = build()
    spec = importlib.util.spec_from_file_location("eclat._core", path)
    if spec is None or spec.loader is None:
        raise UnavailableError(f"{path} cannot be loaded")
    module = importlib.util.module_from_spec(spec)
    sys.modules["eclat._core"] = module
    spec.loader.exec_module(module)
    return module
