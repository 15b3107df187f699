# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The scenes that benchmarks run on, each with its size and its c of the error (`eclat.measure.metrics`)."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import eclat
from eclat.measure.metrics import TARGET_C
from eclat.scene import Scene
from harness.machine import ROOT
from harness.painted import painted
from harness.unavailable import UnavailableError

FOLDER = Path(os.environ.get("ECLAT_SCENES", ROOT.parent / "shared" / "scenes"))
QUICK_SIDE = 64


@dataclass(frozen=True)
class BenchmarkScene:
    """`source` is a built-in name with `parameters`, or a file in `FOLDER`; `paint` gives every surface one diffuse colour,
    `materials` are others by name (`eclat.override_materials`), and `change` is applied last."""

    source: str
    size: tuple[int, int]
    c: float | None = None
    paint: bool = False
    parameters: Mapping[str, float] = field(default_factory=dict)
    materials: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    change: Callable[[Scene], Scene] = lambda scene: scene

    def load(self) -> Scene:
        """The scene. Raises UnavailableError where its file is absent."""
        if "/" not in self.source:
            scene = eclat.load(self.source, **self.parameters)
            return self.change(eclat.override_materials(scene, self.materials))
        path = FOLDER / self.source
        if not path.is_file():
            how = "set ECLAT_SCENES to the folder of real scenes (CONTRIBUTING.md, 'Real scenes')"
            raise UnavailableError(f"{path} is absent: {how}")
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # what the file's own dirt calls for, named by `eclat info`
            scene = eclat.load(str(path))
        return self.change(eclat.override_materials(painted(scene) if self.paint else scene, self.materials))

    def given_reference(self, name: str, size: tuple[int, int]) -> tuple[Path, int] | None:
        """The file with two independent halves A and B that came with the scenes, and how many of its pixels make one of
        ours along each side; None if there is none whose size is a multiple of ours.
        """
        path = FOLDER / "targets" / f"{name}-{self.size[0]}x{self.size[1]}.npz"
        factor = self.size[0] // size[0]
        whole = self.size == (factor * size[0], factor * size[1])
        return (path, factor) if whole and path.is_file() else None

    def size_for(self, quick: bool, side: int | None = None) -> tuple[int, int]:
        """(width, height), with a longer side of `side` pixels where it is given, of `QUICK_SIDE` for smoke runs."""
        wanted = QUICK_SIDE if quick else side
        scale = 1.0 if wanted is None else wanted / max(self.size)
        return max(1, round(self.size[0] * scale)), max(1, round(self.size[1] * scale))


POLISH = {"type": "roughplastic", "distribution": "ggx", "alpha": 0.3}
"""Of a stone floor."""

SCENES: dict[str, BenchmarkScene] = {
    "cornell-box": BenchmarkScene("cornell-box", (512, 512), TARGET_C),
    "furnace": BenchmarkScene("furnace", (512, 512)),
    "glossy-box": BenchmarkScene("glossy-box", (512, 512), TARGET_C),
    "glossy-box-0.4": BenchmarkScene("glossy-box", (512, 512), TARGET_C, parameters={"alpha": 0.4}),
    "glossy-box-0.6": BenchmarkScene("glossy-box", (512, 512), TARGET_C, parameters={"alpha": 0.6}),
    "two-rooms": BenchmarkScene("two-rooms", (512, 512)),
    "door-ajar": BenchmarkScene("door-ajar", (512, 288)),
    "sponza": BenchmarkScene("targets/sponza-sun.xml", (512, 512), TARGET_C),
    "sponza-polished": BenchmarkScene("targets/sponza-sun.xml", (512, 512), TARGET_C, materials={"sp_00_pod": POLISH}),
    "sibenik-polished": BenchmarkScene("sibenik/nave.xml", (512, 288), materials={"pod": POLISH}),
    "sibenik": BenchmarkScene("sibenik/nave.xml", (512, 288)),
    "sibenik-painted": BenchmarkScene("sibenik/nave.xml", (512, 288), paint=True),
    "atrium": BenchmarkScene("atrium", (512, 288)),
    "living-room": BenchmarkScene("living-room/scene.xml", (640, 360)),
    "classroom": BenchmarkScene("classroom/sky-image.xml", (640, 360)),
}
