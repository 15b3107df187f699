# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Computations whose steps the workers of a farm share, such as the passes of a solve.

Every worker runs the same computation (`core/base/work_exchange.h`). In each step, all know the same items; each computes some
ranges of them; and the process that asks puts the results together in the order of the items. Then all get the digest of the
step, what the next step needs of it. A worker that comes later, or in the place of one that was killed, takes the digests of
all steps so far, and is then where the others are.
"""

from __future__ import annotations

import atexit
import hashlib
import pickle
import queue
import threading
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from eclat.farm.farm import Farm
from eclat.farm.worker import Bench

RANGES_OF_THREAD, FEWEST_RAYS = 3, 10_000
"""The number of ranges for each thread of a worker, and the least number of rays in a range: they take some ten milliseconds, and
so does a range to travel."""

JOINED = 32
"""A solve for one view has fewer steps, so that each travels once; with 2, the simulated network of
`benchmarks/farm_scaling.py` was busy for several times as long."""

Compute = Callable[[int, int], bytes]
"""Computes a range of the items of the present step."""
Share = Callable[[int, int, Compute], "list[bytes] | bytes"]
"""Gets the number of items of a step, about how many rays each takes, and what computes a range of them. It returns what ranges
found that are all items, or, in a process that follows, the digest."""
Tell = Callable[[bytes], None]
"""Gets the digest of the step that `Share` was called for."""


class SharedWork(ABC):
    """A computation that several processes share. It must not change after it was sent."""

    @abstractmethod
    def follow(self, share: Share, tell: Tell, threads: int) -> None:
        """Run the computation on a worker, with these functions as its exchange."""


@dataclass(frozen=True)
class StepRange:
    """The items [first, end) of the step `number`, and the names of the parcels with the digests of earlier steps, in order."""

    number: int
    first: int
    end: int
    before: tuple[str, ...]


class Digests:
    """The digests of the steps so far, in parcels: each worker needs all of them.

    Of `JOINED` parcels with as many digests each, one is made, so that there are few, and a digest seldom travels more than once.
    """

    def __init__(self) -> None:
        self._parts: list[list[bytes]] = []
        self._packed: dict[int, tuple[int, str, bytes]] = {}

    def add(self, digest: bytes) -> None:
        """Add that of the next step."""
        self._parts.append([digest])
        while len({len(part) for part in self._parts[-JOINED:]}) == 1 and len(self._parts) >= JOINED:
            self._parts[-JOINED:] = [[one for part in self._parts[-JOINED:] for one in part]]

    def parcels(self) -> dict[str, bytes]:
        """Return the parcels by their names, in the order of the steps."""
        known: dict[int, tuple[int, str, bytes]] = {}
        begin = 0
        for part in self._parts:
            kept = self._packed.get(begin)
            if kept is None or kept[0] != len(part):
                content = pickle.dumps(part)
                # Two steps may have found the same, such as nothing, and both count.
                kept = (len(part), f"eclat-steps-{begin}-{hashlib.sha256(content).hexdigest()[:32]}", content)
            known[begin] = kept
            begin += len(part)
        self._packed = known
        return {name: content for _, name, content in known.values()}


class Sharing:
    """The side that asks. Its methods `share` and `tell` are the exchange of the computation that `work` describes."""

    def __init__(self, farm: Farm, work: SharedWork) -> None:
        self._farm, self._work = farm, work
        self._digests, self._number = Digests(), -1

    def share(self, count: int, rays_of_item: int, compute: Compute) -> list[bytes]:
        """Have the items of a step computed on the farm. Few rays are traced here, because they would take longer to travel."""
        self._number += 1
        parts = min(count, count * rays_of_item // FEWEST_RAYS, RANGES_OF_THREAD * self._farm.workers.threads())
        if parts < 2:
            return [compute(0, count)]
        cuts = [count * k // parts for k in range(parts + 1)]
        before = self._digests.parcels()
        ranges = [StepRange(self._number, cuts[k], cuts[k + 1], tuple(before)) for k in range(parts)]
        found: list[bytes] = self._farm.ordered(compute_range, self._work, ranges, stop_if_cancelled(compute), before)
        return found

    def tell(self, digest: bytes) -> None:
        """Keep the digest of the last step for the workers."""
        self._digests.add(digest)


def stop_if_cancelled(compute: Compute) -> Callable[[float], None]:
    """Make a function for progress that raises if the computation was cancelled, which computing an empty range does."""

    def check(_: float) -> None:
        compute(0, 0)

    return check


def compute_range(work: SharedWork, asked: StepRange, bench: Bench) -> bytes:
    """Compute a range on a worker."""
    session = _sessions.get(id(work))
    if session is None or session.number > asked.number or session.ended:
        end_sessions()
        session = _sessions[id(work)] = Session(work, bench.threads)
    return session.compute(asked, bench.parcels)


class Session:
    """A computation on a worker, in a thread of its own, which waits in each step for its digest."""

    def __init__(self, work: SharedWork, threads: int) -> None:
        self.work = work  # kept, so that no other object gets its identity
        self.number = -1
        self.ended = False
        self._asked: queue.Queue[Any] = queue.Queue()
        self._answers: queue.Queue[Any] = queue.Queue()
        self._threads = threads
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        self._answer()

    def compute(self, asked: StepRange, parcels: Mapping[str, bytes]) -> bytes:
        """Compute a range, after the digests of earlier steps were taken."""
        if self.number < asked.number:
            before: list[bytes] = [digest for name in asked.before for digest in pickle.loads(parcels[name])]
            while self.number < asked.number:
                self._asked.put(before[self.number])
                self._answer()
        self._asked.put((asked.first, asked.end))
        found: bytes = self._answer()
        return found

    def end(self) -> None:
        """Stop the computation, and wait until it has ended."""
        self._asked.put(None)
        self._thread.join()

    def _answer(self) -> Any:
        answer = self._answers.get()
        if isinstance(answer, BaseException):
            self.ended = True
            raise answer
        return answer

    def _run(self) -> None:
        try:
            self.work.follow(self._share, _tell_nobody, self._threads)
            self._answers.put(RuntimeError("the computation has fewer steps here than where it was begun"))
        except InterruptedError:
            # It was stopped. The error that says so would keep the options alive by the frames of its traceback.
            self._answers.put(RuntimeError("the computation was stopped"))
        except BaseException as error:
            self._answers.put(error.with_traceback(None))

    def _share(self, count: int, rays_of_item: int, compute: Compute) -> bytes:
        self.number += 1
        self._answers.put(None)
        while True:
            asked = self._asked.get()
            if asked is None:
                raise InterruptedError
            if isinstance(asked, bytes):
                return asked
            self._answers.put(compute(*asked))


def _tell_nobody(_: bytes) -> None:
    """Workers tell no digests: they got them."""


def end_sessions() -> None:
    """Stop all computations of this worker, which also frees what they hold before the process ends."""
    while _sessions:
        _sessions.popitem()[1].end()


atexit.register(end_sessions)

_sessions: dict[int, Session] = {}
"""The session of a worker, by the identity of what it computes. It has one at a time."""
