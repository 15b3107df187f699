# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Stacks that `perf script` prints, folded by function and drawn as a flame graph [Gregg 2016, *The Flame Graph*]."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from html import escape

WIDTH, ROW, MARGIN = 1200.0, 17.0, 4.0
LEAST_SHARE = 0.002
"""Of all samples: what is rarer is not drawn."""

COLORS = {"Embree": "#56b4e9", "system": "#bbbbbb", "library": "#8fce9f"}
OWN_COLOR = "#f0a35e"
FRAME = re.compile(r"^\s*[0-9a-f]+ (?P<symbol>.*) \((?P<object>[^()]*(?:\([^()]*\))?[^()]*)\)$")


@dataclass
class Node:
    """A function in the place of its callers."""

    samples: int = 0
    below: dict[str, Node] = field(default_factory=dict)

    def add(self, stack: Iterable[str]) -> None:
        """One sample; `stack` from the caller to the callee."""
        node = self
        node.samples += 1
        for name in stack:
            node = node.below.setdefault(name, Node())
            node.samples += 1

    def share(self, name: str) -> float:
        """Part of the samples that have `name` anywhere in their stack."""
        return self._count(name) / max(1, self.samples)

    def _count(self, name: str) -> int:
        return sum(child.samples if key == name else child._count(name) for key, child in self.below.items())


def stacks(script: Iterable[str]) -> Iterator[list[str]]:
    """The stacks of `perf script -F comm,ip,sym,dso --no-inline`, from the caller to the callee."""
    frames: list[tuple[str, str]] = []
    for line in script:
        if not line.strip():
            if frames:
                yield fold(frames[::-1])
            frames = []
        elif match := FRAME.match(line.rstrip()):
            frames.append((match["symbol"], match["object"]))
    if frames:
        yield fold(frames[::-1])


def fold(frames: list[tuple[str, str]]) -> list[str]:
    """Readable names of (symbol, object) from the caller to the callee.

    What runs in a task starts there, on whichever thread it runs; Embree and the kernel are one frame each; Python is
    left out where it called the core.
    """
    tasks = [i for i, (symbol, name) in enumerate(frames) if "tbb::" in symbol or "libtbb" in name]
    inside = frames[tasks[-1] + 1 :] if tasks else frames
    own = [i for i, (_, name) in enumerate(inside) if "_core" in name]
    if not tasks and not own:
        return ["Embree" if any("libembree" in name for _, name in frames) else "Python"]
    names: list[str] = []
    for symbol, name in inside if tasks else inside[own[0] :]:
        short = _short(symbol, name)
        if short and (not names or names[-1] != short):
            names.append(short)
    return names or ["oneTBB"]


def svg(root: Node, title: str) -> str:
    """The `<svg>` element: the widths are shares of all samples, callees lie on their callers."""
    depth = _depth(root, root.samples)
    height = (depth + 1) * ROW + 2 * MARGIN
    parts = [f'<svg viewBox="0 0 {WIDTH:g} {height:g}" font-size="11" role="img" aria-label="{escape(title)}">']
    _draw(root, title, 0.0, height - MARGIN - ROW, root.samples, parts)
    return "\n".join([*parts, "</svg>"])


def _draw(node: Node, name: str, x: float, y: float, total: int, parts: list[str]) -> None:
    width = WIDTH * node.samples / total
    label = f"{name}, {100 * node.samples / total:.1f} %"
    parts.append(
        f'<g><title>{escape(label)}</title><rect x="{x:.1f}" y="{y:g}" width="{max(width - 0.5, 0.1):.1f}" '
        f'height="{ROW - 1:g}" fill="{_color(name)}"/>{_caption(label, x, y, width)}</g>'
    )
    for key, child in sorted(node.below.items(), key=lambda item: (-item[1].samples, item[0])):
        if child.samples >= LEAST_SHARE * total:
            _draw(child, key, x, y - ROW, total, parts)
            x += WIDTH * child.samples / total


def _caption(label: str, x: float, y: float, width: float) -> str:
    letters = int((width - 6) / 6.2)
    if letters < 4:
        return ""
    text = label if len(label) <= letters else label[: letters - 1] + "…"
    return f'<text x="{x + 3:.1f}" y="{y + 12:g}">{escape(text)}</text>'


def _depth(node: Node, total: int) -> int:
    return 1 + max((_depth(c, total) for c in node.below.values() if c.samples >= LEAST_SHARE * total), default=0)


def _color(name: str) -> str:
    if name in ("Embree", "Python", "oneTBB"):
        return COLORS["Embree"] if name == "Embree" else COLORS["system"]
    if name.startswith("kernel"):
        return COLORS["system"]
    return COLORS["library"] if name.endswith("()") else OWN_COLOR


def _short(symbol: str, name: str) -> str:
    """The core's functions without namespaces and arguments, C functions with (), nothing for what has no name."""
    if "libembree" in name:
        return "Embree"
    if "kernel" in name or name.startswith("["):
        return "kernel"
    if "_core" not in name:
        plain = re.sub(r"@.*|^_+|\+0x[0-9a-f]+$", "", symbol)
        return "" if "unknown" in plain or not plain else f"{plain}()"
    return _without_arguments(symbol)


def _without_arguments(symbol: str) -> str:
    text = symbol.replace("(anonymous namespace)::", "").replace("eclat::", "")
    while (plain := re.sub(r"<[^<>]*>|\([^()]*\)| const\b|\[clone [^\]]*\]", "", text)) != text:
        text = plain
    words = re.sub(r"\{lambda\}|#\d+|\+0x[0-9a-f]+$", "", text).replace("::operator", "").strip(" :")
    return "" if "unknown" in words else words.split(" ")[-1]
