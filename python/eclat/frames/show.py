# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""An animation that is being made: what its frames share, the picture of each, and their files."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any, Literal

from eclat.bridge.arguments import (
    picture_size,
    thread_count,
)
from eclat.bridge.compiled import fingerprint
from eclat.bridge.running import ProgressReport
from eclat.errors import EclatError
from eclat.farm.farm import current_farm
from eclat.farm.worker import Bench
from eclat.frames.accumulated import with_samples_of
from eclat.frames.frame_settings import FrameSettings
from eclat.frames.kept import KEY, fingerprint_of
from eclat.frames.motion_layers import Moment, motion_layers
from eclat.frames.on_farm import written_by
from eclat.frames.plan import Frame, Plan, coarse_to_fine
from eclat.frames.reports import Report
from eclat.frames.shutter import mean_of, moments, samples_each, seed_of_moment
from eclat.frames.timeline import Timeline
from eclat.images.image import Image
from eclat.images.tone import exposure_stops
from eclat.methods import Method, Source, load_solved
from eclat.methods import Path as PathTracing
from eclat.methods.method import OverTime
from eclat.methods.work import Care, Everywhere, Times, View, Views, Work
from eclat.scene import Camera, Scene
from eclat.verbs.continuing import fingerprint_of_camera
from eclat.verbs.render import render

KEPT_SCENES = 4
"""The number of scenes at different times that are kept: a frame, the next one and the previous one, and one more."""
LOOK_WIDTH, LOOK_SAMPLES = 64, 32
"""The size and the samples of the picture from which the exposure "auto" is chosen. Its log-average luminance then has a
noise far below the half stop that the exposure is rounded to."""


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
        self._alone: dict[int, Image] = {}
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
        instants = [self._at(time) for near in (frame, *self._around(frame)) for time in self._times(near)]
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
        return self.__dict__ | {"_progress": None, "_reports": None, "_recent": {}, "_alone": {}}

    def _picture(self, frame: Frame, source: Source, report: Report) -> Image:
        image = self._picture_alone(frame, source, report)
        around = self._around(frame)
        if around:
            image = self._accumulated(
                frame, image, [(near, self._picture_alone(near, source, report)) for near in around]
            )
        if self._settings.motion:
            step = 1 / self._plan.fps
            image.layers.update(self._motions(frame.time, frame.time - step, frame.time + step))
            image.metadata["objects"] = [mesh.name for mesh in self._scene.meshes]
        return image

    def _around(self, frame: Frame) -> list[Frame]:
        """Return the frames whose samples a frame takes as well."""
        reach = self._settings.accumulate
        return [near for near in self._plan.frames if 0 < abs(near.number - frame.number) <= reach]

    def _accumulated(self, frame: Frame, image: Image, around: list[tuple[Frame, Image]]) -> Image:
        """Return the picture of a frame with the samples of those around it."""
        others = []
        for near, picture in around:
            there = self._motions(near.time, near.time, near.time)["object_id"]
            motion = self._motions(frame.time, near.time, near.time)["motion_next"]
            others.append((picture, there, motion))
        objects = self._motions(frame.time, frame.time, frame.time)["object_id"]
        return with_samples_of(image, objects, others, self._settings.accumulate)

    def _motions(self, time: float, before: float, after: float) -> dict[str, Any]:
        """Compute the layers of motion at a time."""
        now, previous, following = (self._at(t) for t in (time, before, after))
        return dict(motion_layers(now, previous, following, self._size, thread_count(self._threads)))

    def _picture_alone(self, frame: Frame, source: Source, report: Report) -> Image:
        """Render a frame without those around it. The last pictures are kept for the frames after them."""
        if frame.number not in self._alone:
            while len(self._alone) > 2 * self._settings.accumulate:
                del self._alone[next(iter(self._alone))]
            self._alone[frame.number] = self._rendered(frame, source, report)
        image = self._alone[frame.number]
        return replace(image, layers=dict(image.layers), metadata=dict(image.metadata))

    def _rendered(self, frame: Frame, source: Source, report: Report) -> Image:
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
            while len(self._recent) >= KEPT_SCENES + 2 * self._settings.accumulate:
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
