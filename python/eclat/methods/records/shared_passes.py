# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Passes of a solve whose gathers the workers of a farm share.

Every worker runs the same solve. In each pass, all find the same candidates; each gathers some ranges of them; and all insert
the records of all ranges, in index order. A worker that comes later, or in the place of one that was killed, inserts what earlier
passes found without gathering it, and is then where the others are.
"""

from __future__ import annotations

import atexit
import hashlib
import pickle
import queue
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from eclat import _core
from eclat.farm.farm import Farm
from eclat.farm.worker import Bench
from eclat.methods.records.cache_functions import functions_for
from eclat.methods.records.laws import core_options
from eclat.methods.records.options import RecordOptions
from eclat.methods.work import Purpose, Work
from eclat.scene import Scene

RANGES_OF_THREAD, FEWEST_GATHERS = 3, 16
"""The number of ranges for each thread of a worker, and the least number of gathers in a range: a gather takes about a
millisecond, and a range some tens of milliseconds to travel."""

JOINED = 32
"""A solve for one view has fewer passes, so that each travels once; with 2, the simulated network of
`benchmarks/farm_scaling.py` was busy for several times as long."""

Pass = list[bytes]
"""What all ranges of a pass found, in index order."""
Compute = Callable[[int, int], bytes]
"""Gathers a range of the present pass."""


@dataclass(frozen=True, eq=False)
class SharedSolve:
    """What all workers solve."""

    scene: Scene
    purpose: Purpose
    options: RecordOptions
    work: Work


@dataclass(frozen=True)
class GatherRange:
    """The gathers [first, end) of the pass `number`, and the names of the parcels with the passes before, in order."""

    number: int
    first: int
    end: int
    before: tuple[str, ...]


class Passes:
    """What was found in the passes so far, in parcels: each worker needs all of them.

    Of `JOINED` parcels with as many passes each, one is made, so that there are few, and a pass seldom travels more than once.
    """

    def __init__(self) -> None:
        self._parts: list[list[Pass]] = []
        self._packed: dict[int, tuple[str, bytes]] = {}

    def add(self, found: Pass) -> None:
        """Add the next pass."""
        self._parts.append([found])
        while len({len(part) for part in self._parts[-JOINED:]}) == 1 and len(self._parts) >= JOINED:
            self._parts[-JOINED:] = [[found for part in self._parts[-JOINED:] for found in part]]

    def parcels(self) -> dict[str, bytes]:
        """Return the parcels by their names, in the order of the passes."""
        found, known = {}, {}
        begin = 0
        for part in self._parts:
            kept = self._packed.get(begin)
            if kept is None or len(pickle.loads(kept[1])) != len(part):
                content = pickle.dumps(part)
                # Two passes may have found the same, such as nothing, and both count.
                kept = (f"eclat-passes-{begin}-{hashlib.sha256(content).hexdigest()[:32]}", content)
            known[begin] = kept
            found[kept[0]] = kept[1]
            begin += len(part)
        self._packed = known
        return found


def share_passes(farm: Farm, solve: SharedSolve, settings: _core.IrradianceCacheOptions) -> None:
    """Have the gathers of all passes of a solve with these settings of the core computed on a farm.

    Passes with few gathers are computed here, because they would take longer to travel.
    """
    shared = replace(solve, work=replace(solve.work, progress=None, threads=0))
    passes, number = Passes(), -1

    def exchange(count: int, compute: Compute) -> Pass:
        nonlocal number
        number += 1
        parts = min(count // FEWEST_GATHERS, RANGES_OF_THREAD * farm.workers.threads())
        if parts < 2:
            found = [compute(0, count)]
        else:
            cuts = [count * k // parts for k in range(parts + 1)]
            before = passes.parcels()
            ranges = [GatherRange(number, cuts[k], cuts[k + 1], tuple(before)) for k in range(parts)]
            found = farm.ordered(gather_range, shared, ranges, stop_if_cancelled(compute), before)
        passes.add(found)
        return found

    settings.exchange_gathers(exchange)


def stop_if_cancelled(compute: Compute) -> Callable[[float], None]:
    """Make a function for progress that raises if the solve was cancelled, which computing an empty range does."""

    def check(_: float) -> None:
        compute(0, 0)

    return check


def gather_range(solve: SharedSolve, asked: GatherRange, bench: Bench) -> bytes:
    """Gather a range on a worker."""
    session = _sessions.get(id(solve))
    if session is None or session.number > asked.number or session.ended:
        end_sessions()
        session = _sessions[id(solve)] = Session(solve, bench.threads)
    return session.gathers(asked, bench.parcels)


class Session:
    """A solve on a worker, in a thread of its own, which waits in each pass for what the others found."""

    def __init__(self, solve: SharedSolve, threads: int) -> None:
        self.solve = solve  # kept, so that no other object gets its identity
        self.number = -1
        self.ended = False
        self._asked: queue.Queue[Any] = queue.Queue()
        self._answers: queue.Queue[Any] = queue.Queue()
        self._threads = threads
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        self._answer()

    def gathers(self, asked: GatherRange, parcels: Mapping[str, bytes]) -> bytes:
        """Gather a range, after what earlier passes found was inserted."""
        if self.number < asked.number:
            before: list[Pass] = [found for name in asked.before for found in pickle.loads(parcels[name])]
            while self.number < asked.number:
                self._asked.put(before[self.number])
                self._answer()
        self._asked.put((asked.first, asked.end))
        found: bytes = self._answer()
        return found

    def end(self) -> None:
        """Stop the solve, and wait until it has ended."""
        self._asked.put(None)
        self._thread.join()

    def _answer(self) -> Any:
        answer = self._answers.get()
        if isinstance(answer, BaseException):
            self.ended = True
            raise answer
        return answer

    def _run(self) -> None:
        # The options hold this object, which must not hold them: nobody would free such a circle.
        work = self.solve.work
        settings = core_options(self.solve.options, max_depth=work.max_depth, seed=work.seed, threads=self._threads)
        settings.exchange_gathers(self._exchange)
        try:
            fill = functions_for(self.solve.scene, self.solve.purpose).fill
            fill(_core.SolvedCaches(), settings, _core.Progress())
            self._answers.put(RuntimeError("the solve has fewer passes here than where it was begun"))
        except InterruptedError:
            return  # The solve was stopped. An answer would keep the options alive by the frames of its traceback.
        except BaseException as error:
            self._answers.put(error.with_traceback(None))

    def _exchange(self, count: int, compute: Compute) -> Sequence[bytes]:
        self.number += 1
        self._answers.put(None)
        while True:
            asked = self._asked.get()
            if asked is None:
                raise InterruptedError
            if isinstance(asked, list):
                return asked
            self._answers.put(compute(*asked))


def end_sessions() -> None:
    """Stop all solves of this worker, which also frees what they hold before the process ends."""
    while _sessions:
        _sessions.popitem()[1].end()


atexit.register(end_sessions)

_sessions: dict[int, Session] = {}
"""The session of a worker, by the identity of what it solves. It has one at a time."""
