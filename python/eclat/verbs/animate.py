# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verb `animate`, which makes the frames of a scene that moves."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Literal

from eclat.bridge.arguments import (
    checked_max_depth,
    checked_max_error,
    checked_seed,
)
from eclat.bridge.running import ProgressReport
from eclat.errors import EclatError
from eclat.files.atomic_file import check_writable
from eclat.frames.frame_settings import FrameSettings
from eclat.frames.kept import is_finished
from eclat.frames.plan import make_plan
from eclat.frames.show import Show
from eclat.frames.video import require_ffmpeg, write_video
from eclat.images.tone import check_display
from eclat.methods import IrradianceCache, Method, as_method
from eclat.scene import Scene
from eclat.stage.staging import staged
from eclat.typed import typed


@typed
def animate(
    scene: Scene | str | os.PathLike[str],
    what: Method | type[Method] | str | None = None,
    *,
    frames: Sequence[int] | range,
    output: str | os.PathLike[str],
    fps: float = 24.0,
    camera: int = 0,
    size: tuple[int, int] | None = None,
    samples: int | None = None,
    max_error: float = 0.03,
    max_depth: int = -1,
    seed: int = 0,
    threads: int | None = None,
    adaptive: bool | Literal["noise", "denoised"] | None = None,
    denoise: bool | None = None,
    shutter: float = 0.0,
    moments: int = 8,
    motion: bool | None = None,
    accumulate: int = 0,
    shard: tuple[int, int] | None = None,
    overwrite: bool = False,
    keep_cache: bool = False,
    exposure: float | Literal["auto"] = 0.0,
    tone_mapping: str = "none",
    progress: ProgressReport | None = None,
    finished: Callable[[Path, bool], None] | None = None,
) -> list[Path]:
    """Render the frames of an animation, and a video of them if it is asked for.

    Frame n shows the scene at n / `fps` seconds. A frame that is finished is kept when the animation is started again;
    each is written whole or not at all, and depends on nothing but the arguments, so that the frames have the same bits in
    any order, on any number of threads and machines, and after any interruption.

    If nothing but the camera moves, what the method solves is solved once for all frames: the records that all
    pictures want are found first, coarse to fine, and every frame reads the same cache, so that none has a seam against
    the next. If anything else moves or changes, irradiance caching solves its records over time: a record stays at its place on
    its surface, is gathered again when the light there has changed, and is interpolated between. Other methods prepare each
    frame anew, with the same random numbers.

    Parameters
    ----------
    what : a method with its options, or its class or name; None means irradiance caching. For a class or a name, its
        `max_error` is set to `max_error`.
    frames : the numbers of all frames of the animation.
    output : the name of the .exr or .png files with %d or %04d for the number of the frame, or that of an .mp4 file, which
        ffmpeg writes; its frames are then kept in a folder beside it. Folders are made.
    camera : the index of the camera.
    size, samples, max_error, max_depth, seed, threads, adaptive, denoise : as in `render`, for each frame.
    shutter : the part of the time between two frames during which the shutter is open, 0..1; its middle is the time of the
        frame. Objects and the camera are blurred by their motion during that time.
    moments : the number of times within it, at each of which a picture is taken; `samples` are divided among them.
    motion : whether .exr files get the layers `object_id`, `motion_next` and `motion_previous`
        (`eclat.frames.motion_layers`). None means True for .exr files.
    accumulate : the number of frames before and after a frame, 0..16, whose samples it takes as well, along the motion vectors
        and before it is denoised (`eclat.frames.accumulated`). Frames that are made apart, as by shards, render these again.
    shard : (i, n) makes only each n-th frame from the i-th on, counted from 1, so that n machines share the work.
    overwrite : whether finished frames are rendered again, and files of another origin are replaced.
    keep_cache : whether what is solved once for all frames is kept in a file beside the frames, and read from there if it
        exists, for example by other shards: `path-<fingerprint>.npz` if only the camera moves, otherwise
        `times-<fingerprint>.npz`.
    exposure, tone_mapping : those of .png files, as in `Image.save`. "auto" chooses one exposure for all frames.
    progress : a function that is called with the progress over all frames.
    finished : a function that is called for each frame with its file and whether it was kept.

    Returns
    -------
    The files of the frames of this shard, in the order of `frames`.

    Raises
    ------
    EclatError : an argument is invalid, a file of a frame exists that was made from something else, or a frame or the
        video cannot be made.

    Examples
    --------
    >>> import tempfile, eclat
    >>> keys = [{"time": 0, "from": [0, 1, 4], "to": [0, 1, 0]}, {"time": 1, "from": [1, 1, 4]}]
    >>> scene = eclat.with_camera_path(eclat.load("cornell-box"), {"keys": keys})
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     files = animate(scene, "path", frames=range(2), fps=2, output=f"{folder}/%d.png", size=(8, 8), samples=1)
    ...     [file.name for file in files]
    ['0.png', '1.png']
    """
    plan = make_plan(frames, fps, output, shard)
    settings = FrameSettings(
        size=size, samples=samples, max_error=checked_max_error(max_error), max_depth=checked_max_depth(max_depth),
        seed=checked_seed(seed), adaptive=adaptive, denoise=denoise, shutter=shutter, moments=moments,
        motion=plan.mine == () or plan.frames[0].path.suffix.lower() == ".exr" if motion is None else motion,
        accumulate=accumulate,
    ).checked()  # fmt: skip
    source = as_method(what, IrradianceCache(max_error=max_error), max_error=max_error)
    assert isinstance(source, Method)
    if plan.video is not None:
        require_ffmpeg(plan.video)
    for folder in {frame.path.parent for frame in plan.mine}:
        _make_folder(folder)
    show = Show(staged(scene), plan, settings, source, camera, threads, progress)
    stops = show.exposure(exposure) if plan.frames[0].path.suffix.lower() == ".png" else 0.0
    check_display(stops, tone_mapping)
    show.display = (stops, tone_mapping)
    kept = {frame for frame in plan.mine if not overwrite and is_finished(frame.path, show.fingerprint(frame))}
    show.make([frame for frame in plan.mine if frame not in kept], keep_cache, finished)
    if finished is not None:
        for frame in sorted(kept, key=lambda frame: frame.number):
            finished(frame.path, True)
    if plan.video is not None and all(frame.path.exists() for frame in plan.frames):
        write_video(plan.video, [frame.path for frame in plan.frames], plan.fps)
    return [frame.path for frame in plan.mine]


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise EclatError(f"{folder}: the folder of the frames cannot be made: {error.strerror or error}") from None
    check_writable(folder / "frame.png")
