# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Ranges on workers: killed ones cost their ranges only, others are refused, and the scheduler may be started again.

Functions that workers run are defined inside tests, so that they travel to workers, which do not know this module.
"""

from __future__ import annotations

import asyncio
import os
import signal
import time
from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any

import distributed
import pytest

import eclat
from eclat.errors import EclatError, EclatWarning, warn
from eclat.farm import workers
from eclat.farm.farm import Farm, current_farm
from support.clusters import Cluster, local_client
from support.ending import ended

NOBODY = "tcp://127.0.0.1:1"
"""The address of a worker that is not there."""


@pytest.fixture(scope="module")
def client() -> Iterator[Any]:
    """Three workers, each a process of its own that is started again when it dies."""
    with local_client(3) as client:
        yield client


def test_results_are_in_the_order_of_the_ranges_and_warnings_come_back(client: Any) -> None:
    def double(shared: list[int], item: int, bench: Any) -> int:
        bench.progress("work", 0.5, {})
        if item == 3:
            warn("three is odd")
        return shared[item] * 2

    shares: list[float] = []
    with Farm(client) as farm, pytest.warns(EclatWarning, match="three is odd"):
        assert current_farm() is farm
        assert farm.ordered(double, [5, 6, 7, 8], range(4), shares.append) == [10, 12, 14, 16]
    assert current_farm() is None
    assert shares[-1] == 1.0 and shares == sorted(shares)


def test_a_scene_travels_once(client: Any) -> None:
    scene = eclat.load("furnace")

    def identity_of_scene(shared: Any, item: int, bench: Any) -> tuple[int, int]:
        return os.getpid(), id(shared[0])

    with Farm(client) as farm:
        first = farm.ordered(identity_of_scene, (scene, 1), range(6))
        second = farm.ordered(identity_of_scene, (scene, 2), range(6))
    places: dict[int, set[int]] = {}
    for process, address in first + second:
        places.setdefault(process, set()).add(address)
    assert all(len(addresses) == 1 for addresses in places.values())


def test_workers_that_are_killed_cost_their_ranges_only(client: Any) -> None:
    def slow(shared: str, item: int, bench: Any) -> tuple[int, int]:
        time.sleep(0.2)
        return item, os.getpid()

    processes = list(client.run(os.getpid).values())
    victims = iter(processes)
    done: list[tuple[int, int]] = []
    with Farm(client) as farm:
        for index, value in farm.each(slow, "", range(18)):
            done.append((index, value[0]))
            if len(done) in (2, 5) and (victim := next(victims, None)):
                os.kill(victim, signal.SIGKILL)
        # Each killed worker had one range in hand, and perhaps one whose result it had not handed over yet.
        assert farm.ranges_sent <= 18 + 4
    assert sorted(done) == [(n, n) for n in range(18)]
    client.wait_for_workers(3, timeout=120)


def test_a_slow_worker_computes_fewer_ranges_and_the_results_are_the_same(client: Any) -> None:
    slow = next(iter(client.nthreads()))

    def where(shared: str, item: int, bench: Any) -> tuple[int, str]:
        address = str(distributed.get_worker().address)
        time.sleep(2.0 if address == shared else 0.01)
        return item, address

    with Farm(client) as farm:
        found = farm.ordered(where, slow, range(24))
    assert [item for item, _ in found] == list(range(24))
    assert [address for _, address in found].count(slow) < 24 / 3


def test_all_workers_at_once_may_die_with_what_was_sent_to_them(client: Any) -> None:
    def slow(shared: str, item: int, bench: Any) -> str:
        time.sleep(0.2)
        return shared + str(item)

    with Farm(client) as farm:
        found = []
        for _, value in farm.each(slow, "n", range(9)):
            found.append(value)
            if len(found) == 3:
                for process in client.run(os.getpid).values():
                    os.kill(process, signal.SIGKILL)
    assert sorted(found) == [f"n{n}" for n in range(9)]
    client.wait_for_workers(3, timeout=120)


def test_a_worker_with_another_version_is_left_out_with_the_reason(client: Any) -> None:
    class Older(distributed.WorkerPlugin):  # type: ignore[misc, name-defined]
        """Makes one worker of three one of another version, until it is unregistered."""

        name = "older"

        def __init__(self, address: str) -> None:
            self.address = address

        def setup(self, worker: Any) -> None:
            if worker.address == self.address:
                eclat.__version__ = "0.0.9"

        def teardown(self, worker: Any) -> None:
            if worker.address == self.address:
                eclat.__version__ = version

    def where(shared: None, item: int, bench: Any) -> str:
        return str(distributed.get_worker().address)

    version, older = eclat.__version__, next(iter(client.nthreads()))
    client.register_plugin(Older(older))
    try:
        with pytest.warns(EclatWarning, match=r"left out.*Éclat 0\.0\.9 instead of"), Farm(client) as farm:
            assert older not in set(farm.ordered(where, None, range(9)))
        # One that comes later refuses its ranges itself.
        with pytest.warns(EclatWarning, match="left out"), Farm(client) as farm:
            farm.workers._refused.clear()
            assert older not in set(farm.ordered(where, None, range(9)))
    finally:
        client.unregister_worker_plugin("older")
    with Farm(client) as farm:
        assert farm.workers.accepted() is None


def test_workers_that_all_differ_are_an_error(client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(eclat, "__version__", "9.9.9")
    with pytest.warns(EclatWarning), pytest.raises(EclatError, match=r"no worker may compute.* instead of 9\.9\.9"):
        Farm(client).__enter__()


def test_a_mistake_on_a_worker_is_raised_as_it_is(client: Any) -> None:
    def wrong(shared: None, item: int, bench: Any) -> None:
        raise EclatError("room.glb: expected a room")

    def broken(shared: None, item: int, bench: Any) -> None:
        raise ZeroDivisionError("a fault")

    with Farm(client) as farm:
        with pytest.raises(EclatError, match=r"^room\.glb: expected a room"):
            farm.ordered(wrong, None, range(2))
        with pytest.raises(EclatError, match="a worker failed: ZeroDivisionError: a fault"):
            farm.ordered(broken, None, range(2))


def test_what_is_no_client_and_schedulers_that_do_not_answer_are_refused() -> None:
    with pytest.raises(EclatError, match=r"expected a distributed\.Client, got 3"):
        Farm(3)
    with pytest.raises(EclatError, match=r"no scheduler answers at tcp://127\.0\.0\.1:1"):
        Farm.connect("tcp://127.0.0.1:1", patience=0.2)
    with pytest.raises(EclatError, match="expected 1 to 1024, got 0"):
        Farm.local(0)


@pytest.mark.slow
@pytest.mark.parametrize("comes_back", [True, False])
def test_a_scheduler_that_is_lost_and_started_again(comes_back: bool) -> None:
    def slow(shared: str, item: int, bench: Any) -> int:
        time.sleep(0.2)
        return item

    with ExitStack() as stack:
        cluster = Cluster(stack)
        cluster.add_worker()
        with Farm.connect(cluster.address, patience=30) as farm:
            farm.workers.patience = 30 if comes_back else 1
            ranges = farm.each(slow, "", range(8))
            found = [next(ranges)]
            cluster.scheduler.kill()
            cluster.scheduler.wait()
            if comes_back:
                time.sleep(11)  # By default, clients close after 10 s.
                cluster.start_scheduler()
                cluster.add_worker()
                found += ranges
                assert sorted(found) == [(n, n) for n in range(8)]
            else:
                with pytest.raises(EclatError, match=r"scheduler was lost.* finished frames are kept"):
                    list(ranges)


def test_ranges_that_nobody_waits_for_stop(client: Any) -> None:
    def endless(shared: None, item: int, bench: Any) -> None:
        while True:
            time.sleep(0.02)
            bench.progress("work", 0.1, {})

    def quick(shared: None, item: int, bench: Any) -> int:
        return item

    def interrupted(share: float) -> None:
        if share > 0:
            raise KeyboardInterrupt

    with Farm(client) as farm:
        with pytest.raises(KeyboardInterrupt):
            farm.ordered(endless, None, range(3), interrupted)
        # Every worker computes one range at a time, so that this would never end if one went on.
        assert farm.ordered(quick, None, range(30)) == list(range(30))


@pytest.mark.parametrize("lost", [3, 100])
def test_ranges_that_no_worker_begins_are_sent_again_once(
    client: Any, monkeypatch: pytest.MonkeyPatch, lost: int
) -> None:
    submit, calls = client.submit, []

    def to_nobody(*arguments: Any, **keywords: Any) -> Any:
        calls.append(keywords["key"])
        return submit(*arguments, **keywords | ({"workers": [NOBODY]} if len(calls) <= lost else {}))

    def compute(farm: Farm) -> list[int]:
        return farm.ordered(lambda shared, item, bench: shared + item, 10, [1, 2, 3])

    monkeypatch.setattr(client, "submit", to_nobody)
    with Farm(client, patience=1.0) as farm:
        if lost == 3:
            assert ended(30, lambda: compute(farm)) == [11, 12, 13]
        else:
            with pytest.raises(EclatError, match="have begun none of 3 ranges within 1 s, though they were sent twice"):
                ended(30, lambda: compute(farm))
        assert len(calls) == 6
        monkeypatch.setattr(farm.workers, "addresses", list)
        with pytest.raises(EclatError, match="no worker has come within 1 s"):
            calls.clear()
            ended(30, lambda: compute(farm))


def test_ranges_that_take_longer_than_the_patience_are_waited_for(client: Any) -> None:
    def slow(shared: str, item: int, bench: Any) -> int:
        time.sleep(4.0)
        return item

    with Farm(client, patience=1.0) as farm:
        assert farm.ordered(slow, "", range(2)) == [0, 1]
        assert farm.ranges_sent == 2


def test_ranges_for_workers_that_are_gone_are_sent_to_others(client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    with Farm(client) as farm:
        accepted = iter([[NOBODY], None])
        monkeypatch.setattr(farm.workers, "accepted", lambda: next(accepted))
        assert ended(30, lambda: farm.ordered(lambda shared, item, bench: item, "", [1, 2])) == [1, 2]


def test_ranges_that_are_lost_each_time_are_an_error(client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    submit = client.submit

    def lost(*arguments: Any, **keywords: Any) -> Any:
        future = submit(*arguments, **keywords)
        future.cancel(force=True)
        return future

    monkeypatch.setattr(client, "submit", lost)
    with Farm(client) as farm, pytest.raises(EclatError, match="it was lost 6 times with all workers"):
        ended(30, lambda: farm.ordered(lambda shared, item, bench: item, "", [1]))


def test_a_scheduler_that_stands_still_is_an_error(client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    async def wait_for_ever() -> None:
        await asyncio.Event().wait()

    monkeypatch.setattr(workers, "ANSWER", 0.2)
    with Farm(client, patience=1.0) as farm:
        monkeypatch.setattr(client, "nthreads", wait_for_ever)
        with pytest.raises(EclatError, match="scheduler does not answer"):
            ended(30, farm.workers.wait)
