# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Moving scenes: does a picture flicker where nothing moves, how true is it, and how many rays do its records take?

Records live over 60 frames, of which `--frames` in the middle are looked at. Flicker is the temporal noise of static points:
the RMS difference between what a picture and what a reference change by from frame to frame, at points that do not move and
are seen in both frames, away from edges, relative to the mean of the reference. Points are followed where the camera moves.
Two references, path-traced with seeds that are the same in all frames, stand for the truth: the product of both differences
is free of their noise. Error is the relative RMSE (`eclat.measure.metrics`) in the same way.

Entrants: records that live over time (one cache where only the camera moves); a cache of its own for each frame; and path
tracing in the same time. Each is shown as sampled and denoised. Frames of records have the same noise, or noise of their
own ("new noise"); for "mean of frames", each takes the mean of five along the motion vectors. Times are those of the
processor, for each thread.
"""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path as FilePath
from typing import Any

import numpy as np
from numpy.typing import NDArray

import eclat
from eclat.bridge.compiled import fingerprint
from eclat.frames.accumulated import with_samples_of
from eclat.frames.followed import SAME_SHARE, Look, followed
from eclat.frames.motion_layers import Moment, motion_layers
from eclat.frames.plan import coarse_to_fine
from eclat.frames.timeline import Timeline
from eclat.images.image import Image
from eclat.measure.metrics import RELATIVE_C, away_from_edges
from eclat.methods.method import Source
from eclat.methods.work import View, Views, Work
from eclat.scene import Scene
from eclat.stage.staging import staged
from eclat.verbs.denoise import denoise
from harness import document
from harness.benchmark import Benchmark, Settings, main
from harness.moving_scenes import FRAMES, MOVING
from harness.scenes import BenchmarkScene

SAMPLES = 16
MAX_ERROR, STATED_ERROR = 0.03, 0.05
"""The wanted error of records, and that of frames that state their error."""
REACH = 2
"""The number of frames before and after a frame whose samples it takes as well."""
BRIGHTER, ENLARGED = 20, 3
"""Of stills: by what changes are multiplied, and the side of a pixel."""
SEEDS = (0x0A000000, 0x0B000000)
"""The seeds of the references, far from those of pictures."""

Numbers = NDArray[np.float64]
Motions = dict[tuple[int, int], NDArray[np.float32]]
"""Motion (H, W, 3) from the first frame to the second, as in the layers of frames."""


@dataclass(frozen=True, eq=False)
class Shot:
    """The frames of a scene that are measured, and what is known about them."""

    moments: list[Moment]
    moving: tuple[int, ...]
    """The numbers of the meshes that move."""
    size: tuple[int, int]
    settings: Settings

    @property
    def camera_alone(self) -> bool:
        return not self.moving

    def render(self, index: int, source: Source, **given: Any) -> Image:
        now = self.moments[index]
        common: dict[str, Any] = {"size": self.size, "threads": self.settings.threads, "camera": now.camera}
        return eclat.render(now.scene, source, **common | given)

    def motions(self) -> tuple[list[NDArray[np.float32]], Motions]:
        """Return the objects of all frames, and the motion to the frames around each."""
        objects, found, last = [], {}, len(self.moments) - 1
        for i, now in enumerate(self.moments):
            for step in range(1, REACH + 1):
                before, after = max(0, i - step), min(last, i + step)
                pair = self.moments[before], self.moments[after]
                layers = motion_layers(now, *pair, self.size, self.settings.threads)
                found[i, before], found[i, after] = layers["motion_previous"], layers["motion_next"]
            objects.append(layers["object_id"])
        return objects, found


@dataclass
class Entry:
    """The frames of one entrant, and what they cost for each frame."""

    pictures: list[Image]
    seconds: float
    rays: float = 0.0
    stated: float | None = None


def shots_of(place: BenchmarkScene, settings: Settings) -> tuple[Shot, Shot, int]:
    """Return all frames, those in the middle of which pictures are made, and the number of the first of these."""
    scene = staged(place.load())
    frames = 3 if settings.quick else settings.frames or FRAMES
    first = (FRAMES - frames) // 2
    moments = []
    for time in range(first, first + frames) if settings.quick else range(FRAMES):
        found = scene.at(float(time))
        moments.append(Moment(found if _moves(scene, found) else scene, found.cameras[0]))
    moving: set[int] = set()
    for before, after in pairwise(moments):
        pairs = enumerate(zip(before.scene.meshes, after.scene.meshes, strict=True))
        moving |= {n for n, (a, b) in pairs if a is not b and not np.array_equal(a.positions, b.positions)}
    whole = Shot(moments, tuple(sorted(moving)), place.size_for(settings.quick), settings)
    first = 0 if settings.quick else first
    return whole, replace(whole, moments=moments[first : first + frames]), first


def _moves(scene: Scene, found: Scene) -> bool:
    return any(a is not b for a, b in zip(scene.meshes, found.meshes, strict=True))


def over_time(shot: Shot, method: eclat.IrradianceCache) -> tuple[Callable[[int], Source], float, float]:
    """Return what frames read, and the seconds and the rays that it took, for all frames together."""
    before = _processor_seconds(shot)
    if shot.camera_alone:
        views = tuple(View(shot.moments[i].camera, shot.size) for i in coarse_to_fine(len(shot.moments)))
        solved = method.solve(shot.moments[0].scene, Views(views), Work(threads=shot.settings.threads))
        return lambda index: solved, _processor_seconds(shot) - before, solved.statistics["rays"]
    times = Timeline(
        lambda t: shot.moments[int(t)], map(float, range(len(shot.moments))), shot.size, fingerprint, len(shot.moments)
    ).times
    moving = method.solve_over_time(times, Work(threads=shot.settings.threads))
    return moving.at, _processor_seconds(shot) - before, moving.statistics["rays"]


def anew(shot: Shot, method: eclat.IrradianceCache) -> Entry:
    pictures, rays, before = [], 0.0, _processor_seconds(shot)
    for i, now in enumerate(shot.moments):
        solved = eclat.solve(
            now.scene, method, camera=now.camera, size=shot.size, threads=shot.settings.threads, check=False
        )
        rays += solved.statistics["rays"]
        pictures.append(shot.render(i, solved, **_plain()))
    return Entry(pictures, (_processor_seconds(shot) - before) / len(pictures), rays / len(pictures))


def _plain(samples: int = SAMPLES, seed: int = 0) -> dict[str, Any]:
    return {"samples": samples, "seed": seed, "adaptive": False, "denoise": False}


def _processor_seconds(shot: Shot) -> float:
    """Return the time of the processor for each thread, so that other work of the machine does not count."""
    return clock.process_time() / shot.settings.threads


def taken(shot: Shot, count: int, picture: Callable[[int], Image]) -> tuple[list[Image], float]:
    """Return the pictures of all frames, and the seconds for each."""
    before = _processor_seconds(shot)
    pictures = [picture(i) for i in range(count)]
    return pictures, (_processor_seconds(shot) - before) / count


def entries(
    whole: Shot, shot: Shot, first: int, objects: Sequence[NDArray[np.float32]], motions: Motions
) -> dict[str, Entry]:
    """Make the frames of all entrants, from number `first` on."""
    count = len(shot.moments)
    method = eclat.IrradianceCache(max_error=0.1 if shot.settings.quick else MAX_ERROR)
    source_at, planning, rays = over_time(whole, method)
    planning, rays = planning / len(whole.moments), rays / len(whole.moments)

    def source(index: int) -> Source:
        return source_at(first + index)

    same, seconds = taken(shot, count, lambda i: shot.render(i, source(i), **_plain()))
    new, _ = taken(shot, count, lambda i: shot.render(i, source(i), **_plain(seed=i + 1)))
    means = {
        name: [_accumulated(pictures, i, objects, motions) for i in range(count)]
        for name, pictures in (("", same), (", new noise", new))
    }
    _, each = taken(shot, 1, lambda i: shot.render(count // 2, eclat.Path(), **_plain(samples=4)))
    paths = max(1, round(4 * (planning + seconds) / each))
    path, path_seconds = taken(shot, count, lambda i: shot.render(i, eclat.Path(), **_plain(paths)))
    wanted = {"max_error": 0.2 if shot.settings.quick else STATED_ERROR}
    stating, stating_seconds = taken(shot, count, lambda i: shot.render(i, source(i), **wanted))
    stated = [image.metadata["statistics"]["estimated_error"] for image in stating]
    return {
        "over time": Entry(same, planning + seconds, rays),
        "over time, new noise": Entry(new, planning + seconds, rays),
        "over time, mean of frames": Entry(means[""], planning + seconds, rays),
        "over time, mean of frames, new noise": Entry(means[", new noise"], planning + seconds, rays),
        "a cache for each frame": anew(shot, method),
        f"path, {paths} samples": Entry(path, path_seconds),
        "over time, until it states its error": Entry(
            stating, planning + stating_seconds, rays, float(np.sqrt(np.mean(np.square(stated))))
        ),
    }  # fmt: skip


def look(image: Image, objects: NDArray[np.float32]) -> Look:
    return Look(image.pixels, objects, image.layers["normal"], image.layers["depth"].reshape(objects.shape))


def _accumulated(pictures: Sequence[Image], i: int, objects: Sequence[NDArray[np.float32]], motions: Motions) -> Image:
    around = [k for k in range(i - REACH, i + REACH + 1) if 0 <= k < len(pictures) and k != i]
    others = [(pictures[k], objects[k], motions[i, k]) for k in around]
    return with_samples_of(pictures[i], objects[i], others, REACH)


@dataclass(frozen=True, eq=False)
class Truth:
    """References of all frames, (H, W, 3) each, and what is the same in them."""

    a: list[NDArray[np.float32]]
    b: list[NDArray[np.float32]]
    static: list[NDArray[np.bool_]]
    """The pixels of each frame but the last that show a static point which is seen in the next frame as well."""
    objects: Sequence[NDArray[np.float32]]
    guides: list[Image]
    motions: Motions
    mean: float

    def flicker(self, pictures: Sequence[NDArray[Any]]) -> float:
        products = [
            self._change(pictures, self.a, i) * self._change(pictures, self.b, i) for i in range(len(self.static))
        ]
        return _root(np.concatenate(products, axis=0)) / self.mean

    def _change(self, pictures: Sequence[NDArray[Any]], reference: Sequence[NDArray[Any]], i: int) -> Numbers:
        """By how much more a picture changes at static points from frame i to the next than the reference, (N, 3)."""
        off = [pictures[k].astype(np.float64) - reference[k] for k in (i, i + 1)]
        here, there = (
            replace(look(self.guides[k], self.objects[k]), radiance=o) for k, o in zip((i, i + 1), off, strict=True)
        )
        later, _ = followed(here, there, self.motions[i, i + 1])
        return np.asarray((later - off[0])[self.static[i]])

    def error(self, pictures: Sequence[NDArray[Any]]) -> float:
        squares = []
        for picture, a, b in zip(pictures, self.a, self.b, strict=True):
            square = ((a.astype(np.float64) + b) / 2) ** 2
            squares.append((picture - a) * (picture - b) / (square + RELATIVE_C * square.mean()))
        return _root(np.concatenate(squares, axis=0))


def _root(products: Numbers) -> float:
    """The root of the mean, but no less than what noise of the references hides (95 %)."""
    hidden = 1.64 * float(products.std()) / max(1, products.size) ** 0.5
    return float(np.sqrt(max(float(products.mean()), hidden)))


def truth(shot: Shot, objects: Sequence[NDArray[np.float32]], motions: Motions) -> Truth:
    samples = shot.settings.reference_samples
    references = [
        [shot.render(i, eclat.Path(), **_plain(samples, seed)) for i in range(len(shot.moments))] for seed in SEEDS
    ]
    guides, static = references[0], []
    rest = ~np.isin(np.arange(len(shot.moments[0].scene.meshes) + 1), [0, *(n + 1 for n in shot.moving)])
    away = [
        away_from_edges(g.layers["depth"], g.layers["normal"]).reshape(o.shape)
        for g, o in zip(guides, objects, strict=True)
    ]
    for i in range(len(guides) - 1):
        here = replace(look(guides[i], objects[i]), radiance=np.repeat(away[i][..., None], 3, axis=2).astype(float))
        there = replace(
            look(guides[i + 1], objects[i + 1]), radiance=np.repeat(away[i + 1][..., None], 3, 2).astype(float)
        )
        calm, share = followed(here, there, motions[i, i + 1])
        static.append(rest[objects[i].astype(int)] & away[i] & (share > SAME_SHARE) & (calm[..., 0] > SAME_SHARE))
    mean = float(np.mean([r.pixels.mean() for r in (*references[0], *references[1])]))
    a, b = ([image.pixels for image in r] for r in references)
    return Truth(a, b, static, objects, guides, motions, mean)


def run(name: str, place: BenchmarkScene, settings: Settings) -> dict[str, Any]:
    whole, shot, first = shots_of(place, settings)
    objects, motions = shot.motions()
    exact = truth(shot, objects, motions)
    found: dict[str, Any] = {}
    stills: dict[str, Sequence[NDArray[Any]]] = {}
    for entrant, entry in entries(whole, shot, first, objects, motions).items():
        clean = [image if image.metadata["denoised"] else denoise(image) for image in entry.pictures]
        given = [image.layers.get("noisy", image.pixels) for image in entry.pictures]
        shown = [image.pixels for image in clean]
        found[entrant] = {
            "seconds": entry.seconds, "rays": entry.rays, "stated": entry.stated,
            "flicker": exact.flicker(given), "error": exact.error(given),
            "denoised_flicker": exact.flicker(shown), "denoised_error": exact.error(shown),
        }  # fmt: skip
        print(f"{name}: {entrant}: {found[entrant]}", flush=True)
        if entrant in ("over time", "a cache for each frame") or entrant.startswith("path"):
            stills[entrant] = shown
    if not settings.quick:
        keep_stills(name, stills, exact)
    fresh, shared = found["a cache for each frame"]["rays"], found["over time"]["rays"]
    return {
        "frames": len(shot.moments), "frames_solved": len(whole.moments), "size": shot.size,
        "static": float(np.mean(exact.static)), "fewer_rays": fresh / shared, "entrants": found,
    }  # fmt: skip


def keep_stills(name: str, shown: dict[str, Sequence[NDArray[Any]]], exact: Truth) -> None:
    """Keep a picture of entrants, one below the other: the frame in the middle, denoised, and beside it, `BRIGHTER` times as
    bright, by how much each pixel changes to the next frame beyond the reference. Nine tenths of the picture are below white.
    """
    folder = FilePath(__file__).resolve().parent / "references" / "flicker"
    folder.mkdir(parents=True, exist_ok=True)
    rows = []
    for pictures in shown.values():
        i = (len(pictures) - 1) // 2
        own = (exact.a[i + 1] + exact.b[i + 1] - exact.a[i] - exact.b[i]) / 2
        change = np.abs(pictures[i + 1] - pictures[i] - own)
        rows.append(np.concatenate([pictures[i], BRIGHTER * change], axis=1))
    whole = np.concatenate(rows, axis=0) / np.percentile(exact.a[0], 90)
    whole = whole.repeat(ENLARGED, axis=0).repeat(ENLARGED, axis=1)
    Image(whole.astype(np.float32), {}, {}).save(folder / f"{name}.png")
    print(f"{name}: {folder / name}.png, from above: {', '.join(shown)}", flush=True)


def tables(result: dict[str, Any]) -> str:
    rows = []
    for name, scene in result["scenes"].items():
        for entrant, found in scene["entrants"].items():
            stated = "" if found["stated"] is None else document.percent(found["stated"])
            rows.append([
                f"{name}, {scene['frames']} frames", entrant, document.percent(found["flicker"]),
                document.percent(found["denoised_flicker"]), document.percent(found["error"]),
                document.percent(found["denoised_error"]), stated, f"{found['rays'] / 1e3:,.0f} k",
                document.seconds(found["seconds"]),
            ])  # fmt: skip
    header = [
        "scene",
        "entrant",
        "flicker",
        "denoised",
        "error",
        "denoised",
        "stated",
        "rays of records a frame",
        "time a frame",
    ]
    fewer = ", ".join(f"{name} {scene['fewer_rays']:.1f}" for name, scene in result["scenes"].items())
    return f"{document.table(header, rows)}\n\nFewer rays for records than with a cache for each frame, by factors of: {fewer}."


BENCHMARK = Benchmark(
    "flicker", __doc__, tuple(MOVING), run, tables, reference_samples=256, known=MOVING, frames=FRAMES
)

if __name__ == "__main__":
    main(BENCHMARK)
