# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Radiance caching: records of light by direction for glossy surfaces, beside those of irradiance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from eclat.methods.irradiance_cache import IrradianceCache
from eclat.methods.records.options import RadianceOptions


@dataclass(frozen=True)
class RadianceCache(RadianceOptions, IrradianceCache):
    """Radiance caching: irradiance caching for diffuse surfaces, and records of light by direction for glossy ones.
    Sharp reflections are traced.

    Records of radiance are made for views and for all surfaces; for points, which have no lobes, only records of
    irradiance are made.
    """

    name: ClassVar[str] = "radiance-cache"
    cannot: ClassVar[str] = (
        "Lobes sharper than the harmonics of its order are traced, with noise. Indirect shadows narrower than a record's "
        "radius, and reflections of what is smaller than a lobe, are blurred. Caustics of small lamps are met by chance, "
        "those of point, spot and directional lights are missing."
    )
