# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Tries inputs in processes of their own, with limits of time and memory, and tells what became of each."""

from __future__ import annotations

import json
import mmap
import os
import resource
import select
import shutil
import signal
import struct
import sys
import tempfile
import traceback
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from random import Random

from eclat.errors import EclatError, EclatWarning
from fuzz.corpus import Files
from fuzz.mutations import damaged
from fuzz.targets import SHARES, TARGETS

SECONDS = 15
"""Of processor time that an input may take. Wall time, which a busy machine stretches, may be `PATIENCE` times that."""
PATIENCE = 20
MEGABYTES = 1024
"""That an input of a few kilobytes may take."""
RECYCLED = 2000
"""Inputs after which a process is replaced, so that no leak of the process counts as an input's."""

_FORMATS = [name for name, share in SHARES.items() for _ in range(share)]


@dataclass(frozen=True)
class Input:
    """One damaged file with those beside it."""

    number: int
    format: str
    files: Files
    random: Random
    """For what else is chosen when it is tried."""


@dataclass(frozen=True)
class Outcome:
    """What became of an input: "loaded", "rendered", "refused", or a finding with where it happened and the whole story."""

    number: int
    format: str
    word: str
    place: str = ""
    story: str = ""

    @property
    def is_finding(self) -> bool:
        return bool(self.place)


def make_input(seeds: dict[str, list[Files]], seed: int, number: int) -> Input:
    """Input `number` of `seed`: always the same."""
    random = Random(f"{seed}/{number}")
    kind = _FORMATS[number % len(_FORMATS)]
    files = dict(random.choice(seeds[kind]))
    names = list(files)
    # The file that is loaded is damaged more often than those beside it; now and then one is missing.
    name = names[0] if random.random() < 0.8 else random.choice(names)
    if len(names) > 1 and random.random() < 0.02:
        files.pop(random.choice(names[1:]))
    if name in files:
        files[name] = damaged(name, files[name], random)
    return Input(number, kind, files, random)


def path_in(folder: Path, one: Input) -> Path:
    """Write the input to `folder`; the path that is loaded."""
    for name, content in one.files.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes(content)
    main = "scene.xml" if one.format == "serialized" else next(iter(one.files))
    return folder / main


def try_input(one: Input, folder: Path) -> Outcome:
    """What becomes of the input. A warning that is not Éclat's is a finding too."""
    path = path_in(folder, one)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", EclatWarning)
        # Pillow's words about damaged TIFF files.
        warnings.filterwarnings("ignore", module=r"PIL\.")
        try:
            return Outcome(one.number, one.format, TARGETS[one.format](path, one.random))
        except EclatError as error:
            if "\n" in str(error) or len(str(error)) > 2000:
                return Outcome(one.number, one.format, "error of many lines", _place(error), str(error))
            return Outcome(one.number, one.format, "refused")
        except Exception as error:
            return Outcome(one.number, one.format, type(error).__name__, _place(error), traceback.format_exc())
        finally:
            for name in one.files:
                (folder / name).unlink(missing_ok=True)


def _place(error: BaseException) -> str:
    """The innermost line of Éclat's on the way to the error."""
    place = "?"
    for frame in traceback.extract_tb(error.__traceback__):
        if "/eclat/" in frame.filename:
            place = f"{frame.filename.rpartition('/eclat/')[2]}:{frame.name}"
    return place


def outcomes(seeds: dict[str, list[Files]], seed: int, numbers: range) -> Iterator[Outcome]:
    """Try the inputs of these numbers, one after the other, in processes that are replaced when they die."""
    rest = list(numbers)[::-1]
    while rest:
        batch = [rest.pop() for _ in range(min(RECYCLED, len(rest)))]
        worker = _Worker(seeds, seed, batch)
        done = 0
        for outcome in worker.outcomes():
            done += 1
            yield outcome
        rest += batch[done:][::-1]


class _Worker:
    """A process that tries a batch of inputs and ends at the first that breaks a limit."""

    def __init__(self, seeds: dict[str, list[Files]], seed: int, batch: list[int]) -> None:
        self._batch, self._seeds, self._seed = batch, seeds, seed
        self._current = mmap.mmap(-1, 8)
        self._folder = Path(tempfile.mkdtemp(prefix="eclat-fuzz-"))
        reading, writing = os.pipe()
        sys.stdout.flush()
        self._process = os.fork()
        if self._process == 0:
            os.close(reading)
            os._exit(self._child(writing))
        os.close(writing)
        self._pipe = reading

    def outcomes(self) -> Iterator[Outcome]:
        """As they come; the last one may be a finding that ended the process."""
        reached = 0
        try:
            for line in self._lines():
                reached += 1
                yield Outcome(**json.loads(line))
            status = self._reaped()
            if status != 0 and reached < len(self._batch):
                yield self._end(status)
        finally:
            self._reaped(kill=True)
            os.close(self._pipe)
            shutil.rmtree(self._folder, ignore_errors=True)

    def _lines(self) -> Iterator[bytes]:
        buffer = b""
        while True:
            ready, _, _ = select.select([self._pipe], [], [], SECONDS * PATIENCE)
            if not ready:
                os.kill(self._process, signal.SIGALRM)
                return
            piece = os.read(self._pipe, 1 << 16)
            if not piece:
                return
            *lines, buffer = (buffer + piece).split(b"\n")
            yield from lines

    def _reaped(self, kill: bool = False) -> int:
        if self._process:
            if kill:
                os.kill(self._process, signal.SIGKILL)
            _, self._status = os.waitpid(self._process, 0)
            self._process = 0
        return self._status

    def _end(self, status: int) -> Outcome:
        (number,) = struct.unpack("<q", self._current[:8])
        kind = make_input(self._seeds, self._seed, number).format
        said = (self._folder / "stderr").read_text(errors="replace")[-4000:]
        if os.WIFSIGNALED(status):
            name = signal.Signals(os.WTERMSIG(status)).name
            word = {"SIGPROF": f"more than {SECONDS} s", "SIGALRM": "it waits for ever"}.get(name, f"killed by {name}")
        else:
            word = f"exit code {os.WEXITSTATUS(status)}"
        stack = [line.strip() for line in said.splitlines() if "/eclat/" in line]
        place = stack[0].rpartition("/eclat/")[2] if stack else kind
        return Outcome(number, kind, word, place, said)

    def _child(self, writing: int) -> int:
        # What libraries say is part of the story, where they abort.
        said = os.open(self._folder / "stderr", os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        os.dup2(said, 1)
        os.dup2(said, 2)
        self._tell_stack_on_death()
        _limit_address_space()
        before = _peak()
        with open(writing, "wb", buffering=0) as pipe:
            for number in self._batch:
                self._current[:8] = struct.pack("<q", number)
                signal.setitimer(signal.ITIMER_PROF, SECONDS)
                outcome = try_input(make_input(self._seeds, self._seed, number), self._folder)
                signal.setitimer(signal.ITIMER_PROF, 0)
                taken = _peak() - before
                if taken > MEGABYTES and not outcome.is_finding:
                    word = f"more than {MEGABYTES} MB"
                    outcome = Outcome(number, outcome.format, word, outcome.format, f"{taken} MB, then {outcome.word}")
                pipe.write(json.dumps(vars(outcome)).encode() + b"\n")
                if taken > MEGABYTES:
                    return 0
        return 0

    def _tell_stack_on_death(self) -> None:
        import faulthandler

        faulthandler.enable(sys.__stderr__)
        # Said, then the default action: the process ends.
        faulthandler.register(signal.SIGPROF, file=sys.__stderr__, all_threads=True, chain=True)


def _limit_address_space() -> None:
    """So that no input takes the whole machine; twice the limit that is a finding."""
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    limit = used + 4 * MEGABYTES * (1 << 20)
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))


def _peak() -> int:
    """Megabytes of memory that this process had at most."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss >> 10
