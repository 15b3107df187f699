# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The settings of the frames of an animation."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from eclat.errors import EclatError
from eclat.images import denoiser

MOST_MOMENTS = 256
MOST_ACCUMULATED = 16


@dataclass(frozen=True)
class FrameSettings:
    """What determines the pictures of all frames, besides the scene and the method."""

    size: tuple[int, int] | None
    samples: int | None
    max_error: float
    max_depth: int
    seed: int
    adaptive: bool | Literal["noise", "denoised"] | None
    denoise: bool | None
    shutter: float
    moments: int
    motion: bool
    accumulate: int = 0

    def checked(self) -> FrameSettings:
        """Return the settings with all choices made. Raises EclatError if one is out of range."""
        if not 0 <= self.shutter <= 1:
            raise EclatError(f"shutter: expected a part of the time between two frames, 0 to 1, got {self.shutter!r}")
        if not 1 <= self.moments <= MOST_MOMENTS:
            raise EclatError(f"moments: expected 1 to {MOST_MOMENTS}, got {self.moments}")
        if not 0 <= self.accumulate <= MOST_ACCUMULATED:
            raise EclatError(f"accumulate: expected 0 to {MOST_ACCUMULATED} frames, got {self.accumulate}")
        denoise = self.denoise
        if denoise is None:
            denoise = denoiser.has_denoiser() and self.samples is None
        return replace(self, denoise=denoise, moments=self.moments if self.shutter > 0 else 1)
