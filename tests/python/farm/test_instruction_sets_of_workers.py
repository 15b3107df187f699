# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Workers that have loaded cores for different instruction sets: those that differ are left out with the remedy, and the rest
computes the bits of one process."""

from __future__ import annotations

import os
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path

import distributed
import pytest

from support.clusters import Cluster
from support.standin_wheel import paths_with, standin_wheel

LEFT_OUT = (
    "is left out, because its bits could differ: instruction set {} instead of {}; pin one that all have, by --isa"
)


def render(wheel: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Render a small picture with the package in a folder."""
    command = [sys.executable, "-m", "eclat", *arguments, "--method", "path", "--samples", "1", "--size", "48x48", "-q"]
    environment = os.environ | {"PYTHONPATH": paths_with(wheel)}
    return subprocess.run(command, env=environment, cwd=wheel, capture_output=True, text=True, timeout=300)


@pytest.mark.slow
def test_workers_of_two_instruction_sets(tmp_path: Path) -> None:
    wheel = standin_wheel(tmp_path, says_its_level=True)
    (wheel / "computed_before.py").write_text("import eclat._core\n")
    variables = {"PYTHONPATH": paths_with(wheel)}
    alone = render(wheel, "--isa", "x86-64-v3", "render", "cornell-box", "-o", "alone.pfm")
    assert alone.returncode == 0, alone.stderr
    with ExitStack() as stack:
        cluster = Cluster(stack)
        loaded = cluster.add_worker("--preload", str(wheel / "computed_before.py"), ECLAT_ISA="x86-64-v2", **variables)
        cluster.add_worker(ECLAT_ISA="x86-64-v2", **variables)
        client = stack.enter_context(distributed.Client(cluster.address, set_as_default=False))
        client.wait_for_workers(2)

        def on_farm(level: str, output: str) -> subprocess.CompletedProcess[str]:
            farm = ["--scheduler", cluster.address, "-o", output]
            return render(wheel, "--isa", level, "render", "cornell-box", *farm)

        # One has loaded the core for v2. The other has computed nothing and takes that for v3, whatever its environment says.
        done = on_farm("x86-64-v3", "v3.pfm")
        assert done.returncode == 0, done.stderr
        assert LEFT_OUT.format("x86-64-v2", "x86-64-v3") in done.stderr
        assert done.stderr.count("is left out") == 1
        assert (wheel / "v3.pfm").read_bytes() == (wheel / "alone.pfm").read_bytes()

        # Now each of them has another core, and whichever level is asked for, one computes and one is left out.
        done = on_farm("x86-64-v2", "v2.pfm")
        assert done.returncode == 0, done.stderr
        assert LEFT_OUT.format("x86-64-v3", "x86-64-v2") in done.stderr
        assert done.stderr.count("is left out") == 1

        loaded.kill()
        loaded.wait()
        done = on_farm("x86-64-v2", "none.pfm")
        assert done.returncode != 0
        assert "no worker may compute: all are left out" in done.stderr
        assert LEFT_OUT.format("x86-64-v3", "x86-64-v2") in done.stderr
        assert not (wheel / "none.pfm").exists()
