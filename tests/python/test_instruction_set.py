# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The choice among the cores of a wheel. A copy of the package, whose cores are the one that is installed here, stands for
a wheel; tests/python/test_wheel.py builds a real one."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

import eclat
from support.standin_wheel import paths_with, standin_wheel

ONLY = "this machine cannot run x86-64-v4, only x86-64-v2, x86-64-v3"
RENDER = """
import eclat
{before}
scene = eclat.load("furnace")
print(eclat.render(scene, eclat.Path(), samples=1, size=(4, 4)).width, eclat._core.__file__.split("_cores")[1])
"""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wheel on a machine that runs x86-64-v3."""
    return standin_wheel(tmp_path_factory.mktemp("wheel"))


def run(wheel: Path, before: str = "", level: int = 3, **variables: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": paths_with(wheel), "LEVEL": str(level), **variables}
    command = [sys.executable, "-c", RENDER.format(before=before)]
    return subprocess.run(command, env=environment, cwd=wheel, capture_output=True, text=True, timeout=120)


def core_of(done: subprocess.CompletedProcess[str]) -> str:
    assert done.returncode == 0, done.stderr
    size, file = done.stdout.split()
    assert size == "4"
    return Path(file).parent.name


@pytest.mark.parametrize(("level", "name"), [(2, "x86-64-v2"), (3, "x86-64-v3"), (4, "x86-64-v4")])
def test_the_best_core_that_the_machine_runs_is_loaded(wheel: Path, level: int, name: str) -> None:
    assert core_of(run(wheel, level=level)) == name


def test_the_environment_and_python_name_another_one(wheel: Path) -> None:
    assert core_of(run(wheel, ECLAT_ISA="x86-64-v2")) == "x86-64-v2"
    assert core_of(run(wheel, 'eclat.use_instruction_set("x86-64-v2")')) == "x86-64-v2"
    assert core_of(run(wheel, 'eclat.use_instruction_set("x86-64-v3")', ECLAT_ISA="x86-64-v2")) == "x86-64-v3"


@pytest.mark.parametrize(
    ("before", "variables", "message"),
    [
        ("", {"level": 1}, "this processor is too old: it lacks the instructions of x86-64-v2 (SSE4.2)"),
        ("", {"ECLAT_ISA": "v3"}, "environment variable ECLAT_ISA: expected one of x86-64-v2, x86-64-v3, x86-64-v4, got 'v3'"),
        ("", {"ECLAT_ISA": "x86-64-v4"}, f"environment variable ECLAT_ISA: {ONLY}"),
        ('eclat.use_instruction_set("x86-64-v4")', {}, f"instruction set: {ONLY}"),
        (
            'eclat._core; eclat._core.instruction_set = lambda: "x86-64-v3"; eclat.use_instruction_set("x86-64-v2")',
            {},
            "the core for x86-64-v3 is loaded already; choose x86-64-v2 before anything is computed",
        ),
    ],
)  # fmt: skip
def test_what_cannot_be_had_is_an_error(wheel: Path, before: str, variables: dict[str, object], message: str) -> None:
    before = before.replace("eclat._core;", "from eclat import _core;", 1)
    done = run(wheel, before, **variables)  # type: ignore[arg-type]
    assert done.returncode != 0
    assert message in done.stderr
    assert "EclatError" in done.stderr


def test_a_build_from_the_sources_has_no_choice(monkeypatch: pytest.MonkeyPatch) -> None:
    if (Path(eclat.__file__).parent / "_cores").exists():
        pytest.skip("this is a wheel with several cores")
    with pytest.raises(eclat.EclatError, match="built from the sources with one core"):
        eclat.use_instruction_set("x86-64-v2")
    monkeypatch.setenv("ECLAT_ISA", "x86-64-v2")
    with pytest.raises(eclat.EclatError, match="environment variable ECLAT_ISA: x86-64-v2 cannot be chosen"):
        eclat.render(eclat.load("furnace"), eclat.Path(), samples=1, size=(4, 4))
