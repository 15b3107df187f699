# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The manual page: what it holds, how man shows it, and that the committed one is fresh."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from eclat.cli import COMMANDS, group
from eclat.cli.manpage import manpage

ROOT = Path(__file__).resolve().parents[3]


def test_man_shows_every_command_option_and_exit_code_without_warnings(tmp_path: Path) -> None:
    if shutil.which("man") is None:
        pytest.skip("no man here")
    page = tmp_path / "eclat.1"
    page.write_text(manpage(group), encoding="utf-8")
    environment = {**os.environ, "MANWIDTH": "200", "LC_ALL": "C.UTF-8"}
    shown = subprocess.run(["man", "--warnings", "-l", page], env=environment, capture_output=True, text=True)
    assert shown.returncode == 0
    assert shown.stderr == ""
    for command in COMMANDS:
        assert f"\nECLAT {command.upper()}\n" in shown.stdout
    for text in (
        "--max-error NUMBER",
        "Press Ctrl-C".lower()[6:],
        "\nEXIT STATUS\n",
        "stopped by SIGTERM",
        "ECLAT_ISA",
    ):
        assert text.lower() in shown.stdout.lower()
    for code in (0, 1, 2, 130, 143):
        assert f"\n       {code} " in shown.stdout


@pytest.mark.full  # Whoever adds an option need not write the page anew at once; a release needs it.
def test_the_committed_page_is_what_the_help_says() -> None:
    done = subprocess.run([sys.executable, ROOT / "tools/make_manpage.py", "--check"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout
