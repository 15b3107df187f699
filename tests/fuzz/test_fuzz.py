# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A small run of the fuzzer finds nothing, and what it looks for it finds where it is put."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from fuzz.mutations import damaged
from fuzz.targets import SHARES, TARGETS
from fuzz.workers import make_input

ROOT = Path(__file__).resolve().parents[2]


def run(program: list[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """In a process of its own, since a process whose core has threads must not be forked."""
    import eclat

    paths = [str(ROOT / "tests"), str(Path(eclat.__file__).parents[1])]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}
    return subprocess.run([sys.executable, *program], cwd=folder, env=environment, capture_output=True, text=True)


@pytest.mark.slow
def test_a_thousand_inputs_are_read_or_refused(tmp_path: Path) -> None:
    done = run(["-m", "fuzz", "--inputs", "1000", "--seed", "7"], tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    for name in TARGETS:
        assert f"{name}: " in done.stdout


PLANTED = """
import os, signal
from fuzz import targets, workers
workers.SECONDS, workers.MEGABYTES = 4, 200

def planted(path, random):
    {fault}

targets.TARGETS["points"] = planted
seeds = {{"points": [{{"a.txt": b"1"}}]}}
workers._FORMATS = ["points"]
found = list(workers.outcomes(seeds, 0, range(2)))
print(len(found), *[f"{{one.number}} {{one.word}} {{one.is_finding}}" for one in found], sep="; ")
"""


@pytest.mark.parametrize(
    ("fault", "word"),
    [
        ("raise KeyError(3)", "KeyError"),
        ("import warnings; warnings.warn('x', RuntimeWarning)", "RuntimeWarning"),
        ("while True: pass", "more than 4 s"),
        ("os.abort()", "killed by SIGABRT"),
        ("bytearray(300 << 20)", "more than 200 MB"),
        ("bytearray(3 << 30)", "MemoryError"),
        ("import eclat; raise eclat.EclatError('two\\nlines')", "error of many lines"),
    ],
)
def test_the_fuzzer_finds_a_planted_fault_and_continues(tmp_path: Path, fault: str, word: str) -> None:
    done = run(["-c", PLANTED.format(fault=fault)], tmp_path)
    assert done.stdout.strip() == f"2; 0 {word} True; 1 {word} True", done.stderr


def test_a_fuzz_input_depends_only_on_its_number() -> None:
    seeds = {name: [{"a.txt": b"1 2 3", "b.txt": b"x"}] for name in SHARES}
    first, again = make_input(seeds, 1, 17), make_input(seeds, 1, 17)
    assert first.files == again.files and first.random.random() == again.random.random()
    assert len({make_input(seeds, 1, n).files.get("a.txt") for n in range(100)}) > 50


@pytest.mark.parametrize("name", ["a.json", "a.gltf", "a.glb", "a.png", "a.npz", "a.xml", "a.ply", "a.obj"])
def test_damaging_works_on_any_bytes(name: str) -> None:
    from random import Random

    for number in range(200):
        random = Random(number)
        damaged(name, random.randbytes(random.randrange(40)), random)
