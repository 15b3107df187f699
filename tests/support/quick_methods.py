# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Every method with settings for scenes of a few triangles, in which each is done within a second."""

from __future__ import annotations

import eclat

QUICK: dict[str, eclat.Method] = {
    "direct": eclat.Direct(),
    "path": eclat.Path(),
    "irradiance-cache": eclat.IrradianceCache(max_error=0.1),
    "radiance-cache": eclat.RadianceCache(max_error=0.1),
    "photon-map": eclat.PhotonMap(photons=20_000, caustic_photons=1000),
    "radiosity": eclat.Radiosity(patches=300),
}
GLOBAL = [name for name in QUICK if name != "direct"]
"""The methods that compute indirect light."""
