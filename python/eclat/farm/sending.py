# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Parcels on their way to the workers: each travels once, and again when the workers that had it are gone."""

from __future__ import annotations

import asyncio
import math
import secrets
import time
from collections.abc import Iterable
from contextlib import suppress
from typing import Any

from eclat.errors import EclatError
from eclat.farm.parcels import Parcels
from eclat.farm.workers import LOOK_AT_WORKERS, POLL, Workers

SLOWEST = 1e6
"""The bytes that travel in a second at least. A transfer that takes longer, and the patience on top, is given up."""
PAUSE = 60.0
"""Seconds without copies after a worker died meanwhile. The scheduler copies one thing at a time, and tries to reach the dead
worker for 30 s before it turns to the next one."""


class EndlessError(Exception):
    """A transfer does not end, although all workers are there."""


class Sender:
    """Scatters parcels to the workers of the cluster of a `distributed.Client`: to all of them, which saves time, or else to one,
    from which the others fetch what they need."""

    def __init__(self, client: Any, workers: Workers) -> None:
        self.client, self.workers = client, workers
        self._sent: dict[str, Any] = {}
        self._given_up: list[Any] = []
        self._copies_from = 0.0
        """Since when parcels are sent to all workers."""

    def send(self, parcels: Parcels) -> dict[str, Any]:
        """Return futures of parcels, which are scattered to the workers once, under their names."""
        missing = {name: content for name, content in parcels.items() if not _is_there(self._sent.get(name))}
        if missing:
            self._sent.update(self._scattered(missing))
        return {name: self._sent[name] for name in parcels}

    def forget(self) -> None:
        """Send all parcels again when they are next needed."""
        self._sent.clear()

    def _scattered(self, parcels: Parcels) -> dict[str, Any]:
        """Scatter parcels, and again if a worker dies meanwhile. Raises EclatError if it takes longer than the patience."""
        seconds = self.workers.patience + sum(map(len, parcels.values())) / SLOWEST
        end = time.monotonic() + seconds
        while True:
            copies = time.monotonic() > self._copies_from
            try:
                return self._transfer(parcels, copies, seconds)
            except Exception as error:  # While workers die, errors of many types come from the scheduler.
                if copies and isinstance(error, EndlessError):
                    self._copies_from, end = math.inf, time.monotonic() + seconds
                elif time.monotonic() > end:
                    raise EclatError(
                        f"workers could not be sent what they need within {seconds:.0f} s: {error}"
                    ) from None
                time.sleep(POLL)
                self.workers.wait()

    def _transfer(self, parcels: Parcels, copies: bool, seconds: float) -> dict[str, Any]:
        """Scatter parcels once. Raises an error of any type if this fails or takes longer than some seconds.

        A scheduler that copies something to all workers never ends if one of them dies meanwhile: it tries for ever to reach
        that one (`Scheduler.replicate` of Dask 2026.8), unless the client withdraws what is copied.
        """
        # Under keys that were used before, messages that withdraw the old ones could overtake the new ones.
        keys = {name: f"{name}-{secrets.token_hex(4)}" for name in parcels}
        there = set(self.workers.addresses())
        end = time.monotonic() + seconds
        where: dict[str, Any] = {"broadcast": True} if copies else {"workers": self.workers.last_heard()}

        async def scatter() -> dict[str, Any]:
            found: dict[str, Any] = await self.client.scatter(
                {keys[name]: content for name, content in parcels.items()}, **where
            )
            return {name: found[keys[name]] for name in parcels}

        transfer = asyncio.run_coroutine_threadsafe(scatter(), self.client.loop.asyncio_loop)
        try:
            while True:
                with suppress(TimeoutError):
                    return transfer.result(timeout=LOOK_AT_WORKERS)
                if transfer.done():
                    return transfer.result()
                self._withdraw(())
                if gone := there - set(self.workers.addresses()):
                    self._copies_from = max(self._copies_from, time.monotonic() + PAUSE)
                    raise ConnectionError(f"the worker {min(gone)} is gone")
                if time.monotonic() > end:
                    raise EndlessError("the transfer does not end")
        except BaseException:
            transfer.cancel()
            self._withdraw(keys.values())
            raise

    def _withdraw(self, keys: Iterable[str]) -> None:
        """Have the scheduler forget what it was to copy under these keys, and under earlier ones that it did not know then."""
        import distributed

        self._given_up += [distributed.Future(key, self.client) for key in keys]
        if self._given_up:
            with suppress(Exception):  # A client that was closed needs nothing withdrawn.
                self.client.cancel(self._given_up, force=True)


def _is_there(future: Any) -> bool:
    return future is not None and future.status == "finished"
