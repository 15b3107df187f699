# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Videos by ffmpeg, which a small program stands for where it is not installed."""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

from eclat.errors import EclatError
from eclat.frames.video import require_ffmpeg, write_video
from eclat.images.image import Image


def stand_in(folder: Path, monkeypatch: pytest.MonkeyPatch, body: str) -> None:
    """Put a program called ffmpeg first on the path; `out` is the file that it should write."""
    program = folder / "bin" / "ffmpeg"
    program.parent.mkdir()
    program.write_text(f"#!{sys.executable}\nimport sys\nout = sys.argv[-1]\ndata = sys.stdin.buffer.read()\n{body}\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{program.parent}{os.pathsep}{os.environ['PATH']}")


def frames(folder: Path) -> list[Path]:
    paths = [folder / f"{n}.png" for n in range(3)]
    for n, path in enumerate(paths):
        Image(np.full((5, 7, 3), n / 4, np.float32)).save(path)
    return paths


def test_frames_go_in_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stand_in(tmp_path, monkeypatch, "open(out, 'wb').write(' '.join(sys.argv).encode() + data)")
    paths = frames(tmp_path)
    write_video(tmp_path / "a.mp4", paths, 24)
    written = (tmp_path / "a.mp4").read_bytes()
    assert written.endswith(b"".join(path.read_bytes() for path in paths))
    assert b"-framerate 24 " in written
    assert not list(tmp_path.glob(".eclat-*"))


def test_a_failure_leaves_the_old_video(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    stand_in(tmp_path, monkeypatch, "sys.exit('no such encoder')")
    video = tmp_path / "a.mp4"
    video.write_bytes(b"old")
    with pytest.raises(EclatError, match="ffmpeg could not write the video: no such encoder"):
        write_video(video, frames(tmp_path), 24)
    assert video.read_bytes() == b"old"
    assert not list(tmp_path.glob(".eclat-*"))


def test_without_ffmpeg(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(EclatError, match=r"a\.mp4: expected the program ffmpeg"):
        require_ffmpeg(tmp_path / "a.mp4")


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is not installed")
def test_a_real_video(tmp_path: Path) -> None:
    write_video(tmp_path / "a.mp4", frames(tmp_path), 24)
    assert b"ftyp" in (tmp_path / "a.mp4").read_bytes()[:32]
