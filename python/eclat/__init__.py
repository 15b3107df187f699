# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Éclat: global illumination by irradiance caching and other methods, with an unbiased path tracer as the reference."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from eclat.errors import EclatError, EclatWarning
    from eclat.farm.farm import Farm
    from eclat.images.image import Image
    from eclat.images.mixing import mix
    from eclat.instruction_set import use_instruction_set
    from eclat.lightmap.lightmap import Lightmap
    from eclat.loaders import load, load_dict
    from eclat.loaders.brdf_files import load_brdf
    from eclat.loaders.ies import load_ies
    from eclat.methods import (
        METHODS,
        Direct,
        IrradianceCache,
        Method,
        Path,
        PhotonMap,
        RadianceCache,
        Radiosity,
        Solved,
        load_solved,
        merge,
    )
    from eclat.methods.photon_map import Photons
    from eclat.methods.radiosity import RadiositySolution
    from eclat.methods.records.solution import Solution
    from eclat.motion.camera_path import with_camera_path
    from eclat.probe_grid.grid import ProbeGrid
    from eclat.scene import Scene
    from eclat.stage.light_groups import light_groups
    from eclat.stage.light_overrides import override_lights
    from eclat.stage.material_overrides import override_materials
    from eclat.tev.display import Display
    from eclat.verbs.animate import animate
    from eclat.verbs.bake import bake
    from eclat.verbs.compare import compare
    from eclat.verbs.denoise import denoise
    from eclat.verbs.estimate_bake import BakeEstimate, estimate_bake
    from eclat.verbs.irradiance import irradiance
    from eclat.verbs.merge_pictures import merge_pictures
    from eclat.verbs.probes import probes
    from eclat.verbs.render import render
    from eclat.verbs.solve import refine, solve
    from eclat.viewer.showing import Viewer, export_view, view

_HOMES = {
    "load": "eclat.loaders",
    "load_dict": "eclat.loaders",
    "with_camera_path": "eclat.motion.camera_path",
    "load_brdf": "eclat.loaders.brdf_files",
    "load_ies": "eclat.loaders.ies",
    "override_lights": "eclat.stage.light_overrides",
    "override_materials": "eclat.stage.material_overrides",
    "solve": "eclat.verbs.solve",
    "refine": "eclat.verbs.solve",
    "render": "eclat.verbs.render",
    "irradiance": "eclat.verbs.irradiance",
    "bake": "eclat.verbs.bake",
    "BakeEstimate": "eclat.verbs.estimate_bake",
    "estimate_bake": "eclat.verbs.estimate_bake",
    "animate": "eclat.verbs.animate",
    "Farm": "eclat.farm.farm",
    "probes": "eclat.verbs.probes",
    "compare": "eclat.verbs.compare",
    "denoise": "eclat.verbs.denoise",
    "view": "eclat.viewer.showing",
    "export_view": "eclat.viewer.showing",
    "Viewer": "eclat.viewer.showing",
    "METHODS": "eclat.methods",
    "Method": "eclat.methods",
    "Solved": "eclat.methods",
    "Direct": "eclat.methods",
    "Path": "eclat.methods",
    "IrradianceCache": "eclat.methods",
    "RadianceCache": "eclat.methods",
    "PhotonMap": "eclat.methods",
    "Radiosity": "eclat.methods",
    "load_solved": "eclat.methods",
    "merge": "eclat.methods",
    "Solution": "eclat.methods.records.solution",
    "Photons": "eclat.methods.photon_map",
    "RadiositySolution": "eclat.methods.radiosity",
    "Lightmap": "eclat.lightmap.lightmap",
    "ProbeGrid": "eclat.probe_grid.grid",
    "Display": "eclat.tev.display",
    "Image": "eclat.images.image",
    "mix": "eclat.images.mixing",
    "merge_pictures": "eclat.verbs.merge_pictures",
    "light_groups": "eclat.stage.light_groups",
    "Scene": "eclat.scene",
    "EclatError": "eclat.errors",
    "EclatWarning": "eclat.errors",
    "use_instruction_set": "eclat.instruction_set",
}
"""Maps public names to their modules, which are imported when a name is first used, so that `eclat --help` does not
load the core."""

__all__ = [
    "METHODS",
    "BakeEstimate",
    "Direct",
    "Display",
    "EclatError",
    "EclatWarning",
    "Farm",
    "Image",
    "IrradianceCache",
    "Lightmap",
    "Method",
    "Path",
    "PhotonMap",
    "Photons",
    "ProbeGrid",
    "RadianceCache",
    "Radiosity",
    "RadiositySolution",
    "Scene",
    "Solution",
    "Solved",
    "Viewer",
    "animate",
    "bake",
    "compare",
    "denoise",
    "estimate_bake",
    "export_view",
    "irradiance",
    "light_groups",
    "load",
    "load_brdf",
    "load_dict",
    "load_ies",
    "load_solved",
    "merge",
    "merge_pictures",
    "mix",
    "override_lights",
    "override_materials",
    "probes",
    "refine",
    "render",
    "solve",
    "use_instruction_set",
    "view",
    "with_camera_path",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'eclat' has no attribute {name!r}")
    return getattr(importlib.import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
