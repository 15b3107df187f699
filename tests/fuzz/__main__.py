# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The command: tries inputs, counts by format what became of them, and keeps each kind of finding with its input."""

from __future__ import annotations

import argparse
import os
import pickle
import sys
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from eclat.errors import printable
from fuzz import corpus, workers

SAID_EVERY = 60.0
"""Seconds between lines of progress."""
KEPT = 3
"""Inputs that are kept of each kind of finding."""


def main(arguments: list[str]) -> int:
    """Exit code 1 if there were findings."""
    parser = argparse.ArgumentParser(prog="fuzz", description=__doc__)
    parser.add_argument("--inputs", type=int, default=10000, help="how many inputs are tried [10000]")
    parser.add_argument("--first", type=int, default=0, help="the number of the first one [0]")
    parser.add_argument("--seed", type=int, default=0, help="other seeds give other inputs [0]")
    parser.add_argument("--one", type=int, metavar="N", help="try input N alone and show what it raises")
    parser.add_argument("--keep", type=Path, default=Path("build/fuzz"), help="folder of findings [build/fuzz]")
    given = parser.parse_args(arguments)
    seeds = made_apart()
    if given.one is not None:
        return _try_one(seeds, given.seed, given.one, given.keep)
    return _try_many(seeds, given.seed, range(given.first, given.first + given.inputs), given.keep)


def made_apart() -> dict[str, list[corpus.Files]]:
    """The corpus, made in a process of its own: a process whose core has threads must not be forked."""
    reading, writing = os.pipe()
    process = os.fork()
    if process == 0:
        with open(writing, "wb") as pipe:
            pickle.dump(corpus.corpus(), pipe)
        os._exit(0)
    os.close(writing)
    with open(reading, "rb") as pipe:
        seeds: dict[str, list[corpus.Files]] = pickle.load(pipe)
    os.waitpid(process, 0)
    return seeds


def _try_one(seeds: dict[str, list[corpus.Files]], seed: int, number: int, keep: Path) -> int:
    one = workers.make_input(seeds, seed, number)
    folder = keep / f"{seed}-{number}"
    folder.mkdir(parents=True, exist_ok=True)
    (outcome,) = workers.outcomes(seeds, seed, range(number, number + 1))
    path = workers.path_in(folder, one)
    print(f"input {number} of seed {seed}, {outcome.format}: {outcome.word}; it is kept as {path}")
    print(printable(outcome.story, lines=True))
    return int(outcome.is_finding)


def _try_many(seeds: dict[str, list[corpus.Files]], seed: int, numbers: range, keep: Path) -> int:
    counts: dict[str, Counter[str]] = {name: Counter() for name in seeds}
    findings: Counter[tuple[str, str]] = Counter()
    try:
        _count(workers.outcomes(seeds, seed, numbers), counts, findings, seeds, seed, len(numbers), keep)
    except KeyboardInterrupt:
        print("  interrupted")
    for name, count in counts.items():
        words = ", ".join(f"{count[word]} {word}" for word in ("loaded", "rendered", "refused", "findings"))
        print(f"  {name}: {count.total()} inputs: {words}")
    for (word, place), number in findings.most_common():
        print(f"  {number} × {word} in {place}")
    return int(bool(findings))


def _count(
    outcomes: Iterator[workers.Outcome],
    counts: dict[str, Counter[str]],
    findings: Counter[tuple[str, str]],
    seeds: dict[str, list[corpus.Files]],
    seed: int,
    total: int,
    keep: Path,
) -> None:
    """Add what becomes of the inputs to `counts` and `findings`, and keep the first findings of each kind."""
    said = began = time.monotonic()
    for done, outcome in enumerate(outcomes, 1):
        counts[outcome.format]["findings" if outcome.is_finding else outcome.word] += 1
        if outcome.is_finding:
            kind = outcome.word, outcome.place
            findings[kind] += 1
            if findings[kind] <= KEPT:
                _keep(workers.make_input(seeds, seed, outcome.number), outcome, seed, keep)
        if time.monotonic() - said > SAID_EVERY:
            said = time.monotonic()
            print(f"  {done} of {total} inputs, {findings.total()} findings, {said - began:.0f} s", flush=True)


def _keep(one: workers.Input, outcome: workers.Outcome, seed: int, keep: Path) -> None:
    folder = keep / f"{seed}-{one.number}"
    folder.mkdir(parents=True, exist_ok=True)
    path = workers.path_in(folder, one)
    story = (
        f"{outcome.format}, {path.name}: {outcome.word} in {outcome.place}\n\n{printable(outcome.story, lines=True)}"
    )
    (folder / "finding.txt").write_text(story, encoding="utf-8")
    print(f"  FOUND: input {one.number}: {outcome.word} in {outcome.place}; kept in {folder}", flush=True)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
