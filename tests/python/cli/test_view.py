# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command `eclat view`."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import urllib.request
from pathlib import Path

import pytest

from eclat.cli import MISTAKE, main
from eclat.viewer.messages import decode_message
from support.browser import require_page

# A shell gives its background jobs an ignored SIGINT; a terminal does not, and it is the terminal that is tested.
UNDER_A_TERMINAL = (
    "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler); "
    "from eclat.cli import main; sys.exit(main(sys.argv[1:]))"
)
QUICK = ["--texel-size", "0.5", "--samples", "16", "--max-error", "0.2", "--quiet"]


def test_it_exports_the_page_and_the_scene(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    require_page()
    folder = tmp_path / "site"
    assert main(["view", "furnace", "--export", str(folder), *QUICK, "--json"]) == 0
    result = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert result["files"] == sum(path.is_file() for path in folder.rglob("*")) >= 5
    kinds = [decode_message(path.read_bytes())[0]["kind"] for path in sorted((folder / "data").iterdir())]
    assert kinds == ["gloss", "light", "records", "scene"]
    assert (folder / "index.html").is_file()


def test_it_serves_until_it_is_interrupted() -> None:
    require_page()
    command = [sys.executable, "-c", UNDER_A_TERMINAL, "view", "furnace", "--no-browser", *QUICK, "--json"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=os.environ) as process:
        assert process.stdout is not None
        address = json.loads(process.stdout.readline())["url"]
        with urllib.request.urlopen(address, timeout=10) as page:
            assert page.status == 200
        process.send_signal(signal.SIGINT)
        try:
            assert process.wait(timeout=30) == 0
        finally:
            process.kill()


def test_a_method_without_records_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    require_page()
    assert main(["view", "furnace", "--method", "radiosity", "--quiet"]) == MISTAKE
    assert "expected a method with records, got 'radiosity'" in capsys.readouterr().err
