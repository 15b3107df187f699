# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verb `animate`, which makes the frames of a scene that moves."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, Literal

from eclat.bridge.arguments import (
    checked_max_depth,
    checked_max_error,
    checked_seed,
    picture_size,
    thread_count,
)
from eclat.bridge.compiled import fingerprint
from eclat.bridge.running import ProgressReport
from eclat.errors import EclatError
from eclat.farm.farm import current_farm
from eclat.farm.worker import Bench
from eclat.files.atomic_file import check_writable
from eclat.frames.frame_settings import FrameSettings
from eclat.frames.kept import KEY, fingerprint_of, is_finished
from eclat.frames.motion_layers import Moment, motion_layers
from eclat.frames.on_farm import written_by
from eclat.frames.plan import Frame, Plan, coarse_to_fine, make_plan
from eclat.frames.reports import Report
from eclat.frames.shutter import mean_of, moments, samples_each, seed_of_moment
from eclat.frames.timeline import Timeline
from eclat.frames.video import require_ffmpeg, write_video
from eclat.images.image import Image
from eclat.images.tone import check_display, exposure_stops
from eclat.methods import IrradianceCache, Method, Source, as_method, load_solved
from eclat.methods import Path as PathTracing
from eclat.methods.method import OverTime
from eclat.methods.work import Care, Everywhere, Times, View, Views, Work
from eclat.scene import Camera, Scene
from eclat.stage.staging import staged
from eclat.typed import typed
from eclat.verbs.continuing import fingerprint_of_camera
from eclat.verbs.render import render

KEPT_SCENES = 4
"""The number of scenes at different times that are kept: a frame, the next one and the previous one, and one more."""
LOOK_WIDTH, LOOK_SAMPLES = 64, 32
"""The size and the samples of the picture from which the exposure "auto" is chosen. Its log-average luminance then has a
noise far below the half stop that the exposure is rounded to."""


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
    adaptive: bool | None = None,
    denoise: bool | None = None,
    shutter: float = 0.0,
    moments: int = 8,
    motion: bool | None = None,
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


class Show:
    """An animation that is being made."""

    def __init__(
        self,
        scene: Scene,
        plan: Plan,
        settings: FrameSettings,
        method: Method,
        camera: int,
        threads: int | None,
        progress: ProgressReport | None,
    ) -> None:
        if not 0 <= camera < len(scene.cameras):
            raise EclatError(
                f"camera: expected an index below {len(scene.cameras)}, the number of cameras, got {camera}"
            )
        self.display = (0.0, "none")
        self._scene, self._plan, self._settings, self._method = scene, plan, settings, method
        self._camera, self._threads, self._progress = camera, threads, progress
        self._size = picture_size(scene.cameras[camera], settings.size)
        self._recent: dict[float, Moment] = {}
        self._reports = Report(progress, 0, 1)
        self._resting, self._path = "", ""
        self._over_time: OverTime | None = None
        self._share: Share | None = None
        self._timeline: Timeline | None = None
        times = [time for frame in plan.frames for time in self._times(frame)]
        if _only_the_camera_moves(scene, times):
            self._share = Share([self._at(time).camera for time in times])
        elif method.shares_over_time and len(set(times)) > 1:
            self._timeline = Timeline(self._at, times, self._size, fingerprint, len(plan.frames))

    def exposure(self, exposure: float | Literal["auto"]) -> float:
        """Return the exposure in stops of all frames. "auto" takes that of a small picture of the frame in the middle."""
        if exposure != "auto":
            return exposure_stops(exposure, None)  # type: ignore[arg-type]
        now = self._at(self._plan.frames[len(self._plan.frames) // 2].time)
        width, height = self._size
        small = (LOOK_WIDTH, max(1, round(LOOK_WIDTH * height / width)))
        look = render(
            now.scene, PathTracing(), samples=LOOK_SAMPLES, size=small, camera=now.camera, threads=self._threads
        )
        return exposure_stops("auto", look.pixels)

    def fingerprint(self, frame: Frame) -> str:
        """Compute a hash of all that the file of a frame depends on."""
        instants = [self._at(time) for time in self._times(frame)]
        if self._settings.motion:
            instants += [self._at(frame.time + step / self._plan.fps) for step in (0, -1, 1)]
        parts = {
            "number": frame.number,
            "scenes": list(dict.fromkeys(self._fingerprint_of_scene(instant.scene) for instant in instants)),
            "cameras": [fingerprint_of_camera(instant.camera) for instant in instants],
            "path": self._fingerprint_of_all(),
            "settings": asdict(self._settings) | {"size": self._size},
            "method": self._method.name,
            "options": asdict(self._method),
            "display": self.display if frame.path.suffix.lower() == ".png" else (),
        }
        return fingerprint_of(parts)

    def make(self, frames: list[Frame], keep_cache: bool, finished: Callable[[Path, bool], None] | None) -> None:
        """Render frames and write them."""
        if not frames:
            return
        source: Source = self._method
        if self._share is not None and self._method.solved is not None:
            source = self._solved(frames[0].path.parent if keep_cache else None)
        if self._timeline is not None:
            self._over_time = self._solved_over_time(
                self._timeline.times, frames[0].path.parent if keep_cache else None
            )
        farm = current_farm()
        made = self._made_here(frames, source)
        if farm is not None:
            made = written_by(farm, self, source, frames, self._progress)
        for frame in made:
            if finished is not None:
                finished(frame.path, False)

    def write(self, frame: Frame, source: Source, path: Path, bench: Bench | None = None) -> None:
        """Render a frame, from the solution of all frames if there is one, and write its file. Bits do not depend on `bench`."""
        if bench is not None:
            self._threads, self._reports = bench.threads, Report(bench.progress, 0, 1)
        image = self._picture(frame, source, self._reports)
        image.metadata[KEY] = {"number": frame.number, "time": frame.time, "fingerprint": self.fingerprint(frame)}
        image.save(path, exposure=self.display[0], tone_mapping=self.display[1])

    def _made_here(self, frames: list[Frame], source: Source) -> Iterator[Frame]:
        for done, frame in enumerate(frames):
            self._reports = Report(self._progress, done, len(frames))
            self.write(frame, source, frame.path)
            yield frame

    def __getstate__(self) -> dict[str, Any]:
        """Return what travels to other machines."""
        return self.__dict__ | {"_progress": None, "_reports": None, "_recent": {}}

    def _picture(self, frame: Frame, source: Source, report: Report) -> Image:
        settings = self._settings
        times = self._times(frame)
        pictures = []
        for k, time in enumerate(times):
            now = self._at(time)
            if self._timeline is not None and self._over_time is not None:
                now = Moment(self._timeline.scene(time), now.camera)
                source = self._over_time.at(self._timeline.index(time))
            pictures.append(
                render(
                    now.scene, source, camera=now.camera, size=self._size, max_depth=settings.max_depth,
                    samples=samples_each(settings.samples, len(times)), max_error=settings.max_error,
                    seed=seed_of_moment(settings.seed, k, len(times)), threads=self._threads, adaptive=settings.adaptive,
                    denoise=settings.denoise, progress=report.of_picture(k, len(times)),
                )
            )  # fmt: skip
        image = mean_of(pictures)
        # A frame is the same file whenever it is made, so that no clock may speak in it.
        image.metadata["statistics"].pop("seconds", None)
        if settings.motion:
            step = 1 / self._plan.fps
            now, before, after = (self._at(frame.time + t) for t in (0.0, -step, step))
            image.layers.update(motion_layers(now, before, after, self._size, thread_count(self._threads)))
            image.metadata["objects"] = [mesh.name for mesh in self._scene.meshes]
        return image

    def _solved(self, folder: Path | None) -> Source:
        """Solve once for all frames, or read what an earlier run kept in `folder`."""
        assert self._share is not None
        kept = None if folder is None else folder / f"path-{self._fingerprint_of_solve(fingerprint(self._scene))}.npz"
        if kept is not None and kept.exists():
            return load_solved(kept, self._scene)
        work = self._work()
        purpose: Views | Everywhere = Everywhere()
        if not self._method.for_whole_scene:
            cameras = self._share.cameras
            purpose = Views(tuple(View(cameras[i], self._size) for i in coarse_to_fine(len(cameras))))
        solved = self._method.solve(self._scene, purpose, work, Care())
        if kept is not None:
            solved.save(kept)
        return solved

    def _solved_over_time(self, times: Times, folder: Path | None) -> OverTime:
        """Solve for all times, or read what an earlier run kept in `folder`."""
        kept = None if folder is None else folder / f"times-{self._fingerprint_of_solve('')}.npz"
        if kept is not None and kept.exists():
            return self._method.load_over_time(kept, times, self._work())
        solved = self._method.solve_over_time(times, self._work())
        if kept is not None:
            solved.save(kept)
        return solved

    def _fingerprint_of_solve(self, scene: str) -> str:
        """Compute a hash of all that the solution of all frames depends on."""
        return fingerprint_of(
            {
                "scene": scene, "path": self._fingerprint_of_all(), "size": self._size, "method": self._method.name,
                "options": asdict(self._method), "max_depth": self._settings.max_depth, "seed": self._settings.seed,
            }
        )  # fmt: skip

    def _work(self) -> Work:
        return Work(self._settings.max_depth, self._settings.seed, thread_count(self._threads), self._progress)

    def _fingerprint_of_all(self) -> str:
        """Compute a hash of what the pictures share, if they share anything."""
        if self._timeline is not None:
            if not self._path:
                self._path = self._timeline.fingerprint(fingerprint_of_camera)
            return self._path
        return self._share.fingerprint if self._share is not None and self._method.solved is not None else ""

    def _times(self, frame: Frame) -> list[float]:
        return moments(frame.time, self._settings.shutter / self._plan.fps, self._settings.moments)

    def _at(self, time: float) -> Moment:
        """Return the scene and the camera at a time. If nothing but the camera moves, the scene is always the same object,
        which is compiled once. The last few scenes are kept for the same reason.
        """
        if time not in self._recent:
            while len(self._recent) >= KEPT_SCENES:
                del self._recent[next(iter(self._recent))]
            self._recent[time] = self._posed(time)
        return self._recent[time]

    def _posed(self, time: float) -> Moment:
        found = self._scene.at(time)
        if _same_light(found, self._scene):
            return Moment(self._scene, found.cameras[self._camera])
        return Moment(found, found.cameras[self._camera])

    def _fingerprint_of_scene(self, scene: Scene) -> str:
        if scene is not self._scene:
            return fingerprint(scene)
        if not self._resting:
            self._resting = fingerprint(scene)
        return self._resting


class Share:
    """The cameras of all frames, which share one solution."""

    def __init__(self, cameras: list[Camera]) -> None:
        self.cameras = cameras
        self.fingerprint = fingerprint_of({"cameras": [fingerprint_of_camera(camera) for camera in cameras]})


def _only_the_camera_moves(scene: Scene, times: list[float]) -> bool:
    return scene.animation is None or all(_same_light(scene.at(time), scene) for time in times)


def _same_light(a: Scene, b: Scene) -> bool:
    """Return whether two scenes have the same meshes, lights and environment, as Python objects."""
    if len(a.meshes) != len(b.meshes) or a.lights != b.lights or a.environment is not b.environment:
        return False
    return all(x is y for x, y in zip(a.meshes, b.meshes, strict=True))


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise EclatError(f"{folder}: the folder of the frames cannot be made: {error.strerror or error}") from None
    check_writable(folder / "frame.png")
