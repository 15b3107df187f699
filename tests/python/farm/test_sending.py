# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Parcels reach the workers whatever happens to some of them meanwhile, or there is an error: a transfer never lasts for ever."""

from __future__ import annotations

import asyncio
import os
import signal
import threading
from collections.abc import Iterator
from typing import Any

import dask
import distributed
import pytest

from eclat.errors import EclatError
from eclat.farm.farm import Farm
from support.clusters import local_client
from support.ending import ended


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    with local_client(2) as client:
        yield client


def test_a_transfer_that_a_dying_worker_ends_is_repeated(client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    scatter, calls = client.scatter, []

    def broken(*arguments: Any, **keywords: Any) -> Any:
        calls.append(arguments)
        if len(calls) < 3:
            raise distributed.comm.CommClosedError("the worker is gone")
        return scatter(*arguments, **keywords)

    monkeypatch.setattr(client, "scatter", broken)
    with Farm(client) as farm:
        assert farm.ordered(lambda shared, item, bench: shared + item, 10, [1, 2]) == [11, 12]
        assert len(calls) == 3
    calls.clear()
    with (
        Farm(client, patience=0.0) as farm,
        pytest.raises(EclatError, match=r"workers could not be sent .* within 0 s"),
    ):
        farm.ordered(lambda shared, item, bench: shared + item, 20, [1, 2])


def test_a_worker_that_dies_while_what_was_sent_is_copied_to_it(monkeypatch: pytest.MonkeyPatch) -> None:
    # The scheduler, which is in this process, tries to reach the dead worker for as long, also when it ends.
    soon = dask.config.set({"distributed.comm.timeouts.connect": "3s"})
    with soon, local_client(2) as client, Farm(client) as farm:
        addresses = sorted(client.nthreads())
        victim = client.run(os.getpid, workers=addresses[1:])[addresses[1]]
        # It sends the parcel to the first worker, and has the second one copy it.
        monkeypatch.setattr(distributed.utils_comm, "_round_robin_counter", [0])
        os.kill(victim, signal.SIGSTOP)
        killer = threading.Timer(0.5, os.kill, (victim, signal.SIGKILL))
        killer.start()
        assert ended(30, lambda: farm.ordered(lambda shared, item, bench: shared + item, 10, [1, 2])) == [11, 12]
        killer.join()


def test_copies_are_left_out_if_they_do_not_end(client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    scatter, endless = client.scatter, []

    async def wait_for_ever() -> None:
        endless.append(1)
        await asyncio.Event().wait()

    monkeypatch.setattr(
        client,
        "scatter",
        lambda *a, **k: wait_for_ever() if k.get("broadcast") or len(endless) > 1 else scatter(*a, **k),
    )
    with Farm(client, patience=1.0) as farm:
        for shared in (10, 20):
            found = ended(30, lambda shared=shared: farm.ordered(lambda a, item, bench: a + item, shared, [1, 2]))
            assert found == [shared + 1, shared + 2]
        assert len(endless) == 1
        endless.append(1)
        with pytest.raises(EclatError, match="could not be sent what they need within 1 s: the transfer does not end"):
            ended(30, lambda: farm.ordered(lambda a, item, bench: a + item, 30, [1, 2]))
