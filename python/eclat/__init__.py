# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Éclat: global illumination by irradiance caching, beside an unbiased path tracer."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from eclat.baking import bake
    from eclat.errors import EclatError, EclatWarning
    from eclat.images.image import Image
    from eclat.lightmap.lightmap import Lightmap
    from eclat.loaders import load, load_dict
    from eclat.options import METHODS, Direct, IrradianceCache, Path, PhotonMap, RadianceCache, Radiosity
    from eclat.photons import Photons
    from eclat.point_irradiance import irradiance
    from eclat.radiosity import RadiositySolution, load_solved
    from eclat.rendering import render
    from eclat.scene import Scene
    from eclat.solution import Solution, merge
    from eclat.solving import refine, solve
    from eclat.stage.material_overrides import override_materials

_HOMES = {
    "load": "eclat.loaders",
    "load_dict": "eclat.loaders",
    "override_materials": "eclat.stage.material_overrides",
    "solve": "eclat.solving",
    "refine": "eclat.solving",
    "render": "eclat.rendering",
    "irradiance": "eclat.point_irradiance",
    "bake": "eclat.baking",
    "Lightmap": "eclat.lightmap.lightmap",
    "Solution": "eclat.solution",
    "merge": "eclat.solution",
    "Direct": "eclat.options",
    "Path": "eclat.options",
    "IrradianceCache": "eclat.options",
    "PhotonMap": "eclat.options",
    "Photons": "eclat.photons",
    "RadianceCache": "eclat.options",
    "Radiosity": "eclat.options",
    "RadiositySolution": "eclat.radiosity",
    "load_solved": "eclat.radiosity",
    "METHODS": "eclat.options",
    "Image": "eclat.images.image",
    "Scene": "eclat.scene",
    "EclatError": "eclat.errors",
    "EclatWarning": "eclat.errors",
}
"""Name → module: imported when first used, so that `eclat --help` need not load the core."""

__all__ = [
    "METHODS",
    "Direct",
    "EclatError",
    "EclatWarning",
    "Image",
    "IrradianceCache",
    "Lightmap",
    "Path",
    "PhotonMap",
    "Photons",
    "RadianceCache",
    "Radiosity",
    "RadiositySolution",
    "Scene",
    "Solution",
    "bake",
    "irradiance",
    "load",
    "load_dict",
    "load_solved",
    "merge",
    "override_materials",
    "refine",
    "render",
    "solve",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'eclat' has no attribute {name!r}")
    return getattr(importlib.import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
