# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The workers of a cluster: who is there, and who may compute because its bits are those of the process that asks."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from eclat.errors import EclatError, warn
from eclat.farm.identity import Identity, refusal

POLL = 0.05
"""Seconds between two looks."""
LOOK_AT_WORKERS = 1.0
"""Seconds between two looks at which workers there are."""
ANSWER = 30.0
"""Seconds within which a scheduler answers. Dask itself waits for ever for one whose machine stands still."""
SILENT = 300.0
"""Seconds after which a worker that tells nothing counts as lost, as Dask's schedulers have it by default."""
AT_WORK = ("executing", "long-running", "flight")
"""The states of tasks that a worker computes, or whose data it fetches."""


class Workers:
    """The workers of the cluster of a `distributed.Client`, for which one waits up to `patience` seconds."""

    def __init__(self, client: Any, patience: float) -> None:
        self.client, self.patience = client, patience
        self._refused: dict[str, str] = {}
        """Maps the addresses of workers that may not compute to the reasons."""
        self._heard: dict[str, tuple[float, float]] = {}
        """Maps addresses to when the scheduler heard of a worker last, and when that was first seen here."""
        self._answers = True

    def ask(self, seconds: float, method: Callable[..., Any], *arguments: Any, **keywords: Any) -> Any:
        """Call a method of the client that waits for the scheduler. Raises TimeoutError after some seconds."""

        async def call() -> Any:
            return await method(*arguments, **keywords)

        try:
            answer = self.client.sync(call, callback_timeout=seconds)
        except TimeoutError:
            self._answers = False
            raise
        self._answers = True
        return answer

    def threads(self) -> int:
        """The number of threads of all workers that may compute, at least 1."""
        return max(1, sum(n for worker, n in self._threads().items() if worker not in self._refused))

    def accepted(self) -> list[str] | None:
        """The addresses of workers that may compute, or None if all may."""
        if not self._refused:
            return None
        return [address for address in self.addresses() if address not in self._refused]

    def addresses(self) -> list[str]:
        """The workers that the scheduler knows; none while it cannot be reached."""
        return list(self._threads())

    def _threads(self) -> dict[str, int]:
        if self.client.status != "running":
            return {}
        try:
            return {str(worker): int(n) for worker, n in self.ask(ANSWER, self.client.nthreads).items()}
        except (OSError, ValueError):
            return {}

    def busy(self) -> bool:
        """Whether any that may compute does so, for whomever, or fetches what it needs, and was heard of lately."""
        now = time.monotonic()
        told = self._told()
        return any(
            now - self._heard[worker][1] < SILENT
            and any(one.get("metrics", {}).get("task_counts", {}).get(state) for state in AT_WORK)
            for worker, one in told.items()
        )

    def last_heard(self) -> list[str] | None:
        """The address of that worker of which the scheduler heard last, among those that may compute; None without any."""
        told = self._told()
        return [max(told, key=lambda worker: self._heard[worker][0])] if told else None

    def _told(self) -> dict[str, Any]:
        """What the scheduler was told last by the workers that may compute."""
        if self.client.status != "running":
            return {}
        try:
            told: dict[str, Any] = self.ask(ANSWER, self.client.scheduler.identity)["workers"]
        except (OSError, ValueError):
            return {}
        now = time.monotonic()
        seen = {worker: float(one["last_seen"]) for worker, one in told.items()}
        heard, self._heard = self._heard, {}
        for worker, last in seen.items():
            old = heard.get(worker)
            self._heard[worker] = old if old is not None and old[0] == last else (last, now)
        return {worker: one for worker, one in told.items() if worker not in self._refused}

    def refused(self) -> set[str]:
        """The addresses of workers that may not compute."""
        return set(self._refused)

    def refuse(self, address: str, reason: str) -> None:
        """Send nothing to a worker any more, and say why."""
        if address not in self._refused:
            self._refused[address] = reason
            warn(f"the worker {address} is left out, because its bits could differ: {reason}")

    def wait(self) -> None:
        """Wait until one is there that may compute. Raises EclatError if none comes within the patience."""
        end = time.monotonic() + self.patience
        while not (found := [a for a in self.addresses() if a not in self._refused]):
            if self.client.status == "closed" or time.monotonic() > end:
                raise EclatError(self.why_nobody_computes())
            time.sleep(POLL)
        assert found

    def meet(self, expected: Identity) -> None:
        """Ask all workers whether they may compute, and leave out those that may not. Raises EclatError if none may."""
        try:
            answers = self.ask(max(ANSWER, self.patience), self.client.run, refusal, expected, on_error="return")
        except OSError:
            return  # One of them does not answer. Each refuses its ranges itself, too.
        for address, answer in answers.items():
            if isinstance(answer, BaseException):
                self.refuse(address, f"Éclat cannot be used there ({type(answer).__name__}: {answer})")
            elif answer:
                self.refuse(address, answer)
        if answers and self.accepted() == []:
            raise EclatError(self.why_nobody_computes())

    def why_nobody_computes(self) -> str:
        """A sentence for an error."""
        if self.client.status != "running":
            waited = "the time that its client waits" if self.client.status == "closed" else f"{self.patience:g} s"
            return (
                f"the scheduler was lost and did not come back within {waited}; start it again, and then this command: "
                "finished frames are kept"
            )
        if not self._answers:
            return f"the scheduler does not answer within {ANSWER:g} s, though it is there; start it again"
        if self._refused:
            worker, reason = next(iter(self._refused.items()))
            return f"no worker may compute: all are left out, for example {worker}: {reason}"
        return f"no worker has come within {self.patience:g} s; start one by `dask worker tcp://…`"
