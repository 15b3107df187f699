# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The methods, which are the ways to compute light. Each method is a module of this folder; this module registers all
of them."""

from __future__ import annotations

from eclat.methods.choosing import as_method, make_options
from eclat.methods.direct import Direct
from eclat.methods.irradiance_cache import IrradianceCache
from eclat.methods.method import (
    METHODS,
    Method,
    Prepared,
    Solved,
    Source,
    load_solved,
    merge,
    register,
)
from eclat.methods.path import Path
from eclat.methods.photon_map import PhotonMap
from eclat.methods.radiance_cache import RadianceCache
from eclat.methods.radiosity import Radiosity

for _method in (Direct, Path, IrradianceCache, RadianceCache, PhotonMap, Radiosity):
    register(_method)

DEFAULT_METHOD = IrradianceCache.name
"""Name of the method that all verbs use if none is given."""

__all__ = [
    "DEFAULT_METHOD",
    "METHODS",
    "Direct",
    "IrradianceCache",
    "Method",
    "Path",
    "PhotonMap",
    "Prepared",
    "RadianceCache",
    "Radiosity",
    "Solved",
    "Source",
    "as_method",
    "load_solved",
    "make_options",
    "merge",
    "register",
]
