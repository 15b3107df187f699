# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The side that asks: ranges go out to the workers of a Dask cluster, and come back whatever happens to single workers."""

from __future__ import annotations

import logging
import os
import secrets
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from contextvars import ContextVar, Token
from dataclasses import dataclass, field
from typing import Any, Self

from eclat.bridge.running import ProgressReport
from eclat.errors import EclatError, shown, warn
from eclat.farm.identity import Identity, identity
from eclat.farm.parcels import Parcels
from eclat.farm.sending import Sender
from eclat.farm.worker import REPORT, Bench, Refused, run_range
from eclat.farm.workers import LOOK_AT_WORKERS, POLL, Workers
from eclat.typed import typed

PATIENCE = 60.0
"""Seconds to wait for a worker, for a scheduler that is started again, or for ranges that no worker begins, before giving up."""
MOST_RETRIES = 5
"""How often a range is sent again after Dask gave it up, each time because several workers died over it, and how often after it
was lost with all workers that had what it needs, while no range was finished."""
RESULT = 60.0
"""Seconds in which a result travels, before it is asked for again."""

RangeFunction = Callable[[Any, Any, Bench], Any]
"""A function, which modules of Éclat define, of a shared object, a range and a `Bench`."""

_current: ContextVar[Farm | None] = ContextVar("farm", default=None)


def current_farm() -> Farm | None:
    """Return the farm whose block is entered, or None."""
    return _current.get()


class Farm:
    """Workers of a Dask cluster, on which all verbs compute while its block is entered.

    The bits of the results are those of one machine. Workers may come, go and be killed at any time; a range whose worker
    dies is computed by another. Workers whose bits could differ are refused with a warning that says why.

    Parameters
    ----------
    client : a `distributed.Client` of any cluster.
    patience : seconds to wait for a worker or for a lost scheduler before an error. Ranges that no worker begins within them
        are sent again, and if again none does, there is an error too.

    Examples
    --------
    >>> import eclat
    >>> with eclat.Farm.local(2):  # or eclat.Farm(distributed.Client("tcp://192.168.1.10:8786"))
    ...     image = eclat.render("furnace", "path", samples=1, size=(8, 8))
    >>> image.pixels.shape
    (8, 8, 3)
    """

    @typed
    def __init__(self, client: Any, patience: float = PATIENCE) -> None:
        if not (hasattr(client, "submit") and hasattr(client, "scatter")):
            raise EclatError(f"Farm: expected a distributed.Client, got {shown(client)}")
        from eclat.farm.packing import Packed, pickled

        self.client = client
        self.workers = Workers(client, patience)
        self.ranges_sent = 0
        """The number of ranges that were sent so far, each counted as often as it was sent."""
        self._expected: Identity = {}
        self._packed, self._pickled = Packed(), pickled
        self._sender = Sender(client, self.workers)
        self._tokens: list[Token[Farm | None]] = []
        self._fractions: dict[int, float] = {}
        self._request = ""
        self._close: list[Any] = []

    @classmethod
    def connect(cls, scheduler: str, patience: float = PATIENCE) -> Farm:
        """Connect to the scheduler at an address such as tcp://192.168.1.10:8786. Raises EclatError if none answers within
        10 s, or within `patience` if this is less."""
        distributed = _distributed()
        try:
            distributed.Client(scheduler, timeout=min(patience, 10), set_as_default=False).close()
            # For a scheduler that is lost, a client waits as long as when it connects, and then it closes for good.
            client = distributed.Client(scheduler, timeout=patience, set_as_default=False)
        except (OSError, ValueError, TimeoutError, TypeError) as error:
            raise EclatError(f"scheduler: no scheduler answers at {scheduler}: {error}") from None
        farm = cls(client, patience)
        farm._close = [client]
        return farm

    @classmethod
    def local(cls, workers: int, threads: int | None = None) -> Farm:
        """Start workers on this machine, each a process with `threads` threads or an equal share of the processors."""
        distributed = _distributed()
        if not 1 <= workers <= 1024:
            raise EclatError(f"workers: expected 1 to 1024, got {workers}")
        each = threads or max(1, (os.cpu_count() or 1) // workers)
        cluster = distributed.LocalCluster(
            n_workers=workers,
            threads_per_worker=each,
            dashboard_address="127.0.0.1:0",
            memory_limit=0,
            silence_logs=logging.CRITICAL,
        )
        client = distributed.Client(cluster, set_as_default=False)
        farm = cls(client)
        farm._close = [client, cluster]
        return farm

    def close(self) -> None:
        """Disconnect from the cluster, and end workers that `local` started."""
        while self._close:
            self._close.pop(0).close()

    def __enter__(self) -> Self:
        self._expected = identity()
        self.workers.wait()
        self.workers.meet(self._expected)
        self.client.subscribe_topic(REPORT, self._heard)
        self._tokens.append(_current.set(self))
        return self

    def __exit__(self, *_: object) -> None:
        _current.reset(self._tokens.pop())
        self._sender.forget()
        self.close()

    def ordered(
        self,
        function: RangeFunction,
        shared: Any,
        items: Sequence[Any],
        progress: Callable[[float], None] | None = None,
        more: Parcels | None = None,
    ) -> list[Any]:
        """Compute ranges, and return their results in the order of `items`. See `each`."""
        found: dict[int, Any] = dict(self.each(function, shared, items, progress, more))
        return [found[index] for index in range(len(items))]

    def each(
        self,
        function: RangeFunction,
        shared: Any,
        items: Sequence[Any],
        progress: Callable[[float], None] | None = None,
        more: Parcels | None = None,
    ) -> Iterator[tuple[int, Any]]:
        """Compute ranges on the workers, and yield the index and the result of each as it is finished.

        Parameters
        ----------
        function : a function of Éclat's modules. Its result must depend on nothing but `shared` and the range.
        shared : an object that travels to each worker once.
        items : the ranges.
        progress : a function that is called with the finished share of all ranges, 0..1.
        more : further parcels, which travel to each worker once as well.

        Raises
        ------
        EclatError : the function raised one, no worker may compute, or the scheduler is lost and does not come back.
        """
        name, parcels = self._packed.pack(shared)
        request = _Request(self, function, (name, parcels | (more or {})), items, progress)
        outer = self._request, self._fractions
        self._request, self._fractions = request.name, {}
        try:
            yield from request.results()
        finally:
            request.cancel()
            self._request, self._fractions = outer

    def submit(
        self,
        call: tuple[RangeFunction, Any],
        shared: tuple[str, Parcels],
        tag: tuple[str, int],
        again: int,
        workers: list[str] | None,
    ) -> Any:
        """Send a range to one of some workers, and return its future."""
        self.ranges_sent += 1
        name, parcels = shared
        key = f"eclat-{tag[0]}-{tag[1]}-{again}"
        sent = self._sender.send(parcels)
        try:
            return self.client.submit(
                run_range, self._expected, self._pickled(call), name, sent, tag, key=key,
                workers=workers, priority=-tag[1], pure=False,
            )  # fmt: skip
        except Exception:
            if self.client.status == "closed":
                raise EclatError(self.workers.why_nobody_computes()) from None
            raise

    def recover(self) -> None:
        """Wait until the scheduler and a worker are there again. Raises EclatError if they do not come."""
        self._sender.forget()
        self.workers.wait()

    def shares(self) -> dict[int, float]:
        """The finished shares of ranges that workers have told, by index."""
        return self._fractions

    def _heard(self, event: tuple[float, Any]) -> None:
        _, told = event
        if told.get("request") == self._request:
            self._fractions[told["index"]] = told["fraction"]


@dataclass(eq=False)
class _Request:
    """Ranges that are being computed, and what is known of each."""

    farm: Farm
    function: RangeFunction
    shared: tuple[str, Parcels]
    items: Sequence[Any]
    progress: Callable[[float], None] | None
    name: str = field(default_factory=lambda: secrets.token_hex(6))
    open: dict[int, Any] = field(default_factory=dict)
    """Maps the indices of ranges that are not finished to their futures."""
    limits: dict[int, list[str]] = field(default_factory=dict)
    """Maps indices to the workers that may compute them, if others are refused."""
    sent: dict[int, int] = field(default_factory=dict)
    given_up: dict[int, int] = field(default_factory=dict)
    lost: dict[int, int] = field(default_factory=dict)
    """Maps indices to how often ranges were lost since one was finished last."""
    sign: float = field(default_factory=time.monotonic)
    """When the last sign came that any range may be finished."""
    stalled: bool = False
    """Whether all ranges were sent again because there was no sign, and none was finished since."""
    trouble: str = ""
    """Why a result that is there could not be had."""

    def results(self) -> Iterator[tuple[int, Any]]:
        """Yield the results as they come."""
        self._send(range(len(self.items)))
        looked = self.sign = time.monotonic()
        while self.open:
            left = len(self.open)
            for index in [index for index, future in self.open.items() if future.status != "pending"]:
                yield from self._answer(index)
            if time.monotonic() - looked > LOOK_AT_WORKERS:
                self._look_at_workers()
                looked = time.monotonic()
            self._tell()
            if len(self.open) == left:
                time.sleep(POLL)

    def cancel(self) -> None:
        """Tell the cluster that nobody waits any more."""
        if self.open and self.farm.client.status == "running":
            self._withdraw(list(self.open))
        self.open.clear()

    def _withdraw(self, indices: Sequence[int]) -> None:
        with suppress(Exception):  # A client that was closed meanwhile has nobody to tell.
            self.farm.client.cancel([self.open[index] for index in indices], force=True)

    def _send(self, indices: Sequence[int]) -> None:
        workers = self.farm.workers.accepted()
        if workers == []:
            self.farm.workers.wait()
            workers = self.farm.workers.accepted()
        for index in indices:
            again = self.sent[index] = self.sent.get(index, -1) + 1
            call = (self.function, self.items[index])
            self.open[index] = self.farm.submit(call, self.shared, (self.name, index), again, workers or None)
            if workers:
                self.limits[index] = workers
            else:
                self.limits.pop(index, None)

    def _answer(self, index: int) -> Iterator[tuple[int, Any]]:
        future = self.open[index]
        status = future.status
        if status == "pending":
            return  # It was sent again since it was looked at, or its worker died, and waiting for it here could last.
        if status in ("cancelled", "lost"):
            self._after_loss()
            return
        try:
            error = future.exception(timeout=RESULT) if status == "error" else None
            answer = future.result(timeout=RESULT) if status == "finished" else None
        except Exception as failure:
            # The worker died before it handed its result over. Dask computes the range again, unless it lost it.
            self.trouble = f"; the last result could not be had ({type(failure).__name__}: {failure})"
            if future.status in ("cancelled", "lost"):
                self._after_loss()
            return
        if error is not None:
            self._after_error(index, error)
            return
        if answer is None:
            return
        if isinstance(answer, Refused):
            self.farm.workers.refuse(answer.worker, answer.reason)
            self.farm.workers.wait()
            self._send([index])
            return
        del self.open[index]
        self.stalled, self.trouble = False, ""
        self.lost.clear()
        for message in answer.warnings:
            warn(message)
        yield index, answer.value
        self.sign = time.monotonic()

    def _after_error(self, index: int, error: BaseException) -> None:
        """Send a range again if its workers died; otherwise raise what went wrong."""
        kind = type(error).__name__
        if isinstance(error, EclatError):
            raise error
        if kind in ("CancelledError", "FutureCancelledError"):
            self._after_loss()
            return
        if kind != "KilledWorker":
            raise EclatError(f"a worker failed: {kind}: {error}") from error
        self.given_up[index] = self.given_up.get(index, 0) + 1
        if self.given_up[index] > MOST_RETRIES:
            raise EclatError(f"a range was given up: all workers that computed it died ({error}); is memory scarce?")
        self._send([index])

    def _after_loss(self) -> None:
        """The scheduler was lost, or all workers that held a parcel: wait for them, and send again what is lost."""
        self.farm.recover()
        lost = [i for i, future in self.open.items() if future.status in ("cancelled", "lost", "error")]
        for index in lost:
            self.lost[index] = self.lost.get(index, 0) + 1
            if self.lost[index] > MOST_RETRIES:
                raise EclatError(
                    f"a range was given up: it was lost {self.lost[index]} times with all workers that had what it needs; "
                    "is memory scarce?"
                )
        self._send(lost)

    def _look_at_workers(self) -> None:
        """Send ranges again that wait for workers which are no longer there, or that no worker computes. Raises EclatError if
        this does not help."""
        workers = self.farm.workers
        if self.farm.client.status not in ("running", "connecting"):
            self.farm.recover()
        there = set(workers.addresses()) if self.limits else set()
        stuck = [i for i in self.open if i in self.limits and there and not there & set(self.limits[i])]
        if stuck:
            self._withdraw(stuck)
            workers.wait()
            self._send(stuck)
        waited = time.monotonic() - self.sign
        if waited > workers.patience / 2 and workers.busy():
            self.sign = time.monotonic()
        elif waited > workers.patience:
            self._after_stall()

    def _after_stall(self) -> None:
        """Nobody computes, and nothing comes back: hand all ranges out again, once."""
        workers = self.farm.workers
        if not set(workers.addresses()) - workers.refused():
            raise EclatError(workers.why_nobody_computes())
        if self.stalled:
            raise EclatError(
                f"the workers that are there have begun none of {len(self.open)} ranges within {workers.patience:g} s, though "
                f"they were sent twice{self.trouble}; start the workers again"
            )
        self.stalled = True
        self._withdraw(list(self.open))
        self.farm.recover()
        self._send(list(self.open))
        self.sign = time.monotonic()

    def _tell(self) -> None:
        if self.progress is not None and self.items:
            partly = sum(share for index, share in self.farm.shares().items() if index in self.open)
            self.progress((len(self.items) - len(self.open) + partly) / len(self.items))


def share_of(progress: ProgressReport | None, phase: str) -> Callable[[float], None] | None:
    """Make a function of a finished share from a function for progress."""
    return None if progress is None else lambda share: progress(phase, share, {"rays": 0.0})


def _distributed() -> Any:
    try:
        import distributed
    except ImportError:
        raise EclatError("many machines need Dask: pip install 'eclat[dask]'") from None
    return distributed
