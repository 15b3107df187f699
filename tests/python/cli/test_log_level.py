# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""`--log-level` and `--version`: what is said at each level, and to whom."""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path

import pytest

from eclat.cli import EXIT_CODES, main
from eclat.errors import warn
from support.fake_api import FakeApi

Output = pytest.CaptureFixture[str]


@pytest.fixture(autouse=True)
def api(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> FakeApi:
    monkeypatch.chdir(tmp_path)
    api = FakeApi(monkeypatch)
    api.during = lambda: warn("something was guessed")
    return api


def said(level: str, capsys: Output, *more: str) -> tuple[str, str]:
    main(["render", "cornell-box", "--size", "8x8", "--samples", "1", "--log-level", level, *more])
    captured = capsys.readouterr()
    return captured.out, captured.err


def test_each_level_says_less_than_the_one_before(capsys: Output) -> None:
    out, err = said("debug", capsys)
    assert "cornell-box.png" in out
    assert "warning: something was guessed" in err
    assert re.search(
        r"eclat: debug: [\d.]+ s: eclat [\d.]+, Embree [\d.]+, oneTBB [\d.]+, Python .*instruction set", err
    )
    assert re.search(r"eclat: debug: [\d.]+ s: phase: render", err)
    assert re.search(r"processor time [\d.]+ s, memory at its peak \d+ MiB", err)
    out, err = said("info", capsys)
    assert "cornell-box.png" in out
    assert err == "eclat: warning: something was guessed\n"
    assert said("warning", capsys) == ("", "eclat: warning: something was guessed\n")
    assert said("error", capsys) == ("", "")


def test_errors_are_said_at_every_level_with_a_traceback_for_debug(capsys: Output) -> None:
    for level in ("debug", "info", "warning", "error"):
        assert main(["render", "none.glb", "--log-level", level]) == 2
        err = capsys.readouterr().err
        assert "eclat: none.glb" in err
        assert ("Traceback" in err) == (level == "debug")


def test_debug_is_an_event_of_json(capsys: Output) -> None:
    events = [json.loads(line) for line in said("debug", capsys, "--json")[0].splitlines()]
    assert any(e["event"] == "debug" and "phase: render" in e["message"] for e in events)
    events = [json.loads(line) for line in said("error", capsys, "--json")[0].splitlines()]
    assert [e["event"] for e in events] == ["result"]


def test_versions_of_all_that_runs_are_told(capsys: Output) -> None:
    assert main(["--version"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert re.fullmatch(r"eclat \d+\.\d+\.\d+.*", lines[0])
    named = {line[:18].strip(): line[18:] for line in lines[1:]}
    assert set(named) == {"Embree", "oneTBB", "Python", "instruction set"}
    assert re.fullmatch(r"[34]\.\d+\.\d+", named["Embree"])
    assert named["Python"] == sys.version.split()[0]


def test_the_help_lists_the_exit_codes(capsys: Output) -> None:
    assert main(["--help"]) == 0
    text = capsys.readouterr().out.split("Exit codes:")[1]
    assert [int(code) for code in re.findall(r"^  (\d+) ", text, re.M)] == list(EXIT_CODES)
