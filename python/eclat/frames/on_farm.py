# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Frames that other processes and machines render. Their files travel back, so that no folder needs to be shared."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Protocol

from eclat.bridge.running import ProgressReport
from eclat.farm.farm import Farm, share_of
from eclat.farm.worker import Bench
from eclat.files.atomic_file import write_file
from eclat.frames.plan import Frame
from eclat.methods import Source


class FrameMaker(Protocol):
    """An animation, which can render each of its frames alone."""

    def write(self, frame: Frame, source: Source, path: Path, bench: Bench | None = None) -> None:
        """Render a frame to a file, with the threads and the progress of a worker if they are given."""


def written_by(
    farm: Farm, maker: FrameMaker, source: Source, frames: Sequence[Frame], progress: ProgressReport | None
) -> Iterator[Frame]:
    """Have frames rendered on a farm, and yield each as soon as its file is written."""
    for index, content in farm.each(_content_of, (maker, source), frames, share_of(progress, "frames")):
        write_file(frames[index].path, content)
        yield frames[index]


def _content_of(shared: tuple[FrameMaker, Source], frame: Frame, bench: Bench) -> bytes:
    maker, source = shared
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"frame{frame.path.suffix}"
        maker.write(frame, source, path, bench)
        return path.read_bytes()
