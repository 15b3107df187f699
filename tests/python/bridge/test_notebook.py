# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The progress bar of notebooks, and a notebook that is run from its first cell to its last."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from eclat import _core
from eclat.bridge import notebook
from eclat.bridge.running import run


class Shell:
    """Stands for IPython: its displays are kept."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, **more: Any) -> None:
        self.shown: list[str] = []
        self.at_end: list[Callable[[Any], None]] = []
        events = SimpleNamespace(
            register=lambda name, call: self.at_end.append(call), unregister=lambda name, call: self.at_end.remove(call)
        )
        shell = SimpleNamespace(execution_count=7, events=events, **more)
        shown = SimpleNamespace(HTML=str, display=self._display)
        monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
        monkeypatch.setitem(sys.modules, "IPython.display", shown)
        monkeypatch.setattr(notebook, "_last", [None, None, 0.0])

    def end_cell(self, success: bool) -> None:
        """Do what IPython does when a cell has ended."""
        for call in list(self.at_end):
            call(SimpleNamespace(success=success))

    def _display(self, bar: str, display_id: bool) -> Any:
        self.shown.append(f"new {bar}")
        return SimpleNamespace(update=lambda bar: self.shown.append(f"update {bar}"))


def test_one_bar_for_all_calls_of_a_cell(monkeypatch: pytest.MonkeyPatch) -> None:
    shell = Shell(monkeypatch, kernel=object())
    monkeypatch.setattr(notebook, "SECONDS_BETWEEN", 0.0)
    for phase in ("solve", "<render>"):
        run(phase, lambda progress: time.sleep(0.25), None, _core.Progress())
    assert shell.shown[0].startswith('new <progress value="0" max="100"></progress> solve 0 %')
    assert all(text.startswith("update") for text in shell.shown[1:])
    assert "&lt;render&gt;" in shell.shown[-1]


@pytest.mark.parametrize("success", [True, False])
def test_the_bar_is_full_when_the_cell_has_ended(monkeypatch: pytest.MonkeyPatch, success: bool) -> None:
    shell = Shell(monkeypatch, kernel=object())
    run("solve", lambda progress: time.sleep(0.25), None, _core.Progress())
    shell.end_cell(success)
    full = [text for text in shell.shown if '<progress value="100" max="100"></progress> done in ' in text]
    assert len(full) == success and not shell.at_end


def test_a_function_of_the_caller_takes_its_place(monkeypatch: pytest.MonkeyPatch) -> None:
    shell, told = Shell(monkeypatch, kernel=object()), []
    run("solve", lambda progress: time.sleep(0.25), lambda *report: told.append(report), _core.Progress())
    assert told and not shell.shown


def test_no_bar_in_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    Shell(monkeypatch)
    assert notebook.notebook_report() is None
    monkeypatch.delitem(sys.modules, "IPython")
    assert notebook.notebook_report() is None


@pytest.mark.full
def test_a_notebook_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    nbclient, nbformat = pytest.importorskip("nbclient"), pytest.importorskip("nbformat")
    pytest.importorskip("ipykernel")
    monkeypatch.setenv("PYTHONPATH", str(Path(notebook.__file__).parents[2]))
    cells = [
        "import eclat\nscene = eclat.load('cornell-box')\nscene",
        "solved = eclat.solve(scene, 'radiosity')\nsolved",
        "eclat.render(scene, 'path', samples=64, size=(96, 96))",
    ]
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(cell) for cell in cells])
    nbclient.NotebookClient(
        book, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}}
    ).execute()
    texts = [
        "".join(str(output.get("data", {}).get("text/html", "")) for output in cell["outputs"])
        for cell in book["cells"]
    ]
    assert "Scene cornell-box" in texts[0]
    assert "RadiositySolution" in texts[1] and "done in" in texts[1]
    assert "<canvas" in texts[2] and 'type="range"' in texts[2]
