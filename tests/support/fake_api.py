# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A stand-in for the core, so that tests of the command line need no rays."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import eclat
from eclat.images.image import Image
from eclat.scene import Scene


class FakeApi:
    """Replaces `eclat.render` and `eclat.irradiance`, keeps how they were called, and makes pictures with known noise.

    A picture is `truth` · (1 + noise / √samples), the noise depending on the seed; metadata are as from the core.
    """

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.calls: list[dict[str, Any]] = []
        self.raises: BaseException | None = None
        self.during: Callable[[], None] | None = None
        self.metadata: dict[str, Any] = {}
        """Beside what every picture says."""
        monkeypatch.setitem(vars(eclat), "render", self.render)
        monkeypatch.setattr("eclat.verbs.compare.render", self.render)
        monkeypatch.setitem(vars(eclat), "irradiance", self.irradiance)

    def render(self, scene: Scene, what: Any = None, **keywords: Any) -> Image:
        self.calls.append({"scene": scene, "what": what, **keywords})
        progress = keywords.get("progress")
        for fraction in (0.0, 0.5, 1.0):
            if progress is not None:
                progress("render", fraction, {"rays": 1000 * fraction})
        if self.during is not None:
            self.during()
        if self.raises is not None:
            raise self.raises
        width, height = keywords.get("size") or scene.cameras[0].size or (1280, 720)
        samples = keywords.get("samples") or 32
        rng = np.random.default_rng([keywords.get("seed", 0), samples])
        truth = np.linspace(0.1, 1.0, width * height * 3).reshape(height, width, 3)
        pixels = truth * (1 + 0.5 / samples**0.5 * rng.standard_normal(truth.shape))
        layers = {"depth": np.full((height, width), 2.0), "normal": np.broadcast_to([0.0, 0, 1], (height, width, 3))}
        statistics = {"samples": float(samples), "rays": 100.0 * samples, "seconds": 0.01 * samples}
        metadata = {"scene": scene.name, "method": "path", "seed": keywords.get("seed"), "statistics": statistics}
        metadata |= self.metadata
        return Image(pixels.astype(np.float32), layers, metadata)

    def irradiance(self, scene: Scene, points: Any, normals: Any, what: Any = None, **keywords: Any) -> np.ndarray:
        self.calls.append({"scene": scene, "points": points, "normals": normals, "what": what, **keywords})
        return np.asarray(points, dtype=np.float32)
