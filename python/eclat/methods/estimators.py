# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Estimators made from Python functions, which take arrays of rays or points and return arrays of light."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.scene import FloatArray, Scene

RadianceFunction = Callable[[FloatArray, FloatArray, FloatArray], FloatArray | tuple[FloatArray, FloatArray]]
"""A function from origins (N, 3) in metres, unit directions (N, 3) and a random number in [0, 1) for each ray (N,) to
the radiance (N, 3) along the rays, or to a pair: the radiance, and its part from paths with at most two edges. The
random numbers are the same for the same seed."""

IrradianceFunction = Callable[[FloatArray, FloatArray, str], FloatArray]
"""A function from positions (N, 3) in metres, unit normals (N, 3) and "total" or "indirect" to irradiance (N, 3) in
W·m⁻²."""


def radiance_from(scene: Scene, function: RadianceFunction) -> _core.Estimator:
    """Make an estimator of radiance along camera rays from a function, which is called for a few hundred rays at a
    time."""
    prepared = compiled(scene)

    def called(origins: np.ndarray, directions: np.ndarray, numbers: np.ndarray) -> np.ndarray:
        found = function(origins + prepared.center, np.asarray(directions, np.float64), np.asarray(numbers, np.float64))
        radiance, direct = found if isinstance(found, tuple) else (found, np.zeros((len(origins), 3)))
        both = np.empty((len(origins), 2, 3), np.float32)
        both[:, 0], both[:, 1] = radiance, direct
        return both

    return _core.called_estimator(prepared.core, called)


def irradiance_from(scene: Scene, function: IrradianceFunction) -> _core.PointEstimator:
    """Make an estimator of irradiance from a function, which is called once for all points."""
    center = compiled(scene).center

    def called(positions: np.ndarray, normals: np.ndarray, component: _core.Component) -> np.ndarray:
        found = np.empty((len(positions), 3), np.float32)
        found[:] = function(positions + center, np.asarray(normals, np.float64), component.name)
        return found

    return _core.called_point_estimator(called)
