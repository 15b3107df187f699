# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Completion in real shells, each with a terminal of its own, as someone who presses Tab meets it."""

from __future__ import annotations

import os
import re
import select
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from eclat.cli import COMMANDS, main

pty = pytest.importorskip("pty")
PATHS = os.pathsep.join(os.path.abspath(path) for path in sys.path if path)
LIMIT = 60.0
"""Seconds after which a shell that says nothing has hung."""


@pytest.fixture
def home(tmp_path: Path) -> Path:
    """A folder with a program `eclat`, which shells find, and with a scene."""
    program = tmp_path / "bin/eclat"
    program.parent.mkdir()
    program.write_text(f"#!{sys.executable}\nimport sys\nfrom eclat.cli import main\nsys.exit(main())\n")
    program.chmod(0o755)
    (tmp_path / "quay.obj").write_text("")
    return tmp_path


def environment(home: Path) -> dict[str, str]:
    path = f"{home / 'bin'}:{os.environ['PATH']}"
    return {"PATH": path, "PYTHONPATH": PATHS, "HOME": str(home), "TERM": "dumb", "LC_ALL": "C.UTF-8"}


class Terminal:
    """A shell that runs in a terminal."""

    def __init__(self, home: Path, *command: str) -> None:
        self.child, self.descriptor = pty.fork()
        if self.child == 0:
            os.chdir(home)
            os.execvpe(command[0], list(command), environment(home))

    def type(self, text: str, until: str) -> str:
        """Type a text and read until a pattern appears."""
        os.write(self.descriptor, text.encode())
        said, end = "", time.monotonic() + LIMIT
        while not re.search(until, said):
            assert time.monotonic() < end, f"{until!r} did not appear in {said!r}"
            if select.select([self.descriptor], [], [], 0.2)[0]:
                said += os.read(self.descriptor, 4096).decode(errors="replace")
        return said

    def close(self) -> None:
        os.close(self.descriptor)
        os.waitpid(self.child, 0)


@pytest.fixture
def bash(home: Path) -> Iterator[Terminal]:
    if shutil.which("bash") is None:
        pytest.skip("no bash here")
    terminal = Terminal(home, "bash", "--norc", "--noprofile", "-i")
    terminal.type(
        'PS1="> "; bind "set enable-bracketed-paste off"; eval "$(eclat completion bash)"; echo re""ady\n', "ready"
    )
    yield terminal
    terminal.close()


def test_bash_completes_commands_options_values_scenes_and_files(bash: Terminal) -> None:
    # Each line is cleared by Ctrl-U before the next one.
    bash.type("eclat irr\t", "eclat irradiance ")
    bash.type("\x15eclat render --max-e\t", "--max-error ")
    bash.type("\x15eclat render --tone-mapping f\t", "filmic ")
    bash.type("\x15eclat render --method photon\t", "photon-map ")
    bash.type("\x15eclat render two\t", "two-rooms ")
    bash.type("\x15eclat render qu\t", r"quay\.obj")
    bash.type("\x15eclat render a.obj --cache qu\t", r"quay\.obj")
    # The list comes in parts, column by column.
    bash.type("\x15eclat \t\t", r"(?s)(?=.*bake)(?=.*convert)(?=.*render).*scenes")


def test_zsh_completes_commands_and_options(home: Path) -> None:
    if shutil.which("zsh") is None:
        pytest.skip("no zsh here")
    terminal = Terminal(home, "zsh", "-f", "-i")
    terminal.type('autoload -U compinit; compinit -u -D; eval "$(eclat completion zsh)"; echo re""ady\n', "ready")
    terminal.type("eclat irr\t", "eclat irradiance ")
    terminal.type("\x15eclat render --max-e\t", "--max-error ")
    terminal.close()


def test_fish_completes_commands_and_options(home: Path) -> None:
    if shutil.which("fish") is None:
        pytest.skip("no fish here")
    (home / ".config/fish/completions").mkdir(parents=True)
    script = home / ".config/fish/completions/eclat.fish"
    made = subprocess.run(["eclat", "completion", "fish"], env=environment(home), capture_output=True, timeout=LIMIT)
    script.write_bytes(made.stdout)

    def completed(line: str) -> list[str]:
        command = ["fish", "-c", f'complete -C "{line}"']
        done = subprocess.run(command, env=environment(home), cwd=home, capture_output=True, text=True, timeout=LIMIT)
        return done.stdout.splitlines()

    def names(line: str) -> list[str]:
        return [text.split("\t")[0] for text in completed(line)]

    assert names("eclat irr") == ["irradiance"]
    assert names("eclat render --max-e") == ["--max-error"]
    # Descriptions are whole, also behind commas.
    assert completed("eclat completi")[0].endswith("in bash, zsh or fish.")


def answers(words: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> list[str]:
    """What the script of bash gets for the words so far, the last of which is being typed."""
    monkeypatch.setenv("_ECLAT_COMPLETE", "bash_complete")
    monkeypatch.setenv("COMP_WORDS", words)
    monkeypatch.setenv("COMP_CWORD", str(len(words.split(" ")) - 1))
    main()
    return [line.partition(",")[2] for line in capsys.readouterr().out.splitlines() if line.startswith("plain")]


def test_all_commands_and_the_options_of_each_are_completed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert answers("eclat ", monkeypatch, capsys) == sorted(COMMANDS, key=list(COMMANDS).index)
    for command in COMMANDS:
        assert "--help" in answers(f"eclat {command} --he", monkeypatch, capsys)


def test_options_of_the_chosen_method_are_completed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert answers("eclat render --method radiosity --set pat", monkeypatch, capsys) == ["patches=", "patch-size="]
    assert answers("eclat render --method path --set pat", monkeypatch, capsys) == []


def test_an_unknown_shell_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", "tcsh"]) == 2
    assert "shell: expected one of bash, zsh, fish, got 'tcsh'" in capsys.readouterr().err
