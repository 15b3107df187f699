# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The parts of a request to a method: the purpose that a scene is prepared for, the common settings, and the checks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from eclat.bridge.running import ProgressReport
from eclat.scene import Camera, FloatArray, Scene


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
    denoised: bool = False
    """Whether this is for a picture that is denoised. Noise then does less harm than errors that neighbouring pixels have in
    common, which no denoiser removes."""
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


@dataclass(frozen=True, eq=False)
class Times:
    """The purpose of the pictures of an animation in which more than the camera moves: the scene and the camera at each of
    its S times.

    `seconds` (S,) are the times, which increase; `states` (S,) number the states that the scene is in, from 0, so that
    neighbouring times with the same number look the same; `scene_in` gives the scene in a state. `moving_meshes` are the
    numbers of the meshes whose places or shapes change. `course` (S, K) are numbers that follow what moves and shines, such
    as coordinates and intensities. `steps_per_frame` is the number of times per frame.
    """

    seconds: FloatArray
    states: np.ndarray
    scene_in: Callable[[int], Scene]
    cameras: tuple[Camera, ...]
    size: tuple[int, int]
    moving_meshes: tuple[int, ...]
    course: FloatArray
    steps_per_frame: float = 1.0

    def __len__(self) -> int:
        return len(self.states)

    def scene(self, time: int) -> Scene:
        """Return the scene at a time, by its index."""
        return self.scene_in(int(self.states[time]))

    def first_time(self, state: int) -> int:
        """Return the index of the first time at which the scene is in a state."""
        return int(np.argmax(self.states == state))

    def from_the_middle(self) -> list[int]:
        """Return the indices of all times, those in the middle first. Of times with the same view only one is returned."""
        middle, known, found, views = (len(self) - 1) / 2, set(), [], self.views
        for time in sorted(range(len(self)), key=lambda i: (abs(i - middle), i)):
            if views[time] not in known:
                known.add(views[time])
                found.append(time)
        return found

    @property
    def views(self) -> list[tuple[int, Camera]]:
        """The state and the camera at each time. Times with the same ones have the same picture."""
        return [(int(state), camera) for state, camera in zip(self.states, self.cameras, strict=True)]


Purpose = View | Views | AtPoints | Everywhere
