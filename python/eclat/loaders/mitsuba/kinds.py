# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The types of Mitsuba's plugins by XML tag, and the plugins and properties that are ignored without a warning."""

from __future__ import annotations


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


PLUGINS: dict[str, frozenset[str]] = {
    "shape": _words(
        "obj ply serialized gltf rectangle cube sphere disk cylinder shapegroup instance merge mesh "
        "bsplinecurve linearcurve sdfgrid ellipsoids ellipsoidsmesh hair heightfield"
    ),
    "bsdf": _words(
        "diffuse roughdiffuse conductor roughconductor dielectric thindielectric roughdielectric plastic roughplastic "
        "pplastic phong ward principled principledthin twosided mask bump bumpmap normalmap blendbsdf mixturebsdf "
        "coating roughcoating difftrans hk irawan null measured measured_polarized circular polarizer retarder "
        "merl"
    ),
    "emitter": _words(
        "area point spot directional constant envmap sun sky sunsky directionalarea projector collimated timed_sunsky "
        # IES profiles are an addition of Éclat, because Mitsuba has no plugin for them.
        "ies"
    ),
    "sensor": _words(
        "perspective thinlens orthographic telecentric spherical batch distant irradiancemeter radiancemeter "
        "fluencemeter perspective_rdist"
    ),
    "texture": _words("bitmap checkerboard scale mesh_attribute vertexcolors wireframe gridtexture curvature volume"),
    "spectrum": _words("rgb srgb spectrum uniform d65 blackbody regular irregular rawconstant discrete"),
    "integrator": _words(
        "path direct depth aov moment stokes volpath volpathmis ptracer prb prb_basic prbvolpath direct_projective "
        "prb_projective prb_threepoint bdpt mlt pssmlt erpt ppm sppm photonmapper irrcache adaptive vpl motion ao "
        "field multichannel volpath_simple projective"
    ),
    "sampler": _words("independent stratified multijitter orthogonal ldsampler sobol halton hammersley deterministic"),
    "film": _words("hdrfilm ldrfilm mfilm tiledhdrfilm specfilm"),
    "rfilter": _words("box tent gaussian mitchell catmullrom lanczos"),
    "medium": _words("homogeneous heterogeneous"),
    "phase": _words("isotropic hg rayleigh kkay microflake sggx tabphase blendphase"),
    "volume": _words("gridvolume constvolume"),
    "subsurface": _words("dipole singlescatter"),
}
"""The types of plugins by XML tag. In a dict, the type of an object determines its tag."""

IGNORED_TAGS = ("integrator", "sampler", "film", "rfilter")
"""The tags of objects whose properties are not used, except the size of the film."""

_KEYS = ("bsdf", "emitter", "sensor", "film", "sampler", "integrator", "rfilter", "medium", "texture", "shape")
"""The tags that determine the tag of an object of unknown type if its key in the dict starts with them."""


def tag_of(kind: str, key: str, parent: str) -> str:
    """Determine the XML tag of an object in a dict.

    Parameters
    ----------
    kind : the type of the object.
    key : the key of the object in the dict.
    parent : the XML tag of the object that contains it.

    Returns
    -------
    The tag, or "unknown" if it cannot be determined.
    """
    for tag, names in PLUGINS.items():
        if kind in names:
            return tag
    for tag in _KEYS:
        if key.lower().startswith(tag):
            return tag
    return "bsdf" if parent in ("shape", "bsdf") else "unknown"


SILENT_PROPERTIES = _words(
    "near_clip far_clip shutter_open shutter_close shutter_open_time focus_distance to_world sample_visible samples "
    "sampling_weight specular_sampling_weight specular_sampling_rate diffuse_sampling_rate clearcoat_sampling_rate "
    "main_specular_sampling_rate diffuse_reflectance_sampling_rate spec_trans_sampling_rate intensity_scale "
    "max_smooth_angle collapse strict cache mip_map filter_type max_anisotropy srgb format accel"
)
"""The properties that do not affect the converged image, or that are only read for some types. There is no warning if they
are not used."""
