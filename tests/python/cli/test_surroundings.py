# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command line in bad surroundings: signals, full and closed streams, pipes, long names, names that steer terminals."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from eclat.cli import main

# Absolute, since the tests run in folders of their own.
PATHS = os.pathsep.join(os.path.abspath(path) for path in sys.path)
COMMAND = (sys.executable, "-m", "eclat")
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


@pytest.fixture(autouse=True)
def folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.chdir(tmp_path)


def run(*arguments: str, **keywords: Any) -> tuple[int, str]:
    """Exit code and standard error."""
    keywords = {"stdout": subprocess.PIPE, "stdin": subprocess.DEVNULL} | keywords
    environment = os.environ | {"PYTHONPATH": PATHS}
    process = subprocess.run(
        [*COMMAND, *arguments], env=environment, stderr=subprocess.PIPE, timeout=120, check=False, **keywords
    )
    return process.returncode, process.stderr.decode()


ENDLESS = [*COMMAND, "render", "cornell-box", "--json", "--method", "path", "--samples", "1000000"]
"""A render that somebody has to stop."""


def closing(descriptor: int) -> Callable[[], None]:
    return lambda: os.close(descriptor)


def started(*command: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        command, env=os.environ | {"PYTHONPATH": PATHS}, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )


@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 143), (signal.SIGHUP, 129), (signal.SIGXCPU, 152)])
def test_signals_stop_as_ctrl_c_does(number: signal.Signals, code: int) -> None:
    if signal.getsignal(number) == signal.SIG_IGN:
        pytest.skip(f"{number.name} is ignored here, as under nohup, and so by every child")
    Path("cornell-box.png").write_bytes(b"old")
    with started(*ENDLESS, "--size", "64x64") as process:
        assert process.stdout is not None
        for line in process.stdout:
            if json.loads(line).get("phase") == "render":
                break
        process.send_signal(number)
        _, complaint = process.communicate(timeout=60)
    assert (process.returncode, complaint) == (code, "eclat: terminated\n")
    assert os.listdir() == ["cornell-box.png"] and Path("cornell-box.png").read_bytes() == b"old"


@pytest.mark.slow
@pytest.mark.parametrize(
    "arguments",
    [
        ("solve", "cornell-box", "--max-error", "0.001"),
        (
            "irradiance",
            "cornell-box",
            "--points",
            "points.csv",
            "--method",
            "path",
            "--samples",
            "16000000",
            "-o",
            "e.npy",
        ),
        ("bake", "cornell-box", "--texel-size", "0.01", "--max-error", "0.002"),
        ("compare", "cornell-box", "--reference-samples", "1000000", "--methods", "path"),
    ],
)
def test_each_command_stops_and_leaves_nothing(arguments: tuple[str, ...]) -> None:
    Path("points.csv").write_text("0 0.5 0 0 1 0\n" * 1000)
    with started(*COMMAND, *arguments, "--json") as process:
        assert process.stdout is not None
        for line in process.stdout:
            if json.loads(line)["event"] == "progress":
                break
        process.send_signal(signal.SIGTERM)
        _, complaint = process.communicate(timeout=120)
    assert (process.returncode, complaint) == (143, "eclat: terminated\n")
    assert os.listdir() == ["points.csv"]


def test_a_terminated_run_with_keep_partial_keeps_its_result() -> None:
    with subprocess.Popen(
        [*ENDLESS, "--size", "32x32", "--keep-partial"],
        env=os.environ | {"PYTHONPATH": PATHS},
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if json.loads(line).get("statistics", {}).get("rays", 0) > 20_000:
                break
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)
    assert process.returncode == 143
    assert os.listdir() == ["cornell-box.png"]


def test_the_signal_handler_is_removed_afterwards() -> None:
    assert main(["scenes"]) == 0
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no device that is full")
@pytest.mark.parametrize("arguments", [("scenes",), ("info", "cornell-box", "--json")])
def test_a_full_standard_output_gives_a_message_of_one_line(arguments: tuple[str, ...]) -> None:
    with open("/dev/full", "wb") as full:
        code, complaint = run(*arguments, stdout=full)
    assert (code, complaint) == (2, "eclat: standard output: cannot be written: No space left on device\n")


@pytest.mark.parametrize("descriptor", [0, 1])
def test_closed_streams(descriptor: int) -> None:
    keywords: dict[str, Any] = {"preexec_fn": closing(descriptor)}
    if descriptor == 0:
        keywords["stdin"] = None
        code, complaint = run("irradiance", "cornell-box", "--points", "-", **keywords)
        assert (code, complaint) == (2, "eclat: standard input: expected points, but standard input is closed\n")
    else:
        keywords["stdout"] = None
        assert run("info", "cornell-box", **keywords)[0] == 0
        assert run("info", "cornell-box", "--json", **keywords)[0] == 0


@pytest.mark.parametrize(
    "arguments",
    [
        ("render", "cornell-box", "-o", "n" * 300 + ".png"),
        ("solve", "cornell-box", "-o", "n" * 300 + ".npz"),
        ("bake", "cornell-box", "-o", "n" * 300 + ".glb"),
        ("irradiance", "cornell-box", "--points", "n" * 300),
        ("render", "n" * 300 + ".obj"),
        ("render", "cornell-box", "--environment", "n" * 300),
        ("render", "cornell-box", "--cache", "n" * 300),
        ("render", "cornell-box", "--replay-settings", "n" * 300 + ".png"),
        ("render", "cornell-box", "--cache", "pipe"),
        ("render", "cornell-box", "--environment", "pipe.exr"),
        ("render", "cornell-box", "--replay-settings", "pipe.exr"),
        ("render", "pipe.obj"),
        ("irradiance", "cornell-box", "--points", "pipe"),
        ("irradiance", "cornell-box", "--points", "/dev/zero"),
        ("irradiance", "cornell-box", "--points", "."),
        ("irradiance", "cornell-box", "--points", "pipe", "--cache", "pipe"),
        ("render", "cornell-box", "--cache", "."),
        ("render", "cornell-box", "--environment", "."),
        ("render", "cornell-box", "--replay-settings", "."),
        ("render", "cornell-box", "--continue", "pipe.exr"),
        ("compare", "cornell-box", "--reference", "pipe.exr"),
        ("denoise", "pipe.exr", "-o", "a.exr"),
        ("denoise", "n" * 300 + ".exr", "-o", "a.exr"),
        ("render", "cornell-box", "-o", "."),
        ("bake", "cornell-box", "-o", "folder.glb"),
    ],
)
def test_long_names_and_pipes_are_one_line(arguments: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("pipe", "pipe.exr", "pipe.obj"):
        os.mkfifo(name)
    os.mkdir("folder.glb")
    assert main(arguments) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("eclat: ") and len(line) < 1500


def test_names_cannot_control_the_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    Path("m.mtl").write_text("newmtl \x1b[31mred\x07\nKd 1 0 0\nodd\x1b]0;title\x07 1\n")
    Path("a.obj").write_text(
        "mtllib m.mtl\nusemtl \x1b[31mred\x07\n" + TRIANGLE + "usemtl \x1b[2Jnone\u202e\nf 3 2 1\n"
    )
    Path("bad.obj").write_text(TRIANGLE + "f 1 \x1b[2J\x9b5n 3\n")
    for arguments, code in (
        (["info", "a.obj"], 0),
        (["info", "a.obj", "--json"], 0),
        (["info", "bad.obj"], 2),
        (["info", "\x1b[2J.obj"], 2),
        (["render", "a.obj", "--material", "\x1b[2J=diffuse"], 2),
    ):
        assert main(arguments) == code
        captured = capsys.readouterr()
        for text in (captured.out, captured.err):
            assert not any(c in text for c in "\x1b\x07\x9b\u202e"), arguments
    assert main(["info", "a.obj"]) == 0
    assert r"\x1b[31mred\x07" in capsys.readouterr().out
