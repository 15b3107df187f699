# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The method `radiance-cache`, which adds to irradiance caching records of the light from all directions, for glossy
surfaces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from eclat.methods.irradiance_cache import IrradianceCache
from eclat.methods.records.options import RadianceOptions


@dataclass(frozen=True)
class RadianceCache(RadianceOptions, IrradianceCache):
    """Radiance caching: irradiance caching for diffuse surfaces, and records of radiance from all directions for glossy
    surfaces. Sharp reflections are traced.

    Records of radiance are made for views and for all surfaces. For points, which have no glossy lobes, only records of
    irradiance are made.
    """

    name: ClassVar[str] = "radiance-cache"
    cannot: ClassVar[str] = (
        "Lobes that are too sharp for harmonics of the chosen order are traced, with noise. Indirect shadows that are narrower "
        "than the radius of a record, and reflections of details that are smaller than a lobe, are blurred. Caustics of small "
        "lamps are found only by chance, and those of point, spot and directional lights are missing."
    )
