# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Lux from irradiance."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

LUMENS_PER_WATT = 179.0
"""Luminous efficacy of white light in a radiometric scene, lm/W; Radiance uses the same."""

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Y of linear RGB with Rec. 709 primaries [ITU-R BT.709, item 3.2]."""


def luminance(rgb: ArrayLike) -> NDArray[np.float64]:
    """Y of linear RGB (…, 3), in double."""
    return np.asarray(np.asarray(rgb, dtype=np.float64) @ LUMINANCE)


def illuminance(irradiance: ArrayLike, photometric: bool) -> NDArray[np.float64]:
    """(N,) lux of (N, 3) RGB irradiance.

    A photometric scene (`Scene.photometric`) keeps candela, lux and cd·m⁻² as its file gives them, never divided by
    683 lm/W: its RGB is weighted by the eye already, and lux is its luminance Y. (Dividing on the way in and
    multiplying by 683 on the way out would be the same.) In a radiometric one RGB is in W·m⁻² of visible light, and
    each W·m⁻² of Y counts as `LUMENS_PER_WATT`, the efficacy of white light that Radiance uses too.
    """
    return luminance(irradiance) * (1 if photometric else LUMENS_PER_WATT)
