# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Path-traced references, two independent ones a scene, kept on disk and extended when more samples are wanted.

Scenes may come with references of another renderer, which are used at their size (`given`). The others are in
benchmarks/references, by scene, size and a hash of the scene. They do not notice that the path tracer
changed: delete the folder then.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import eclat
from eclat.images.image import Image
from eclat.measure.metrics import RELATIVE_C, away_from_edges, relative_rmse
from eclat.scene import Scene

FOLDER = Path(__file__).resolve().parents[1] / "references"
CHUNK = 64
"""Samples a rendering; each chunk has its own seed, so that a reference can grow."""

FIRST_SEEDS = (0x0A000000, 0x0B000000)
"""Of A and B. Benchmarks render their pictures with small seeds."""


@dataclass(frozen=True, eq=False)
class Reference:
    """Two independent pictures of the truth, and which pixels lie away from edges."""

    a: np.ndarray
    b: np.ndarray
    away: np.ndarray
    c: float | None
    samples: int

    def error(self, image: Image) -> tuple[float, float]:
        """Relative RMSE over all pixels, and over those away from edges, free of the references' own noise."""
        squares = self._squares(image, image)
        return _root_of_mean(squares), _root_of_mean(squares[self.away])

    def cache_error(self, first: Image, second: Image) -> float:
        """Error of what two pictures share: of a cache that both were rendered from, with different seeds.

        Their own noise averages out like that of A and B, so few samples tell what the records do.
        """
        return _root_of_mean(self._squares(first, second))

    @property
    def noise(self) -> float:
        """Relative error of the mean of both, from their difference."""
        mean = (self.a + self.b) / 2
        return relative_rmse(self.a, mean, mean, self.c)

    def described(self) -> dict[str, float]:
        """As results keep it."""
        return {"samples": self.samples, "noise": self.noise}

    def _squares(self, first: Image, second: Image) -> np.ndarray:
        reference = (self.a + self.b) / 2
        c = RELATIVE_C * float((reference**2).mean()) if self.c is None else self.c
        squares = (first.pixels - self.a) * (second.pixels - self.b) / (reference**2 + c)
        return np.asarray(squares.mean(axis=-1))


def _root_of_mean(squares: np.ndarray) -> float:
    """The error, but never less than what noise hides: the bound within which 95 % of perfect pictures' would lie."""
    standard_error = float(squares.std()) / max(1, squares.size) ** 0.5
    return math.sqrt(max(float(squares.mean()), 1.64 * standard_error))


GUIDE_SAMPLES = 16
"""Paths per pixel of the picture that tells where the edges of a given reference are."""


def given(path: Path, factor: int, scene: Scene, c: float | None) -> Reference:
    """Read halves A and B that another renderer made, (H, W, 3) each, at 1 / `factor` of their size.

    With a box filter, the mean of the small pixels of a large one is what that one sees. The number of samples is not
    known, and stands as 0.
    """
    halves = np.load(path)
    a, b = (_shrunk(np.asarray(halves[name], np.float64), factor) for name in "AB")
    size = (a.shape[1], a.shape[0])
    layers = eclat.render(scene, eclat.Path(), samples=GUIDE_SAMPLES, size=size, seed=FIRST_SEEDS[0]).layers
    return Reference(a, b, away_from_edges(layers["depth"], layers["normal"]), c, 0)


def _shrunk(picture: np.ndarray, factor: int) -> np.ndarray:
    height, width = (side // factor for side in picture.shape[:2])
    return np.asarray(picture.reshape(height, factor, width, factor, -1).mean(axis=(1, 3)))


def own(name: str, draw: Callable[[int, int], np.ndarray], like: Reference, samples: int) -> Reference:
    """The reference of a renderer whose materials are not ours: at least `samples` paths per pixel of its own in each half.

    `draw` makes a picture from a number of samples and a seed. Edges are those of `like`, a reference of ours.
    """
    path = FOLDER / f"{name}-{like.a.shape[1]}x{like.a.shape[0]}.npz"
    stored = dict(np.load(path)) if path.is_file() else {}
    for half, first_seed in zip("ab", FIRST_SEEDS, strict=True):
        for chunk in range(int(stored.get(f"{half}_chunks", 0)), -(-samples // CHUNK)):
            print(f"{name}: reference {half.upper()}, {chunk * CHUNK} of {samples} samples", flush=True)
            total = stored.get(half, np.zeros(like.a.shape)) + draw(CHUNK, first_seed + chunk)
            stored |= {half: total, f"{half}_chunks": np.array(chunk + 1)}
            _store(path, stored)
    a, b = (stored[half] / int(stored[f"{half}_chunks"]) for half in "ab")
    return Reference(a, b, like.away, like.c, int(stored["a_chunks"]) * CHUNK)


def _store(path: Path, arrays: dict[str, np.ndarray]) -> None:
    """Write the file at once or not at all."""
    FOLDER.mkdir(exist_ok=True)
    part = path.with_suffix(".part.npz")
    np.savez(part, **arrays)
    part.replace(path)


def reference(name: str, scene: Scene, size: tuple[int, int], c: float | None, samples: int) -> Reference:
    """At least `samples` paths per pixel in each half; renders what is missing, and says so."""
    from eclat.bridge.compiled import (
        fingerprint,  # not before a probed core had the chance to take the place of the core
    )

    path = FOLDER / f"{name}-{size[0]}x{size[1]}-{fingerprint(scene)[:8]}.npz"
    halves = []
    stored = dict(np.load(path)) if path.is_file() else {}
    for half, first_seed in zip("ab", FIRST_SEEDS, strict=True):
        total = stored.get(half, np.zeros((size[1], size[0], 3)))
        chunks = int(stored.get(f"{half}_chunks", 0))
        while chunks * CHUNK < samples:
            print(f"{name}: reference {half.upper()}, {chunks * CHUNK} of {samples} samples", flush=True)
            image = eclat.render(scene, eclat.Path(), samples=CHUNK, size=size, seed=first_seed + chunks)
            total = total + image.pixels
            chunks += 1
            stored |= {half: total, f"{half}_chunks": np.array(chunks)}
            if "depth" not in stored:
                stored |= {"depth": image.layers["depth"], "normal": image.layers["normal"]}
            _store(path, stored)
        halves.append(total / chunks)
    away = away_from_edges(stored["depth"], stored["normal"])
    return Reference(halves[0], halves[1], away, c, int(stored["a_chunks"]) * CHUNK)
