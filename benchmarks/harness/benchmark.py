# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A benchmark as a command: options, one result a run, printed, stored and put into the document."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from harness import document, machine
from harness.scenes import SCENES, BenchmarkScene
from harness.unavailable import UnavailableError

RESULTS = Path(__file__).resolve().parents[1] / "results"

EPILOG = """\
Needs: make install, then .venv/bin/pip install '.[bench]'. Nothing else should run on the machine meanwhile.
Ratios are between competitors that ran in turn, medians of several rounds. The result goes to
benchmarks/results/NAME.json, with --write-docs also into docs/benchmarks.md; smoke runs (--quick) go to
benchmarks/results/quick and never into the document.
"""


@dataclass(frozen=True)
class Settings:
    """What the command line asked for."""

    quick: bool
    scenes: tuple[str, ...]
    repeats: int
    threads: int
    reference_samples: int
    side: int | None = None
    """Longer side of the pictures in pixels; None = each scene's own."""
    peers: tuple[str, ...] = ()
    """Who takes part, of those that the benchmark names."""
    frames: int | None = None
    """Number of frames of what moves."""
    busy: bool = False
    """Whether a time is the processor time over the number of threads, because the machine does other work."""


@dataclass(frozen=True)
class Benchmark:
    """`run` measures one scene and returns what JSON can hold; `tables` makes Markdown of a result.

    `run` may raise UnavailableError: then the scene is left out.
    """

    name: str
    description: str
    scenes: tuple[str, ...]
    run: Callable[[str, BenchmarkScene, Settings], dict[str, Any]]
    tables: Callable[[dict[str, Any]], str]
    plots: Callable[[dict[str, Any]], Mapping[str, str]] = lambda result: {}
    prepare: Callable[[], Sequence[str]] = lambda: ()
    """Called once before all scenes; returns names of peers. May raise UnavailableError: no result then."""
    reference_samples: int | None = None
    """Default paths per pixel of each half of a reference, for benchmarks that have one."""
    page: Path = document.DOCUMENT
    """Where its tables go."""
    peers: tuple[str, ...] = ()
    """Names that --peers may choose from; a benchmark with such names has --busy and --resume too."""
    side: int | None = None
    """Longer side of its pictures in pixels, if --size may choose another."""
    frames: int | None = None
    """Number of frames of what moves, if --frames may choose fewer."""
    known: Mapping[str, BenchmarkScene] = field(default_factory=lambda: SCENES)
    """The scenes that the command line may name."""

    def markdown(self, result: dict[str, Any]) -> str:
        """Tables and where they were measured."""
        return f"{self.tables(result)}\n\n{document.footer(result)}"

    def write(self, result: dict[str, Any]) -> None:
        """Into the document, plots beside it."""
        for name, svg in self.plots(result).items():
            document.write_plot(name, svg)
        document.write(self.name, self.markdown(result), self.page)


def main(benchmark: Benchmark) -> None:
    """Run it as the command line says. Exit code 2 where nothing could be measured."""
    settings, write_docs, resume = _parse(benchmark)
    path = (RESULTS / "quick" if settings.quick else RESULTS) / f"{benchmark.name}.json"
    skipped: dict[str, str] = {}
    measured: dict[str, Any] = {}
    try:
        peers = list(benchmark.prepare())
    except UnavailableError as reason:
        sys.exit(f"{benchmark.name}: skipped: {reason}")
    result = {
        "benchmark": benchmark.name, "machine": machine.describe(), "peers": peers,
        "settings": json.loads(json.dumps(vars(settings))), "scenes": measured, "skipped": skipped,
    }  # fmt: skip
    if resume:
        measured |= _stored(path, result)
    for name in settings.scenes:
        if name in measured:
            print(f"{benchmark.name}: {name}: measured before", flush=True)
            continue
        try:
            print(f"{benchmark.name}: {name}", flush=True)
            measured[name] = benchmark.run(name, benchmark.known[name], settings)
        except UnavailableError as reason:
            skipped[name] = str(reason)
            print(f"{name}: skipped: {reason}", file=sys.stderr)
            continue
        result["machine"] |= {"embree": machine.describe()["embree"]}  # known once the core is loaded
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(result, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    if not measured:
        sys.exit(2)
    path.write_text(json.dumps(result, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"\n{benchmark.markdown(result)}\n\n{path}")
    if write_docs:
        benchmark.write(result)


def _stored(path: Path, result: dict[str, Any]) -> dict[str, Any]:
    """The scenes of an unfinished run of the same commit with the same settings; none of any other."""
    if not path.is_file():
        return {}
    stored: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    same = stored["settings"] == result["settings"] and stored["machine"]["commit"] == result["machine"]["commit"]
    return dict(stored["scenes"]) if same else {}


def _parse(benchmark: Benchmark) -> tuple[Settings, bool, bool]:
    parser = argparse.ArgumentParser(
        description=benchmark.description, epilog=EPILOG, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    add = parser.add_argument
    add("scenes", nargs="*", default=benchmark.scenes, metavar="SCENE", help=f"default: {' '.join(benchmark.scenes)}")
    add("--quick", action="store_true", help="tiny pictures, one round: shows that it works, measures nothing")
    add("--repeats", type=int, default=5, metavar="N", help="rounds of which the median counts (default 5)")
    add("--threads", type=int, default=machine.cores(), metavar="N", help="default: all cores")
    if benchmark.reference_samples is not None:
        add("--reference-samples", type=int, default=benchmark.reference_samples, metavar="N",
            help="paths per pixel of each of two references, which are kept (default %(default)s)")  # fmt: skip
    if benchmark.side is not None:
        add("--size", type=int, default=benchmark.side, metavar="PIXELS",
            help="longer side of the pictures (default %(default)s)")  # fmt: skip
    if benchmark.frames is not None:
        add("--frames", type=int, default=benchmark.frames, metavar="N",
            help="frames, those in the middle of the motion (default %(default)s)")  # fmt: skip
    if benchmark.peers:
        # Beside --peers, which takes all names that follow it.
        add("--scenes", nargs="+", dest="chosen", metavar="SCENE", help="the same as naming them first")
        add("--peers", nargs="+", choices=benchmark.peers, default=benchmark.peers, metavar="NAME",
            help=f"who takes part; default: {' '.join(benchmark.peers)}")  # fmt: skip
        add(
            "--busy", action="store_true", help="measure processor time over threads, on a machine that does other work"
        )
        add("--resume", action="store_true", help="leave out scenes that the stored result of this commit holds")
    add("--write-docs", action="store_true", help=f"put tables and plots into docs/{benchmark.page.name}")
    given = parser.parse_args()
    given.scenes = getattr(given, "chosen", None) or given.scenes
    if given.quick and benchmark.peers and given.scenes == benchmark.scenes:
        given.scenes = benchmark.scenes[:1]
    for name in given.scenes:
        if name not in benchmark.known:
            parser.error(f"unknown scene {name!r}, expected some of {', '.join(benchmark.known)}")
    side = getattr(given, "size", None)
    if given.repeats < 1 or given.threads < 1 or (side is not None and side < 16):
        parser.error("--repeats and --threads must be at least 1, --size at least 16")
    if benchmark.frames is not None and not 3 <= given.frames <= benchmark.frames:
        parser.error(f"--frames must be 3 to {benchmark.frames}")
    if given.quick and given.write_docs:
        parser.error("--quick measures nothing that belongs into the document")
    samples = 64 if given.quick else getattr(given, "reference_samples", 0)
    repeats = 1 if given.quick else given.repeats
    peers = tuple(getattr(given, "peers", ()))
    settings = Settings(
        given.quick, tuple(given.scenes), repeats, given.threads, samples, side, peers, getattr(given, "frames", None),
        getattr(given, "busy", False),
    )  # fmt: skip
    return settings, given.write_docs, getattr(given, "resume", False)
