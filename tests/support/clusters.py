# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Dask clusters on this machine, for tests of farms."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from typing import Any

import distributed


@contextmanager
def local_client(workers: int) -> Iterator[Any]:
    """A client of some workers, each a process of its own that is started again when it dies."""
    with (
        distributed.LocalCluster(
            n_workers=workers, threads_per_worker=1, dashboard_address="127.0.0.1:0", memory_limit=0
        ) as cluster,
        distributed.Client(cluster, set_as_default=False) as client,
    ):
        yield client


class Cluster:
    """A scheduler and workers as processes, as on machines of their own; the stack ends them."""

    def __init__(self, stack: ExitStack) -> None:
        self._stack = stack
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.address = f"tcp://127.0.0.1:{self.port}"
        self.start_scheduler()

    def start_scheduler(self) -> None:
        at = ["--host", "127.0.0.1", "--port", str(self.port), "--no-jupyter"]
        self.scheduler = self._run("dask_scheduler", at, {})
        while self.scheduler.poll() is None:  # On a busy machine it takes longer than clients wait.
            with suppress(OSError), socket.create_connection(("127.0.0.1", self.port), timeout=1):
                return
            time.sleep(0.1)
        raise RuntimeError("the scheduler has ended")

    def add_worker(self, *arguments: str, **variables: str) -> subprocess.Popen[bytes]:
        """Start a worker with further arguments and environment variables."""
        return self._run("dask_worker", [self.address, "--nthreads", "1", "--no-nanny", *arguments], variables)

    def _run(self, program: str, arguments: list[str], variables: dict[str, str]) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", f"distributed.cli.{program}", *arguments, "--no-dashboard"]
        process = subprocess.Popen(command, stderr=subprocess.DEVNULL, env=os.environ | variables)
        self._stack.callback(process.wait)
        self._stack.callback(process.kill)
        return process
