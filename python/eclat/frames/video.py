# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Videos of finished frames, which ffmpeg encodes where it is installed."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from eclat.errors import EclatError
from eclat.files.atomic_file import check_writable


def require_ffmpeg(video: Path) -> str:
    """Return the path of ffmpeg. Raises EclatError if it is not installed, or if the video cannot be written."""
    check_writable(video)
    found = shutil.which("ffmpeg")
    if found is None:
        raise EclatError(
            f"{video}: expected the program ffmpeg, which writes videos, but it is not installed; install it, or write "
            "frames as .png"
        )
    return found


def write_video(video: Path, frames: Sequence[Path], fps: float) -> None:
    """Encode .png frames as H.264, which browsers play, in the order given. The file is written whole or not at all.

    Raises EclatError if ffmpeg fails.
    """
    program = require_ffmpeg(video)
    handle, temporary = tempfile.mkstemp(dir=video.parent, prefix=".eclat-", suffix=".partial.mp4")
    os.close(handle)
    command = [
        program, "-loglevel", "error", "-y", "-f", "image2pipe", "-framerate", f"{fps:g}", "-c:v", "png", "-i", "-",
        # H.264 in 4:2:0 needs an even width and height; the last row or column is repeated.
        "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "16",
        "-movflags", "+faststart", temporary,
    ]  # fmt: skip
    try:
        with tempfile.TemporaryFile() as said:
            with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=said, stderr=said) as running:
                assert running.stdin is not None
                with suppress(BrokenPipeError):  # ffmpeg says why it ended.
                    for frame in frames:
                        running.stdin.write(frame.read_bytes())
                with suppress(BrokenPipeError):
                    running.stdin.close()
                code = running.wait()
            said.seek(0)
            text = said.read()[-400:].decode("utf-8", "replace").strip()
        if code:
            raise EclatError(f"{video}: ffmpeg could not write the video: {text or f'exit code {code}'}")
        os.chmod(temporary, 0o644)
        os.replace(temporary, video)
    except OSError as error:
        raise EclatError(f"{video}: the video cannot be written: {error.strerror or error}") from None
    finally:
        with suppress(OSError):
            os.unlink(temporary)
