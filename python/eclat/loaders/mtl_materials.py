# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""MTL materials as materials of Éclat: what the format's numbers mean physically.

MTL describes the light models of the 1990s; this table is how they are read here. Colours are linear numbers, colour
images sRGB. Kd is multiplied by map_Kd and so on. All surfaces are two-sided, emission (Ke) is on the normal's side.

=================================  ====================================================================================
in the file                        here
=================================  ====================================================================================
illum 4, 6, 7                      smooth `dielectric` of index Ni; with Pr its GGX α is Pr². Light that crosses both
                                   sides of a body is filtered by Tf once (√Tf at each). Kd, Ks and d have no part in
                                   it: Fresnel's equations say what is reflected. A sheet that encloses no volume is a
                                   whole pane: `thin_dielectric` (rough: thin `metallic_roughness`), filtered by Tf.
                                   Of an index of 1.3 to 1.38 it is the surface of water, between walls that hold it.
illum 9                            `thin_dielectric`, filtered by Tf
the same without a sign of glass   as without illum: opaque. Maya writes illum 4 for whatever is opaque. A sign is an Ni
                                   other than 1, a d below 1 (Tr above 0), or a Tf that filters; for illum 6, 7 and 9,
                                   which the format defines as refracting, also that none of Ni, d and Tr is there
illum 5; illum 3 with Ns ≥ 1000    perfect mirror of reflectance Ks, beside a diffuse part Kd where Kd is 2 % or more
                                   (less is how exporters write black)
Pr, Pm, map_Pr or map_Pm           `metallic_roughness` of base colour Kd, GGX α = Pr², index Ni. If both maps are one
                                   image, green is roughness and blue metalness (as in glTF).
illum 0, 1, or Ks = 0              `diffuse` of reflectance Kd
else                               `phong`: Kd, Ks, exponent Ns
=================================  ====================================================================================

A black Kd or Ke, or a Pr, Pm, Ns or d of 0, beside its map would hide the map, which no file wants that names it:
exporters write what the map replaced. The map counts alone then, with a warning. A black Ks stays black, and it is
said: beside Kd there is no telling how much a specular map of its own should reflect.
Kd + Ks > 1 makes energy: both are scaled, with a warning. Elsewhere d (or 1 − Tr) is the probability that a ray
meets the surface. A bump map's white texel is 1 % of the texture's width on the surface high, times -bm: with
stone and brick photographs this gives slopes of about 0.3.
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
"""The format's largest useful Ns."""
_BLACK = 0.02
_SAME_INDEX = 1e-3
"""An index this close to 1 is that of air."""
_LIQUIDS = (1.3, 1.38)
"""Indices of water and what is dissolved in it; glass and its plastics begin at 1.46, and no pane is made of less."""
_BUMP_HEIGHT = 0.01
_CHANNELS = {"r": 0, "g": 1, "b": 2, "m": 3}


@dataclass(frozen=True)
class MtlMaterial:
    """A material, and the one that replaces it on sheets that enclose no volume, if that differs."""

    material: Material
    sheet: Material | None = None


def build_material(library: Library, name: str) -> MtlMaterial | None:
    """The material called `name`, its textures read; None with a warning where no MTL file has it.

    A bump map's `scale` is in widths of the texture, to be multiplied by that width in metres.

    Raises
    ------
    EclatError : numbers that are malformed, negative or not finite.
    """
    entry = find_entry(library, name)
    if entry is None:
        return None
    illum = number(entry, "illum") or 0.0 if "illum" in entry.statements else 2.0
    glass = illum in (4, 6, 7, 9) and _is_glass(entry, illum)
    common = Material(
        name=name,
        opacity=_opacity(library, entry, solid=not glass),
        normal_map=_normal_map(library, entry),
        emission=_emission(library, entry),
    )
    if glass:
        return _glass(entry, common, illum)
    if any(key in entry.statements for key in ("pr", "pm", "map_pr", "map_pm")):
        return MtlMaterial(_physical(library, entry, common))
    diffuse, specular = _lobes(library, entry)
    exponent = number(entry, "ns")
    if illum == 5 or (illum == 3 and exponent is not None and exponent >= _MIRROR_EXPONENT):
        return MtlMaterial(_mirror(common, diffuse, specular))
    if illum < 2 or not any(specular.constant):
        return MtlMaterial(replace(common, kind="diffuse", parameters={"reflectance": diffuse}))
    parameters = {"diffuse_reflectance": diffuse, "specular_reflectance": specular}
    # Exporters that write map_Ns without Ns mean the whole range of Ns.
    usual = _MIRROR_EXPONENT if "map_ns" in entry.statements else 30.0
    parameters["exponent"] = _scalar(library, entry, "map_ns", usual if exponent is None else exponent)
    return MtlMaterial(replace(common, kind="phong", parameters=parameters))


def _lobes(library: Library, entry: Entry) -> tuple[Value, Value]:
    """Diffuse and specular reflectance, together at most 1."""
    illum = number(entry, "illum")
    diffuse, specular = _kd(library, entry), grey(0)
    if illum is None or illum >= 2:
        specular = _color(library, entry, "ks", 1.0 if "map_ks" in entry.statements else 0.0)
    if illum == 5 and not {"ks", "map_ks"} & entry.statements.keys():
        specular = grey(1)
        diffuse = grey(0) if "kd" not in entry.statements else diffuse
    most = max(a + b for a, b in zip(diffuse.constant, specular.constant, strict=True))
    if most > 1 + 1e-6:
        warn(f"{entry.path.name}, material {entry.name!r}: Kd + Ks reach {most:g}; both are divided by that")
        diffuse, specular = _scaled(diffuse, 1 / most), _scaled(specular, 1 / most)
    return diffuse, specular


def _kd(library: Library, entry: Entry) -> Value:
    return _color(library, entry, "kd", 1.0 if "map_kd" in entry.statements else 0.5)


def _scaled(value: Value, factor: float) -> Value:
    r, g, b = value.constant
    return replace(value, constant=(r * factor, g * factor, b * factor))


def _mirror(common: Material, diffuse: Value, specular: Value) -> Material:
    """Mirror plus diffuse, as a blend whose weights give each its whole reflectance again."""
    parameters = {"eta": grey(0), "k": grey(1), "alpha_u": grey(0)}
    kd, ks = max(diffuse.constant), max(specular.constant)
    if kd < _BLACK:
        return replace(common, kind="conductor", parameters=parameters | {"specular_reflectance": specular})
    if ks == 0:
        return replace(common, kind="diffuse", parameters={"reflectance": diffuse})
    # Their largest components may lie in different channels, so they may add up to more than 1.
    total = max(1.0, kd + ks)
    weight = ks / (kd + ks)
    base = Material("diffuse", {"reflectance": _scaled(diffuse, 1 / total / (1 - weight))}, name=common.name)
    polish = {"specular_reflectance": _scaled(specular, 1 / total / weight)}
    mirror = Material("conductor", parameters | polish, name=common.name)
    return replace(common, kind="blend", parameters={"weight": grey(weight)}, children=(base, mirror))


def _is_glass(entry: Entry, illum: float) -> bool:
    """Whether anything besides the number of the light model says that light passes through."""
    ior, d, tr = (number(entry, key) for key in ("ni", "d", "tr"))
    if ior is not None and abs(ior - 1) > _SAME_INDEX:
        return True
    filtered = color(entry, "tf")
    filters = filtered is not None and max(filtered) > 0 and min(filtered) < 1
    clear = (d is not None and d < 1) or (d is None and tr is not None and tr > 0)
    if ior is None and d is None and tr is None:
        return illum != 4 or filters
    # What neither refracts nor filters would not be seen at all: its d is a share of what it covers.
    return filters or (clear and ior is None)


def _glass(entry: Entry, common: Material, illum: float) -> MtlMaterial:
    if "map_kd" in entry.statements:
        warn(f"{entry.where('map_kd')}: map_Kd has no meaning for glass (illum {illum:g}) and is ignored")
    ior = number(entry, "ni")
    if ior is not None and not 0.1 <= ior <= 10:
        warn(f"{entry.where('ni')}: expected an index of refraction in 0.1..10, got {ior:g}; 1.5 is used")
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
        warn(f"{entry.path.name}, material {entry.name!r}: Kd reaches {max(base.constant):g}; it is divided by that")
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
    """d before 1 − Tr, times map_d; of glass only the map, because there d says the same as the glass."""
    opacity = 1.0
    if solid and "d" in entry.statements:
        opacity = number(entry, "d", most=1.0) or 0.0
    elif solid and "tr" in entry.statements:
        opacity = 1 - (number(entry, "tr", most=1.0) or 0.0)
        if opacity == 0:
            warn(
                f"{entry.where('tr')}: Tr 1 alone would be invisible; taken for the opposite, as some exporters mean it"
            )
            opacity = 1.0
    key = "map_d" if "map_d" in entry.statements else "map_tr"
    found = texture_map(entry, key)
    if opacity == 0 and found is not None:
        _say_hidden(entry, "d")
        opacity = 1.0
    elif opacity == 0:
        warn(f"{entry.path.name}, material {entry.name!r}: d is 0, its surfaces are invisible")
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
        warn(f"{entry.where(key)}: {found.name!r} looks like a normal map and is used as one")
        is_normal = True
    value = Value((1.0, 1.0, 1.0), texture, uv_transform=found.uv_transform)
    if is_normal:
        if texture.image.shape[2] < 3 or texture.image.size == len(flat):
            return None
        return NormalMap(value, "normal", found.bump_multiplier)
    return NormalMap(replace(value, channel=_channel(found, texture)), "bump", _BUMP_HEIGHT * found.bump_multiplier)


def _looks_like_normals(texture: Texture) -> bool:
    """Whether the image is bluish as (0.5, 0.5, 1) on average, which no height map is."""
    if texture.image.shape[2] < 3 or texture.image.shape[:2] == (1, 1):
        return False
    r, g, b = (float(c) for c in texture.image[..., :3].reshape(-1, 3).mean(axis=0, dtype=np.float64))
    white = 255.0 if texture.image.dtype == np.uint8 else 1.0
    return abs(r / white - 0.5) < 0.1 and abs(g / white - 0.5) < 0.1 and b / white > 0.75


def _color(library: Library, entry: Entry, key: str, default: float) -> Value:
    """A colour multiplied by its map."""
    constant = color(entry, key) or (default, default, default)
    found = texture_map(entry, f"map_{key}")
    if found is None:
        return Value(constant)
    if not any(constant) and key == "ks":
        warn(f"{entry.where(f'map_{key}')}: Ks is black and hides map_Ks; the material is diffuse")
        return Value(constant)
    if not any(constant):
        _say_hidden(entry, key)
        constant = (1.0, 1.0, 1.0)
    texture = read_map(library, entry, f"map_{key}", found, srgb=True)
    channel = 0 if texture.image.shape[2] == 1 else _CHANNELS.get(found.channel)
    return Value(constant, texture, channel, uv_transform=found.uv_transform)


def _say_hidden(entry: Entry, key: str) -> None:
    name = "d" if key == "d" else key.capitalize()
    place = entry.where(key) if key in entry.statements else f"{entry.path.name}, material {entry.name!r}"
    warn(f"{place}: {name} is 0 and would hide its map; the map counts alone")


def _scalar(library: Library, entry: Entry, key: str, constant: float, channel: int | None = None) -> Value:
    """A number multiplied by its map."""
    found = texture_map(entry, key)
    if found is None:
        return grey(constant)
    if constant == 0:
        _say_hidden(entry, key.removeprefix("map_"))
        constant = _MIRROR_EXPONENT if key == "map_ns" else 1.0
    texture = read_map(library, entry, key, found, srgb=False)
    if channel is None or channel >= texture.image.shape[2]:
        channel = _channel(found, texture)
    return Value((constant,) * 3, texture, channel, uv_transform=found.uv_transform)


def _channel(found: Map, texture: Texture) -> int:
    """The channel that -imfchan names, or the first one if the image does not have it."""
    channel = _CHANNELS.get(found.channel, 0)
    return channel if channel < texture.image.shape[2] else 0
