# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What methods are asked for: the purpose for which a scene is prepared, how, and with how much care."""

from __future__ import annotations

from dataclasses import dataclass

from eclat.bridge.running import ProgressReport
from eclat.scene import Camera, FloatArray


@dataclass(frozen=True)
class Work:
    """How work on a scene is done, whatever the work is: checked values."""

    max_depth: int = -1
    """Edges of a path: 1 emission, 2 direct light, −1 unlimited."""
    seed: int = 0
    threads: int = 0
    """0 means all processors."""
    progress: ProgressReport | None = None


@dataclass(frozen=True)
class Care:
    """How long a solve goes on, and what is known of its error afterwards."""

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
