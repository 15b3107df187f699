# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Frames on workers: the same files as in one process, on one, two and three workers, and while workers are killed."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import eclat
from eclat.cli import main
from eclat.farm.farm import Farm
from eclat.scene import Scene

distributed = pytest.importorskip("distributed")

COMMON: dict[str, Any] = {"size": (24, 16), "samples": 2, "threads": 1, "fps": 4}
WALK: dict[str, Any] = {
    "keys": [{"time": 0, "from": [0, 1, 3.4], "to": [0, 1, 0]}, {"time": 1, "from": [0.8, 1.2, 3.0]}]
}


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, dashboard_address="127.0.0.1:0", memory_limit=0
    ) as cluster:
        yield cluster


class Reports:
    """Keeps the arguments of all calls."""

    def __init__(self) -> None:
        self.heard: list[tuple[Any, ...]] = []

    def add(self, *arguments: Any) -> None:
        self.heard.append(arguments)


def walk() -> Scene:
    return eclat.with_camera_path(eclat.load("cornell-box"), WALK)


def files(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def test_frames_are_the_same_files_on_one_two_and_three_workers(cluster: Any, tmp_path: Path) -> None:
    eclat.animate(walk(), frames=range(5), output=tmp_path / "here" / "%d.exr", **COMMON)
    for workers in (1, 2, 3):
        cluster.scale(workers)
        output = tmp_path / str(workers) / "%d.exr"
        reports, progress = Reports(), Reports()
        with distributed.Client(cluster, set_as_default=False) as client:
            client.wait_for_workers(workers)
            with Farm(client):
                eclat.animate(
                    walk(), frames=range(5), output=output, progress=progress.add, finished=reports.add, **COMMON
                )
        assert files(tmp_path / str(workers)) == files(tmp_path / "here")
        assert sorted(reports.heard) == [(output.parent / f"{n}.exr", False) for n in range(5)]
        assert [report[1] for report in progress.heard if report[0] == "frames"][-1] == 1.0


def test_frames_are_the_same_files_while_workers_are_killed_at_random(cluster: Any, tmp_path: Path) -> None:
    eclat.animate(walk(), frames=range(9), output=tmp_path / "here" / "%d.png", **COMMON)
    chance = random.Random(4)
    cluster.scale(3)
    with distributed.Client(cluster, set_as_default=False) as client:
        client.wait_for_workers(3)

        def finished(path: Path, kept: bool) -> None:
            if chance.random() < 0.4:
                os.kill(chance.choice(list(client.run(os.getpid).values())), signal.SIGKILL)

        with Farm(client):
            eclat.animate(walk(), frames=range(9), output=tmp_path / "there" / "%d.png", **COMMON, finished=finished)
    assert files(tmp_path / "there") == files(tmp_path / "here")


def test_the_command_line_starts_workers(tmp_path: Path) -> None:
    path = tmp_path / "walk.json"
    path.write_text(str(WALK).replace("'", '"'))
    command = [
        "animate", "cornell-box", "--camera-path", str(path), "--frames", "0:1", "--size", "16x12", "--samples", "1",
        "--method", "path", "--quiet",
    ]  # fmt: skip
    assert main([*command, "-o", str(tmp_path / "here" / "%d.exr")]) == 0
    there = [sys.executable, "-m", "eclat", *command, "--workers", "2", "-o", str(tmp_path / "there" / "%d.exr")]
    done = subprocess.run(there, capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert files(tmp_path / "there") == files(tmp_path / "here")


def test_workers_and_a_scheduler_together_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["animate", "furnace", "--frames", "0", "--workers", "2", "--scheduler", "tcp://a:1"]) == 2
    assert "expected --workers or --scheduler, got both" in capsys.readouterr().err
    assert main(["animate", "furnace", "--frames", "0", "--scheduler", "tcp://127.0.0.1:1"]) == 2
    assert "no scheduler answers at tcp://127.0.0.1:1" in capsys.readouterr().err
