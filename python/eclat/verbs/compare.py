# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The verb `compare`, which renders a scene by several methods and measures each picture against a reference."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from eclat.bridge.arguments import MAX_ERROR_RANGE
from eclat.errors import EclatError, shown
from eclat.images.image import Image
from eclat.images.tone import auto_exposure
from eclat.measure.metrics import away_from_edges, flip, has_flip, relative_rmse, signed_error
from eclat.methods import METHODS, Method, Path, as_method
from eclat.typed import typed
from eclat.verbs.render import render

if TYPE_CHECKING:
    from eclat.measure.metrics import Float64
    from eclat.scene import Scene
from eclat.stage.staging import staged

ProgressReport = Callable[[str, float, dict[str, float]], None]

LONGER_SIDE = 512
"""Longer side of the pictures in pixels if no size is given: large enough to judge the pictures, small enough that the
reference is affordable."""

REFERENCE_SEEDS = (0x5EED_0A0A, 0x5EED_B0B0)
"""Numbers that are XORed into the seed, so that the references are independent of each other and of the pictures."""


@dataclass(frozen=True)
class Effort:
    """The effort of the methods at several levels.

    The last level uses the full effort. Each earlier level takes a quarter of the samples (or seconds), photons and
    patches of the next level and asks for twice its error, so noise and bias should halve from level to level.
    """

    levels: int = 4
    samples: int = 64
    max_error: float = 0.01
    time: float | None = None
    """Seconds that every method takes at the last level, instead of `samples`; None uses `samples`."""

    def __post_init__(self) -> None:
        if not 1 <= self.levels <= 10:
            raise EclatError(f"levels: expected 1 to 10, got {self.levels}")

    def at(self, level: int) -> tuple[dict[str, Any], float]:
        """Return the arguments of `render` for a level, counted from 0, and the `max_error` of methods that have
        one."""
        factor = 2 ** (self.levels - 1 - level)
        max_error = min(MAX_ERROR_RANGE[1], self.max_error * factor)
        if self.time is not None:
            return {"time": self.time / factor**2}, max_error
        return {"samples": max(1, self.samples // factor**2)}, max_error


@dataclass(frozen=True)
class Measurement:
    """The measured errors of one picture, which are relative (0.01 = 1 %), and its statistics."""

    method: str
    level: int
    error: float
    error_away_from_edges: float | None
    flip: float | None
    """Mean LDR-FLIP; None if the package flip-evaluator is not installed."""
    statistics: dict[str, float] = field(default_factory=dict)

    @property
    def seconds(self) -> float:
        """The number of seconds that solving and rendering took."""
        return float(self.statistics.get("seconds", math.nan))


@dataclass(frozen=True, eq=False)
class MethodResult:
    """The results of one method: measurements at all levels, and the picture and maps of the last level."""

    method: str
    measurements: tuple[Measurement, ...]
    image: Image
    signed_error: Float64
    flip_map: Float64 | None


@dataclass(frozen=True, eq=False)
class Reference:
    """Two independent reference pictures. If there is only one, `a` and `b` are the same picture."""

    a: Image
    b: Image

    @property
    def image(self) -> Image:
        """The mean of the two pictures."""
        half = np.float32(0.5)
        layers = {name: half * (a + self.b.layers[name]) for name, a in self.a.layers.items() if name in self.b.layers}
        return Image(half * (self.a.pixels + self.b.pixels), layers, self.a.metadata)

    @property
    def noise(self) -> float | None:
        """Relative error of the mean, estimated from the difference of the two pictures; None if there is only one."""
        if self.a is self.b:
            return None
        half = (self.a.pixels.astype(np.float64) - self.b.pixels) / 2
        mean = self.image.pixels.astype(np.float64)
        return relative_rmse(mean + half, mean, mean)


@dataclass(frozen=True, eq=False)
class Comparison:
    """The results of a comparison, which the comparison page shows."""

    scene: str
    reference: Reference
    results: tuple[MethodResult, ...]
    exposure: float
    """Exposure in stops at which pictures are shown and FLIP is measured."""

    def table(self) -> list[dict[str, Any]]:
        """Return one JSON-compatible row for each measurement."""
        names = [f.name for f in fields(Measurement)]
        return [{name: getattr(m, name) for name in names} for r in self.results for m in r.measurements]


@typed
def compare(
    scene: Scene | str | os.PathLike[str],
    methods: Sequence[str | Method | type[Method]] | None = None,
    *,
    effort: Effort | None = None,
    reference: Reference | None = None,
    reference_samples: int = 256,
    exposure: float | None = None,
    size: tuple[int, int] | None = None,
    camera: int = 0,
    max_depth: int = -1,
    seed: int = 0,
    threads: int | None = None,
    progress: ProgressReport | None = None,
) -> Comparison:
    """Render `scene` by several methods and measure their errors.

    Parameters
    ----------
    methods : methods, their classes or their names; None compares all of `METHODS`.
    effort : the number of levels, and their samples, errors or seconds; None takes the defaults of `Effort`.
    reference : the reference pictures. The default is two path-traced pictures with `reference_samples` paths per pixel
        each.
    exposure : exposure in stops. With None, the log-average luminance of the reference becomes mid-grey
        (`auto_exposure`).
    size : (width, height) in pixels. The default is the size of the reference if given, or that of the camera, scaled
        down to `LONGER_SIDE`.

    Raises
    ------
    EclatError : a method is unknown, the reference has another size, or `render` raises it.
    """
    scene = staged(scene)
    chosen = _known(methods)
    effort = effort or Effort()
    if reference is not None:
        size = (reference.a.width, reference.a.height)
    common = {"size": size or default_size(scene, camera), "camera": camera, "max_depth": max_depth, "threads": threads}
    if reference is None:
        reference = render_reference(scene, reference_samples, seed, progress, common)
    truth = reference.image
    shown_at = auto_exposure(truth.pixels) if exposure is None else exposure
    results = []
    for method in chosen:
        images: list[Image] = []
        for options, bounds in _levels(method, effort):
            label = f"{method.name}, level {len(images) + 1}"
            # The pictures are not denoised, because a denoiser would hide the differences between the methods.
            keywords = {**common, **bounds, "seed": seed, "denoise": False, "progress": _labelled(progress, label)}
            images.append(render(scene, options, **keywords))
        results.append(_measured(method.name, images, reference, truth, shown_at))
    return Comparison(scene.name, reference, tuple(results), shown_at)


def render_reference(
    scene: Scene, samples: int, seed: int, progress: ProgressReport | None, common: Mapping[str, Any]
) -> Reference:
    """Render two path-traced pictures with independent seeds."""
    pictures = [
        render(
            scene,
            Path(),
            samples=samples,
            seed=seed ^ other,
            progress=_labelled(progress, f"reference {i} of 2"),
            **common,
        )
        for i, other in enumerate(REFERENCE_SEEDS, 1)
    ]
    return Reference(*pictures)


def default_size(scene: Scene, camera: int) -> tuple[int, int]:
    """Return the camera's size, or 1280 × 720 if it has none, scaled down so that its longer side is `LONGER_SIDE`."""
    width, height = (scene.cameras[camera].size if camera < len(scene.cameras) else None) or (1280, 720)
    scale = min(1.0, LONGER_SIDE / max(width, height))
    return max(1, round(width * scale)), max(1, round(height * scale))


def _measured(name: str, images: Sequence[Image], reference: Reference, truth: Image, exposure: float) -> MethodResult:
    a, b = reference.a.pixels, reference.b.pixels
    mask = None
    if "depth" in truth.layers and "normal" in truth.layers:
        mask = away_from_edges(truth.layers["depth"], truth.layers["normal"])
    measurements = []
    flip_map: Float64 | None = None
    for level, image in enumerate(images):
        mean: float | None = None
        if has_flip():
            flip_map, mean = flip(image.pixels, truth.pixels, exposure)
        away = relative_rmse(image.pixels, a, b, mask=mask) if mask is not None and mask.any() else None
        error = relative_rmse(image.pixels, a, b)
        measurements.append(Measurement(name, level, error, away, mean, dict(image.metadata.get("statistics", {}))))
    last = images[-1]
    return MethodResult(name, tuple(measurements), last, signed_error(last.pixels, truth.pixels), flip_map)


def _known(methods: Sequence[str | Method | type[Method]] | None) -> list[Method]:
    """Return the methods without duplicates. Raises EclatError for an unknown one."""
    if methods is not None and (isinstance(methods, str) or not isinstance(methods, Sequence)):
        raise EclatError(f"methods: expected a list of methods, got {shown(methods)}")
    try:
        found = [as_method(method).options for method in methods or METHODS]
    except EclatError as error:
        raise EclatError(f"methods: {error}") from None
    return list(dict.fromkeys(found))


def _levels(method: Method, effort: Effort) -> list[tuple[Method, dict[str, Any]]]:
    """List the methods and the other arguments of `render` for each level; equal levels appear once."""
    levels: list[tuple[Method, dict[str, Any]]] = []
    for level in range(effort.levels):
        bounds, max_error = effort.at(level)
        options = method.at_effort(0.25 ** (effort.levels - 1 - level), max_error)
        if (options, bounds) not in levels:
            levels.append((options, bounds))
    return levels


def _labelled(progress: ProgressReport | None, label: str) -> ProgressReport | None:
    """Make a progress function that puts `label`, the name of the current picture, before the phase."""
    if progress is None:
        return None
    report = progress
    return lambda phase, fraction, statistics: report(f"{label}: {phase}", fraction, statistics)
