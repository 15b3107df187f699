# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The side of the workers: one range is computed at a time, by all threads that the worker has."""

from __future__ import annotations

import pickle
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from eclat.errors import heard_warnings
from eclat.farm.identity import Identity, refusal
from eclat.farm.parcels import Opened

REPORT = "eclat-progress"
"""The topic of the events by which workers tell their progress."""


@dataclass(frozen=True)
class Refused:
    """The answer of a worker that must not compute, because its bits could differ."""

    worker: str
    reason: str


@dataclass(frozen=True)
class Done:
    """The answer of a worker: what was computed, and the warnings meanwhile."""

    worker: str
    value: Any
    warnings: list[str]


class StoppedError(Exception):
    """Nobody waits for this range any more."""


@dataclass(frozen=True)
class Bench:
    """What the function that computes a range may use: a number of threads, a function for its progress, and parcels."""

    threads: int
    progress: Callable[[str, float, dict[str, float]], None]
    parcels: Mapping[str, bytes]


_lock = threading.Lock()
_opened = Opened()


def run_range(expected: Identity, call: bytes, shared: str, parcels: Mapping[str, bytes], tag: tuple[str, int]) -> Any:
    """Compute a range on a worker.

    Parameters
    ----------
    expected : what the process that asks is like. Nothing is opened if this one differs, as it might be unreadable here.
    call : a pickled pair of a function of the shared object, the range and a `Bench`, and the range.
    shared, parcels : the name of the parcel of the shared object, and the parcels.
    tag : the name of the request and the index of the range, for reports.

    Returns
    -------
    `Done` or `Refused`.
    """
    from distributed import get_worker

    worker = get_worker()
    key = worker.get_current_task()
    reason = refusal(expected)
    if reason:
        return Refused(worker.address, reason)

    def progress(phase: str, fraction: float, statistics: dict[str, float]) -> None:
        task = worker.state.tasks.get(key)
        if task is None or task.state == "cancelled":
            raise StoppedError
        worker.log_event(REPORT, {"request": tag[0], "index": tag[1], "fraction": float(fraction)})

    with _lock, heard_warnings() as heard:
        function, item = pickle.loads(call)
        value = function(_opened.open(shared, parcels), item, Bench(int(worker.state.nthreads), progress, parcels))
    return Done(worker.address, value, heard)
