# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Result tables in docs/benchmarks.md, each between two markers, with the machine below."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from harness.machine import ROOT

DOCUMENT = ROOT / "docs" / "benchmarks.md"
PLOTS = ROOT / "docs" / "benchmarks"


def table(header: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table; the first column is text, the others are numbers."""
    lines = [header, ["---"] + ["---:"] * (len(header) - 1), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def percent(value: float) -> str:
    """0.0123 → 1.23 %."""
    return f"{100 * value:.2f} %"


def seconds(value: float) -> str:
    """Three digits, in s."""
    return f"{value:.3g} s" if value < 1000 else f"{value:.0f} s"


def ratio(value: float) -> str:
    """1.234 → 1.23 ×; 12.3 → 12 ×."""
    return f"{value:.2f} ×" if value < 10 else f"{value:.0f} ×"


def footer(result: dict[str, Any]) -> str:
    """Where and when, and what was left out."""
    machine = result["machine"]
    parts = [f"{machine['date']}", f"commit {machine['commit']}", f"{machine['cores']} cores of {machine['cpu']}"]
    parts += [machine["embree"], *result.get("peers", [])]
    lines = ["*" + ", ".join(parts) + "*"]
    lines += [f"*Skipped: {name}: {reason.splitlines()[0]}*" for name, reason in result.get("skipped", {}).items()]
    return "\n\n".join(lines)


def write(name: str, text: str, document: Path = DOCUMENT) -> None:
    """Replace what stands between the markers of `name`. Raises ValueError where the document lacks them."""
    begin, end = f"<!-- {name} -->", f"<!-- end of {name} -->"
    content = document.read_text(encoding="utf-8")
    pattern = re.compile(re.escape(begin) + ".*?" + re.escape(end), re.DOTALL)
    if not pattern.search(content):
        raise ValueError(f"{document}: the markers {begin} … {end} are missing")
    replacement = f"{begin}\n{text.strip()}\n{end}"
    document.write_text(pattern.sub(lambda _: replacement, content), encoding="utf-8")


def write_plot(name: str, svg: str, folder: Path = PLOTS) -> None:
    """An `<svg>` element as a file of its own, on white."""
    folder.mkdir(exist_ok=True)
    head = '<svg xmlns="http://www.w3.org/2000/svg" style="background:white;color:black;font-family:sans-serif" '
    (folder / f"{name}.svg").write_text(svg.replace("<svg ", head, 1) + "\n", encoding="utf-8")
