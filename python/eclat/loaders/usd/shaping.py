# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The cones and the focus of lights [UsdLuxShapingAPI].

Symbol  name here  meaning
  θ     angle      the angle from the axis of the light, which is −z of its prim
  θc    cutoff     shaping:cone:angle; no light goes further from the axis
  s     softness   shaping:cone:softness: the luminance begins to fall at θc (1 − s), by a smooth step
  f     focus      shaping:focus: the luminance is multiplied by cosᶠ θ
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eclat.errors import EclatError
from eclat.intensity_profile import IntensityProfile
from eclat.loaders.usd.stages import Stage, pxr

SAMPLES = 129
"""The number of angles of a profile within its cone. A smooth step between them is linear, with an error below 0.01 %."""
_EDGE = 1e-3
"""The width in degrees of an edge where a profile jumps to 0."""


@dataclass(frozen=True)
class Shaping:
    """How the luminance of a light depends on the direction; angles are in degrees."""

    cutoff: float = 180.0
    softness: float = 0.0
    focus: float = 0.0

    @property
    def is_even(self) -> bool:
        """Whether the luminance is the same in all directions."""
        return self.cutoff >= 180 and self.focus == 0

    @property
    def is_hard_cone(self) -> bool:
        """Whether the luminance is the same in a cone and 0 outside of it."""
        return self.softness == 0 and self.focus == 0

    def factor(self, angle: ArrayLike) -> NDArray[np.float64]:
        """Return what the luminance is multiplied by at the angles `angle` from the axis, in degrees."""
        degrees = np.asarray(angle, dtype=np.float64)
        start = self.cutoff * (1 - self.softness)
        ramp = np.clip((degrees - start) / max(self.cutoff - start, 1e-12), 0, 1)
        step = 1 - ramp * ramp * (3 - 2 * ramp)
        cosine = np.maximum(np.cos(np.radians(degrees)), 0) if self.focus > 0 else np.ones_like(degrees)
        return np.where(degrees <= self.cutoff, step * cosine**self.focus, 0)

    def profile(self, name: str) -> IntensityProfile:
        """Return the profile of a small sphere with this shaping, with 1 candela where the factor is 1."""
        inside = np.linspace(0, min(self.cutoff, 180), SAMPLES)
        values = self.factor(inside)
        if self.cutoff + _EDGE < 180:
            inside, values = np.append(inside, self.cutoff + _EDGE), np.append(values, 0)
        return IntensityProfile("C", inside, [0], values[None, :], name)


def read_shaping(stage: Stage, prim: Any) -> Shaping:
    """Read the shaping of a light, which is even for lights that are not shaped. Raises EclatError if a number is invalid."""
    lux = pxr("UsdLux")
    if not prim.HasAPI(lux.ShapingAPI):
        return Shaping()
    api = lux.ShapingAPI(prim)
    cutoff = stage.number(api.GetShapingConeAngleAttr(), 90.0)
    softness = stage.number(api.GetShapingConeSoftnessAttr(), 0.0)
    focus = stage.number(api.GetShapingFocusAttr(), 0.0)
    if cutoff <= 0 or softness < 0 or focus < 0:
        raise EclatError(
            f"{stage.where(prim)}: expected a cone angle above 0, and a softness and a focus of at least 0, "
            f"got {cutoff:g}, {softness:g} and {focus:g}"
        )
    if str(getattr(stage.value(api.GetShapingIesFileAttr()), "path", "") or ""):
        stage.once(
            "ies", "the IES profiles of UsdLux lights are not supported and are ignored; --ies gives a light a profile"
        )
    return Shaping(cutoff, softness, focus)
