# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Convert MTL materials to materials of Éclat.

MTL describes the illumination models of the 1990s, which are not physical. The table below says which material each
combination of statements becomes. Colours in the file are linear numbers, and colour images are sRGB. Each value is
multiplied by its map: Kd by map_Kd and so on. All surfaces are two-sided, and they emit (Ke) on the side that the
normal points to.

=================================  ====================================================================================
Statements in the file             Material
=================================  ====================================================================================
illum 4, 6 or 7                    A solid is a `dielectric` with refractive index Ni. It is smooth, or with Pr it is
                                   rough with GGX α = Pr². Each of its surfaces transmits √Tf, so light that enters and
                                   leaves is multiplied by Tf. Kd, Ks and d are ignored, because the Fresnel equations
                                   determine the reflectance. A sheet that encloses no volume stands for a whole pane:
                                   it is a `thin_dielectric`, or a thin `metallic_roughness` if it is rough, and it
                                   transmits Tf. With Ni between 1.3 and 1.38 (illum 6 or 7), however, a sheet is the
                                   surface of water in a container, and it is a `dielectric` too.
illum 9                            `thin_dielectric` that transmits Tf
illum 4, 6, 7 or 9, if nothing     An opaque material, as if illum were absent, because Maya writes illum 4 for opaque
else in the file suggests glass    materials. The following suggest glass: an Ni other than 1; d < 1 or Tr > 0, if Ni is
                                   absent; a Tf that is neither black nor white. For illum 6, 7 and 9, which the format
                                   defines as refracting, the absence of all of Ni, d and Tr suggests glass too.
illum 5; illum 3 with Ns ≥ 1000    A perfect mirror of reflectance Ks, blended with a diffuse material of reflectance Kd
                                   if Kd is at least 2 %. Exporters write smaller values for black.
Pr, Pm, map_Pr or map_Pm           `metallic_roughness` with base colour Kd, GGX α = Pr² and refractive index Ni. If
                                   both maps are the same image, its green channel is the roughness and its blue
                                   channel is the metalness, as in glTF.
illum 0 or 1, or Ks = 0            `diffuse` with reflectance Kd
anything else                      `phong` with reflectances Kd and Ks and exponent Ns
=================================  ====================================================================================

Some exporters write the value 0 beside a map, although the product of both would be 0. If Kd, Ke, Pr, Pm, Ns or d is
0 and has a map, the map is therefore used alone, with a warning. A black Ks keeps the material diffuse, also with a
warning, because the file does not say how much a specular map should reflect in addition to Kd.

If Kd + Ks exceeds 1, the surface would reflect more light than it receives, so both are scaled down, with a warning.
For materials other than glass, d (or 1 − Tr) is the opacity: the probability that a ray hits the surface.

The white texels of a bump map have a height of 1 % of the texture's width on the surface, multiplied by -bm. For
photographs of stone and brick this height gives slopes of about 0.3.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from eclat.errors import warn
from eclat.loaders.mtl import Entry, Library, Map, color, find_entry, number, read_map, texture_map
from eclat.scene import Material, NormalMap, Texture, Value, grey

Color = tuple[float, float, float]

_MIRROR_EXPONENT = 1000.0
"""The Phong exponent (Ns) from which illum 3 is read as a perfect mirror. It is the largest exponent that the format
uses."""
_BLACK = 0.02
"""The diffuse reflectance below which a mirror has no diffuse part: exporters write such values for black."""
_SAME_INDEX = 1e-3
"""The largest difference from 1 at which a refractive index counts as that of air."""
_LIQUIDS = (1.3, 1.38)
"""The range of refractive indices of water and watery solutions. Window glass and its plastics start at 1.46, so a
pane has no index in this range."""
_BUMP_HEIGHT = 0.01
"""The height of a bump map's white texel, as a fraction of the texture's width on the surface (tuned: photographs of
stone and brick get slopes of about 0.3)."""
_CHANNELS = {"r": 0, "g": 1, "b": 2, "m": 3}
"""The image channel that each argument of the option -imfchan selects. The matte, "m", is the alpha channel."""


@dataclass(frozen=True)
class MtlMaterial:
    """A material, and the material that replaces it on sheets that enclose no volume (None if it is the same)."""

    material: Material
    sheet: Material | None = None


def build_material(library: Library, name: str) -> MtlMaterial | None:
    """Build the material called `name` and read its textures.

    Returns
    -------
    The material, or None, with a warning, if no MTL file defines it. The `scale` of its bump map is a fraction of the
    texture's width; the caller multiplies it by that width in metres.

    Raises
    ------
    EclatError : a texture statement is malformed.
    """
    entry = find_entry(library, name)
    if entry is None:
        return None
    found = number(entry, "illum")
    illum = 2.0 if found is None else found
    glass = illum in (4, 6, 7, 9) and _is_glass(entry, illum)
    common = Material(
        name=name,
        opacity=_opacity(library, entry, solid=not glass),
        normal_map=_normal_map(library, entry),
        emission=_emission(library, entry),
    )
    if glass:
        return _glass(entry, common, illum)
    _warn_of_ambient_map(entry)
    if any(key in entry.statements for key in ("pr", "pm", "map_pr", "map_pm")):
        return MtlMaterial(_physical(library, entry, common))
    diffuse, specular = _lobes(library, entry)
    exponent = number(entry, "ns")
    if illum == 5 or (illum == 3 and exponent is not None and exponent >= _MIRROR_EXPONENT):
        return MtlMaterial(_mirror(common, diffuse, specular))
    if illum < 2 or not any(specular.constant):
        return MtlMaterial(replace(common, kind="diffuse", parameters={"reflectance": diffuse}))
    parameters = {"diffuse_reflectance": diffuse, "specular_reflectance": specular}
    # Exporters that write map_Ns without Ns expect white texels to have the largest exponent.
    usual = _MIRROR_EXPONENT if "map_ns" in entry.statements else 30.0
    parameters["exponent"] = _scalar(library, entry, "map_ns", usual if exponent is None else exponent)
    return MtlMaterial(replace(common, kind="phong", parameters=parameters))


def _warn_of_ambient_map(entry: Entry) -> None:
    """Warn that the image of map_Ka is ignored, unless map_Kd is given too: most exporters write the same image in both."""
    if "map_ka" in entry.statements and "map_kd" not in entry.statements:
        warn(
            f"{entry.where('map_ka')}: map_Ka is ignored, because it describes ambient light, and there is no map_Kd; if "
            "the image shows the colours of the surface, name it in map_Kd"
        )


def _lobes(library: Library, entry: Entry) -> tuple[Value, Value]:
    """Return the diffuse and the specular reflectance, scaled down with a warning if they add up to more than 1."""
    illum = number(entry, "illum")
    diffuse, specular = _kd(library, entry), grey(0)
    if illum is None or illum >= 2:
        specular = _color(library, entry, "ks", 1.0 if "map_ks" in entry.statements else 0.0)
    if illum == 5 and not {"ks", "map_ks"} & entry.statements.keys():
        specular = grey(1)
        diffuse = grey(0) if "kd" not in entry.statements else diffuse
    most = max(a + b for a, b in zip(diffuse.constant, specular.constant, strict=True))
    if most > 1 + 1e-6:
        warn(
            f"{entry.path.name}, material {entry.name!r}: Kd + Ks is {most:g}, expected at most 1; "
            "both are divided by this sum"
        )
        diffuse, specular = _scaled(diffuse, 1 / most), _scaled(specular, 1 / most)
    return diffuse, specular


def _kd(library: Library, entry: Entry) -> Value:
    return _color(library, entry, "kd", 1.0 if "map_kd" in entry.statements else 0.5)


def _scaled(value: Value, factor: float) -> Value:
    r, g, b = value.constant
    return replace(value, constant=(r * factor, g * factor, b * factor))


def _mirror(common: Material, diffuse: Value, specular: Value) -> Material:
    """Return a mirror and a diffuse material in a blend.

    A blend multiplies each material by its weight. The reflectances are divided by the weights here, so that the
    blend reflects `diffuse` plus `specular`.
    """
    parameters = {"eta": grey(0), "k": grey(1), "alpha_u": grey(0)}
    kd, ks = max(diffuse.constant), max(specular.constant)
    if kd < _BLACK:
        return replace(common, kind="conductor", parameters=parameters | {"specular_reflectance": specular})
    if ks == 0:
        return replace(common, kind="diffuse", parameters={"reflectance": diffuse})
    # The largest components of both may belong to different channels, so their sum may exceed 1 although no
    # channel's does.
    total = max(1.0, kd + ks)
    weight = ks / (kd + ks)
    base = Material("diffuse", {"reflectance": _scaled(diffuse, 1 / total / (1 - weight))}, name=common.name)
    polish = {"specular_reflectance": _scaled(specular, 1 / total / weight)}
    mirror = Material("conductor", parameters | polish, name=common.name)
    return replace(common, kind="blend", parameters={"weight": grey(weight)}, children=(base, mirror))


def _is_glass(entry: Entry, illum: float) -> bool:
    """Return whether the material is glass, as far as one can tell from the statements besides illum (see the module)."""
    ior, d, tr = (number(entry, key) for key in ("ni", "d", "tr"))
    if ior is not None and abs(ior - 1) > _SAME_INDEX:
        return True
    filtered = color(entry, "tf")
    filters = filtered is not None and max(filtered) > 0 and min(filtered) < 1
    clear = (d is not None and d < 1) or (d is None and tr is not None and tr > 0)
    if ior is None and d is None and tr is None:
        return illum != 4 or filters
    # With an index of 1 and without a filter, glass would be invisible. A d below 1 then means the opacity.
    return filters or (clear and ior is None)


def _glass(entry: Entry, common: Material, illum: float) -> MtlMaterial:
    if "map_kd" in entry.statements:
        warn(f"{entry.where('map_kd')}: map_Kd is ignored, because this material is glass (illum {illum:g})")
    ior = number(entry, "ni")
    if ior is not None and not 0.1 <= ior <= 10:
        warn(f"{entry.where('ni')}: expected a refractive index (Ni) in 0.1..10, got {ior:g}; 1.5 is used instead")
        ior = None
    filtered = tuple(min(c, 1.0) for c in color(entry, "tf") or (1.0, 1.0, 1.0))
    shared = {"ior": grey(1.5 if ior is None else ior)}
    whole = {"specular_transmittance": Value((filtered[0], filtered[1], filtered[2]))}
    pane = replace(common, kind="thin_dielectric", parameters=shared | whole)
    if illum == 9:
        return MtlMaterial(pane)
    r, g, b = (math.sqrt(c) for c in filtered)
    parameters = shared | {"specular_transmittance": Value((r, g, b))}
    roughness = number(entry, "pr", most=1.0)
    if roughness:
        parameters["alpha_u"] = grey(roughness**2)
        frosted = {"base_color": whole["specular_transmittance"], "roughness": grey(roughness**2)}
        frosted |= {"transmission": grey(1.0), "ior": shared["ior"]}
        pane = replace(common, kind="metallic_roughness", parameters=frosted, thin_walled=True)
    low, high = _LIQUIDS
    liquid = illum != 4 and ior is not None and low <= ior <= high
    return MtlMaterial(replace(common, kind="dielectric", parameters=parameters), None if liquid else pane)


def _physical(library: Library, entry: Entry, common: Material) -> Material:
    rough_map, metal_map = texture_map(entry, "map_pr"), texture_map(entry, "map_pm")
    packed = rough_map is not None and metal_map is not None and rough_map.name == metal_map.name
    roughness, metallic = number(entry, "pr", most=1.0), number(entry, "pm", most=1.0)
    base = _kd(library, entry)
    if max(base.constant) > 1:
        warn(
            f"{entry.path.name}, material {entry.name!r}: expected Kd in 0..1, got {max(base.constant):g}; "
            "Kd is divided by this value"
        )
        base = _scaled(base, 1 / max(base.constant))
    rough = _scalar(
        library, entry, "map_pr", (1.0 if rough_map else 0.5) if roughness is None else roughness, 1 if packed else None
    )
    metal = _scalar(
        library, entry, "map_pm", (1.0 if metal_map else 0.0) if metallic is None else metallic, 2 if packed else None
    )
    parameters = {"base_color": base, "roughness": replace(rough, square=True), "metallic": metal}
    ior = number(entry, "ni")
    if ior is not None and 1 < ior <= 10:
        parameters["ior"] = grey(ior)
    return replace(common, kind="metallic_roughness", parameters=parameters)


def _emission(library: Library, entry: Entry) -> Value | None:
    emission = _color(library, entry, "ke", 1.0 if "map_ke" in entry.statements else 0.0)
    return emission if any(emission.constant) else None


def _opacity(library: Library, entry: Entry, *, solid: bool) -> Value:
    """Return the opacity: d, or without d 1 − Tr, multiplied by map_d or by 1 − map_Tr.

    If the material is not `solid`, it is glass. Only the map counts then, because d describes how clear the glass is.
    """
    opacity = 1.0
    d, tr = (number(entry, key, most=1.0) if solid else None for key in ("d", "tr"))
    if d is not None:
        opacity = d
    elif tr is not None:
        opacity = 1 - tr
        if opacity == 0:
            warn(
                f"{entry.where('tr')}: Tr is 1 and d is missing, which would make the surface invisible; the surface "
                "is made opaque, because some exporters write the opacity as Tr"
            )
            opacity = 1.0
    key = "map_d" if "map_d" in entry.statements else "map_tr"
    found = texture_map(entry, key)
    if opacity == 0 and found is not None:
        _warn_hidden(entry, "d")
        opacity = 1.0
    elif opacity == 0:
        warn(f"{entry.path.name}, material {entry.name!r}: d is 0, so its surfaces are invisible")
    if found is None:
        return grey(opacity)
    texture = read_map(library, entry, key, found, srgb=False)
    color_map = texture_map(entry, "map_kd")
    shared = color_map is not None and color_map.name == found.name
    channel = _channel(found, texture)
    if texture.image.shape[2] == 4 and not found.channel and (shared or _varies(texture.image[..., 3])):
        channel = 3
    return Value((opacity,) * 3, texture, channel, uv_transform=found.uv_transform, invert=key == "map_tr")


def _varies(channel: np.ndarray) -> bool:
    return bool(channel.min() != channel.max())


def _normal_map(library: Library, entry: Entry) -> NormalMap | None:
    key = "norm" if "norm" in entry.statements else "map_bump"
    found = texture_map(entry, key)
    if found is None:
        return None
    flat = (0.5, 0.5, 1.0)
    texture = read_map(library, entry, key, found, srgb=False)
    is_normal = key == "norm"
    if not is_normal and _looks_like_normals(texture):
        warn(f"{entry.where(key)}: the bump map {found.name!r} looks like a normal map and is used as one")
        is_normal = True
    value = Value((1.0, 1.0, 1.0), texture, uv_transform=found.uv_transform)
    if is_normal:
        if texture.image.shape[2] < 3 or texture.image.size == len(flat):
            return None
        return NormalMap(value, "normal", found.bump_multiplier)
    return NormalMap(replace(value, channel=_channel(found, texture)), "bump", _BUMP_HEIGHT * found.bump_multiplier)


def _looks_like_normals(texture: Texture) -> bool:
    """Return whether the average colour of the image is close to (0.5, 0.5, 1), as in normal maps and never in height
    maps.
    """
    if texture.image.shape[2] < 3 or texture.image.shape[:2] == (1, 1):
        return False
    r, g, b = (float(c) for c in texture.image[..., :3].reshape(-1, 3).mean(axis=0, dtype=np.float64))
    white = 255.0 if texture.image.dtype == np.uint8 else 1.0
    return abs(r / white - 0.5) < 0.1 and abs(g / white - 0.5) < 0.1 and b / white > 0.75


def _color(library: Library, entry: Entry, key: str, default: float) -> Value:
    """Return the colour of the statement `key`, or `default`, multiplied by its map."""
    constant = color(entry, key) or (default, default, default)
    found = texture_map(entry, f"map_{key}")
    if found is None:
        return Value(constant)
    if not any(constant) and key == "ks":
        warn(f"{entry.where(f'map_{key}')}: map_Ks is ignored, because Ks is black; the material is diffuse")
        return Value(constant)
    if not any(constant):
        _warn_hidden(entry, key)
        constant = (1.0, 1.0, 1.0)
    texture = read_map(library, entry, f"map_{key}", found, srgb=True)
    channel = 0 if texture.image.shape[2] == 1 else _CHANNELS.get(found.channel)
    return Value(constant, texture, channel, uv_transform=found.uv_transform)


def _warn_hidden(entry: Entry, key: str) -> None:
    name = "d" if key == "d" else key.capitalize()
    place = entry.where(key) if key in entry.statements else f"{entry.path.name}, material {entry.name!r}"
    warn(f"{place}: {name} is 0, and its product with its map would be 0; the map is used alone")


def _scalar(library: Library, entry: Entry, key: str, constant: float, channel: int | None = None) -> Value:
    """Return the number `constant`, multiplied by the map of the statement `key`."""
    found = texture_map(entry, key)
    if found is None:
        return grey(constant)
    if constant == 0:
        _warn_hidden(entry, key.removeprefix("map_"))
        constant = _MIRROR_EXPONENT if key == "map_ns" else 1.0
    texture = read_map(library, entry, key, found, srgb=False)
    if channel is None or channel >= texture.image.shape[2]:
        channel = _channel(found, texture)
    return Value((constant,) * 3, texture, channel, uv_transform=found.uv_transform)


def _channel(found: Map, texture: Texture) -> int:
    """Return the number of the image channel that the option -imfchan selects, or 0 if the image does not have it."""
    channel = _CHANNELS.get(found.channel, 0)
    return channel if channel < texture.image.shape[2] else 0
