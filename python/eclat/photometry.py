# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Lux from irradiance."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from eclat.sky import LUMENS_PER_WATT

LUMINANCE = (0.2126, 0.7152, 0.0722)
"""Y of linear RGB with Rec. 709 primaries [ITU-R BT.709, item 3.2]."""


def illuminance(irradiance: ArrayLike, photometric: bool) -> NDArray[np.float64]:
    """(N,) lux of (N, 3) RGB irradiance.

    In a photometric scene lights are in candela, so that RGB is in lux already and only its luminance is taken;
    in a radiometric one each W·m⁻² counts as `LUMENS_PER_WATT`, the efficacy of white light that Radiance uses too.
    """
    luminance = np.asarray(irradiance, dtype=np.float64) @ np.array(LUMINANCE)
    return np.asarray(luminance if photometric else LUMENS_PER_WATT * luminance)
