# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The workers of a cluster: who is there, and who may compute because its bits are those of the process that asks."""

from __future__ import annotations

import time
from typing import Any

from eclat.errors import EclatError, warn
from eclat.farm.identity import Identity, refusal

POLL = 0.05
"""Seconds between two looks."""


class Workers:
    """The workers of the cluster of a `distributed.Client`, for which one waits up to `patience` seconds."""

    def __init__(self, client: Any, patience: float) -> None:
        self.client, self.patience = client, patience
        self._refused: dict[str, str] = {}
        """Maps the addresses of workers that may not compute to the reasons."""

    def threads(self) -> int:
        """The number of threads of all workers that may compute, at least 1."""
        try:
            return max(1, sum(int(n) for worker, n in self.client.nthreads().items() if worker not in self._refused))
        except (OSError, TimeoutError, ValueError):
            return 1

    def accepted(self) -> list[str] | None:
        """The addresses of workers that may compute, or None if all may."""
        if not self._refused:
            return None
        return [address for address in self.addresses() if address not in self._refused]

    def addresses(self) -> list[str]:
        """The workers that the scheduler knows; none while it cannot be reached."""
        if self.client.status != "running":
            return []
        try:
            return list(self.client.nthreads())
        except (OSError, TimeoutError, ValueError):
            return []

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
                raise EclatError(self._why_nobody_computes())
            time.sleep(POLL)
        assert found

    def meet(self, expected: Identity) -> None:
        """Ask all workers whether they may compute, and leave out those that may not. Raises EclatError if none may."""
        answers = self.client.run(refusal, expected, on_error="return")
        for address, answer in answers.items():
            if isinstance(answer, BaseException):
                self.refuse(address, f"Éclat cannot be used there ({type(answer).__name__}: {answer})")
            elif answer:
                self.refuse(address, answer)
        if answers and self.accepted() == []:
            raise EclatError(self._why_nobody_computes())

    def _why_nobody_computes(self) -> str:
        if self.client.status != "running":
            waited = "the time that its client waits" if self.client.status == "closed" else f"{self.patience:g} s"
            return (
                f"the scheduler was lost and did not come back within {waited}; start it again, and then this command: "
                "finished frames are kept"
            )
        if self._refused:
            worker, reason = next(iter(self._refused.items()))
            return f"no worker may compute: all are left out, for example {worker}: {reason}"
        return f"no worker has come within {self.patience:g} s; start one by `dask worker tcp://…`"
