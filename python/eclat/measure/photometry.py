# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Photometric quantities: luminance, and illuminance in lux from irradiance."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

LUMENS_PER_WATT = 179.0
"""Luminous efficacy of white light in a radiometric scene, in lm/W; Radiance uses the same value."""

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])
"""Weights of linear RGB with Rec. 709 primaries in the luminance Y [ITU-R BT.709, item 3.2]."""


def luminance(rgb: ArrayLike) -> NDArray[np.float64]:
    """Compute the luminance Y of linear RGB (…, 3) in double precision."""
    return np.asarray(np.asarray(rgb, dtype=np.float64) @ LUMINANCE)


def illuminance(irradiance: ArrayLike, photometric: bool) -> NDArray[np.float64]:
    """Convert RGB irradiance (N, 3) to illuminance (N,) in lux.

    A photometric scene (`Scene.photometric`) keeps the candela, lux and cd·m⁻² of its file, so the illuminance is the
    luminance Y of the RGB values. In a radiometric scene, RGB is in W·m⁻² of visible light, and the illuminance is Y
    times `LUMENS_PER_WATT`.
    """
    return luminance(irradiance) * (1 if photometric else LUMENS_PER_WATT)
