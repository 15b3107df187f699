# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The photons of one map, whose paths the workers of a farm share if its block is entered."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from eclat import _core
from eclat.bridge.compiled import compiled
from eclat.bridge.running import run
from eclat.farm.farm import current_farm
from eclat.farm.shared_work import Share, SharedWork, Sharing, Tell
from eclat.methods.work import Work
from eclat.scene import Scene

MOST_PATHS = 1 << 20
"""Largest number of paths that are emitted for a map, in addition to `PATHS_PER_PHOTON` paths per wanted photon."""

PATHS_PER_PHOTON = 64
"""Largest number of paths that are emitted per wanted photon."""


@dataclass(frozen=True)
class PhotonRequest:
    """What is wanted of a map: whether it is the caustic or the global one, the number of photons, the greatest number of edges
    of their paths (-1 sets no limit), and whether a guide first learns where to emit.
    """

    caustic: bool
    wanted: int
    max_edges: int
    guided: bool

    def core_options(self, work: Work) -> _core.PhotonTracing:
        """Convert the request to the compiled core."""
        tracing = _core.PhotonTracing()
        tracing.caustic, tracing.photons = self.caustic, self.wanted
        tracing.most_paths = MOST_PATHS + PATHS_PER_PHOTON * self.wanted
        tracing.max_edges, tracing.guided = self.max_edges, self.guided
        tracing.seed, tracing.threads = work.seed, work.threads
        return tracing


@dataclass(frozen=True, eq=False)
class SharedTracing(SharedWork):
    """The paths of a map, which several processes trace."""

    scene: Scene
    request: PhotonRequest
    work: Work

    def follow(self, share: Share, tell: Tell, threads: int) -> None:
        tracing = self.request.core_options(replace(self.work, threads=threads))
        tracing.share_work(share, tell)
        _core.trace_photons(compiled(self.scene).core, tracing, _core.Progress())


def trace_photons(
    scene: Scene, request: PhotonRequest, phase: str, work: Work, counted: _core.Progress
) -> tuple[np.ndarray, int]:
    """Trace the photons of a map, here or on the farm whose block is entered.

    Returns
    -------
    The photons as an array (N, 13) float32 in the coordinates of the core, and the number of paths that were emitted.
    """
    tracing = request.core_options(work)
    if (farm := current_farm()) is not None:
        sharing = Sharing(farm, SharedTracing(scene, request, replace(work, progress=None, threads=0)))
        tracing.share_work(sharing.share, sharing.tell)
    core = compiled(scene).core
    photons, paths = run(phase, lambda p: _core.trace_photons(core, tracing, p), work.progress, counted)
    return photons, paths
