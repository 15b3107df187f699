# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The functions of the core that fill caches for a view, for points or for all surfaces, and estimate their error."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.methods.work import AtPoints, Everywhere, Purpose, Views
from eclat.scene import Scene

SURFACE_POINTS = 1 << 14
"""Number of points, evenly distributed over all surfaces, at which the error of records for all surfaces is
estimated."""


@dataclass(frozen=True)
class CacheFunctions:
    """The functions of the core that fill the caches for a purpose and estimate their error."""

    fill: Callable[[_core.SolvedCaches, _core.IrradianceCacheOptions, _core.Progress], None]
    """Fills the caches in place; if it is cancelled, the finished records remain."""
    estimate: Callable[
        [_core.SolvedCaches, _core.ErrorCheck, _core.Progress, _core.RadianceTables | None], _core.ErrorEstimate
    ]
    fill_radiance: (
        Callable[[_core.SolvedCaches, _core.RadianceTables, _core.RadianceCacheOptions, _core.Progress], None] | None
    ) = None
    """Fills the caches with records of radiance too; None for points, which have no glossy lobes."""
    estimates_gloss: bool = False
    """Whether `estimate` includes the error of glossy reflection, and not only that of irradiance."""


def functions_for(scene: Scene, purpose: Purpose) -> CacheFunctions:
    """Return the functions of the core that fill and check caches for a purpose."""
    prepared = compiled(scene)
    if isinstance(purpose, AtPoints):
        positions = prepared.to_core(purpose.positions)
        directions = np.ascontiguousarray(purpose.normals, np.float32)
        return CacheFunctions(
            lambda caches, o, p: _core.solve_at_points(prepared.core, positions, directions, o, caches, p),
            lambda caches, c, p, _: _core.estimate_error_at_points(prepared.core, positions, directions, caches, c, p),
        )
    if isinstance(purpose, Everywhere):
        return CacheFunctions(
            lambda caches, o, p: _core.solve_everywhere(prepared.core, o, caches, p),
            lambda caches, c, p, _: _core.estimate_error_everywhere(prepared.core, SURFACE_POINTS, caches, c, p),
            lambda caches, tables, o, p: _core.solve_radiance_everywhere(prepared.core, tables, o, caches, p),
        )
    views = purpose.views if isinstance(purpose, Views) else (purpose,)
    cameras = [prepared.camera(view.camera, view.size) for view in views]
    # The error of several views is not estimated here: each of their pictures measures its own.
    first = cameras[0]
    return CacheFunctions(
        lambda caches, o, p: _core.solve_for_cameras(prepared.core, cameras, o, caches, p),
        lambda caches, c, p, tables: _core.estimate_error_for_camera(prepared.core, first, caches, c, p, tables),
        lambda caches, tables, o, p: _core.solve_radiance_for_cameras(prepared.core, cameras, tables, o, caches, p),
        estimates_gloss=True,
    )
