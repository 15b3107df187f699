# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Entrants of the race for tests: without a cache, so that their means are known, and one that is no renderer."""

from __future__ import annotations

import os
from typing import ClassVar

import numpy as np

from eclat.scene import Scene
from harness import luxcore_peer, povray_peer, radiance_peer
from harness.entrant import Picture
from harness.unavailable import UnavailableError


class LuxCorePaths(luxcore_peer.Entrant):
    """LuxCore's path tracer: the exported scene without PhotonGI."""

    unbiased: ClassVar[bool] = True
    cached: ClassVar[bool] = False


class RadianceDirect(radiance_peer.Entrant):
    """Direct light only."""

    def render(self, level: int) -> Picture:
        options = ["-ab", "0", "-ds", "0.05", "-dj", "0.9", "-dt", "0", "-dc", "1"]
        return Picture(self.trace(options), 0.0)


class POVRayDirect(povray_peer.Entrant):
    """Direct light only."""

    radiosity: ClassVar[bool] = False


class Obedient:
    """Draws the level's number; its level 1 raises, its level 2 ends the process, an empty scene is not to its taste."""

    unbiased: ClassVar[bool] = False
    levels = ("draw", "raise", "die")
    version = "1"

    def __init__(self, scene: Scene, size: tuple[int, int], threads: int) -> None:
        if not scene.meshes:
            raise UnavailableError("no meshes")
        self.size = size

    def render(self, level: int) -> Picture:
        if level == 1:
            raise ValueError("as told")
        if level == 2:
            os._exit(7)
        return Picture(np.full((self.size[1], self.size[0], 3), level, np.float32), 0.5)
