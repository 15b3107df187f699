# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A renderer in a process of its own: its crash, its hang and its copies of shared libraries touch nobody else."""

from __future__ import annotations

import contextlib
import importlib
import multiprocessing
import os
import signal
import traceback
from dataclasses import replace
from multiprocessing.connection import Connection
from typing import Any

from eclat.scene import Scene
from harness.entrant import Picture
from harness.unavailable import UnavailableError

TIMEOUT = 150.0
"""Seconds after which a picture counts as not finished."""


class WorkerError(Exception):
    """A renderer that was there failed; the message is its last word."""


class Worker:
    """`place` is "module:Class" of an `Entrant`. Raises UnavailableError or WorkerError where it cannot be made."""

    def __init__(self, place: str, scene: Scene, size: tuple[int, int], threads: int, timeout: float = TIMEOUT) -> None:
        self.timeout = timeout
        context = multiprocessing.get_context("spawn")
        self._connection, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs, place, scene, size, threads))
        self._process.start()
        theirs.close()
        self.levels: tuple[str, ...]
        self.levels, self.version, self.unbiased, self.own_truth = self._answer()

    def render(self, level: int) -> Picture:
        """The picture of a level. Raises WorkerError; the worker is closed then."""
        return self._asked(level)

    def truth(self, samples: int, seed: int) -> Picture:
        """A part of its own reference, of an entrant that has one. Raises WorkerError; the worker is closed then."""
        return self._asked((samples, seed))

    def _asked(self, what: int | tuple[int, int]) -> Picture:
        self._connection.send(what)
        answer = self._answer()
        assert isinstance(answer, Picture)
        return answer

    def close(self) -> None:
        """End the process and those that it started."""
        if self._process.pid is not None and self._process.is_alive():
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL)
            self._process.kill()
        self._process.join()
        self._connection.close()

    def _answer(self) -> Any:
        try:
            if not self._connection.poll(self.timeout):
                raise WorkerError(f"no answer within {self.timeout:g} s")
            kind, value = self._connection.recv()
        except (EOFError, OSError):
            self._process.join(10)
            code = self._process.exitcode
            self.close()
            raise WorkerError(f"its process ended with code {code}") from None
        except WorkerError:
            self.close()
            raise
        if kind == "done":
            return value
        self.close()
        raise (UnavailableError if kind == "unavailable" else WorkerError)(value)


def _processor_seconds() -> float:
    """Of this process and of those that it started and that have ended."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def _serve(connection: Connection, place: str, scene: Scene, size: tuple[int, int], threads: int) -> None:
    """Make the entrant, say its levels, then answer levels, and (samples, seed) of its own reference, with pictures until
    the other end closes."""
    with contextlib.suppress(OSError):
        os.setsid()  # so that `close` reaches the programs that it runs
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:threads])
    try:
        module, name = place.split(":")
        entrant = getattr(importlib.import_module(module), name)(scene, size, threads)
        own_truth = hasattr(entrant, "truth")
        connection.send(("done", (entrant.levels, entrant.version, entrant.unbiased, own_truth)))
        while True:
            asked = connection.recv()
            before = _processor_seconds()
            picture = entrant.truth(*asked) if isinstance(asked, tuple) else entrant.render(asked)
            connection.send(("done", replace(picture, processor=_processor_seconds() - before)))
    except EOFError:
        return
    except UnavailableError as reason:
        connection.send(("unavailable", str(reason)))
    except Exception as error:
        print(traceback.format_exc(), flush=True)
        connection.send(("failed", f"{type(error).__name__}: {error}"))
