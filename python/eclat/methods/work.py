# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The parts of a request to a method: the purpose that a scene is prepared for, the common settings, and the checks."""

from __future__ import annotations

from dataclasses import dataclass

from eclat.bridge.running import ProgressReport
from eclat.scene import Camera, FloatArray


@dataclass(frozen=True)
class Work:
    """The settings that all computations for a scene share; their values have been checked."""

    max_depth: int = -1
    """Greatest number of edges of a path: 1 is emission only, 2 adds direct light, −1 sets no limit."""
    seed: int = 0
    threads: int = 0
    """Number of threads; 0 means all processors."""
    progress: ProgressReport | None = None


@dataclass(frozen=True)
class Care:
    """The wishes about a solve: whether its error is estimated, whether it is refined, and how long it may take."""

    check: bool = False
    """Whether the error is estimated."""
    refine: bool = False
    """Whether to solve again until the estimated error is below the `max_error` of the options."""
    keep_partial: bool = False
    """Whether a KeyboardInterrupt gets what is finished as its attribute `partial`."""
    deadline: float | None = None
    """Value of `time.perf_counter` at which the picture must be finished; the scene is prepared as finely as this
    allows. None sets no limit."""


@dataclass(frozen=True, eq=False)
class View:
    """The purpose of a picture of `size` (width, height) pixels."""

    camera: Camera
    size: tuple[int, int]


@dataclass(frozen=True, eq=False)
class Views:
    """The purpose of several pictures of one scene, such as those along the path of a camera. The order of the views
    decides in which order their wants are looked up. There is at least one view."""

    views: tuple[View, ...]


@dataclass(frozen=True, eq=False)
class AtPoints:
    """The purpose of irradiance at points: positions and unit normals, (N, 3) each."""

    positions: FloatArray
    normals: FloatArray


@dataclass(frozen=True)
class Everywhere:
    """The purpose of all surfaces, for all views."""


Purpose = View | Views | AtPoints | Everywhere
