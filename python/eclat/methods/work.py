# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The requests to methods: for which purpose a scene is prepared, how, and with how many checks."""

from __future__ import annotations

from dataclasses import dataclass

from eclat.bridge.running import ProgressReport
from eclat.scene import Camera, FloatArray


@dataclass(frozen=True)
class Work:
    """The settings that all work on a scene shares. Their values are checked."""

    max_depth: int = -1
    """Edges of a path: 1 emission, 2 direct light, −1 unlimited."""
    seed: int = 0
    threads: int = 0
    """0 means all processors."""
    progress: ProgressReport | None = None


@dataclass(frozen=True)
class Care:
    """Whether the error of a solve is checked and refined, and how long the solve may take."""

    check: bool = False
    """Estimate the error."""
    refine: bool = False
    """Solve again until the estimate meets the `max_error` of the options."""
    keep_partial: bool = False
    """Let KeyboardInterrupt carry what is done as its attribute `partial`."""
    deadline: float | None = None
    """The `time.perf_counter` at which the picture must be ready: prepare as finely as that allows."""


@dataclass(frozen=True, eq=False)
class View:
    """A scene is prepared for a picture of `size` (width, height)."""

    camera: Camera
    size: tuple[int, int]


@dataclass(frozen=True, eq=False)
class AtPoints:
    """A scene is prepared for points: positions and unit normals, (N, 3) each."""

    positions: FloatArray
    normals: FloatArray


@dataclass(frozen=True)
class Everywhere:
    """A scene is prepared for all surfaces."""


Purpose = View | AtPoints | Everywhere
