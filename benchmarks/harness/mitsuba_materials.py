# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Our materials, textures and environments as descriptions for Mitsuba 3's `load_dict`."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eclat.images.tone import srgb_decode
from eclat.scene import DEFAULTS, Environment, Material, Value
from harness.unavailable import UnavailableError

HALF_TURN = np.diag([-1.0, 1.0, -1.0])
"""Their environments have the centre of the image at +z, ours at −z."""


def bsdf(mitsuba: Any, material: Material) -> dict[str, Any]:
    """Describe a material. Raises UnavailableError for what has no counterpart, or is not given to Mitsuba."""
    where = f"material {material.name!r}"
    if material.kind not in _MAKERS:
        raise UnavailableError(f"{where}: a {material.kind} is not given to Mitsuba")
    if material.normal_map is not None or material.vertex_colors or material.back is not None:
        raise UnavailableError(f"{where}: bumps, colours of vertices and other backs are not given to Mitsuba")
    if "alpha_v" in material.parameters:
        raise UnavailableError(f"{where}: only isotropic roughness is given to Mitsuba")
    described = _MAKERS[material.kind](mitsuba, material)
    if material.two_sided and material.kind not in _ON_BOTH_SIDES:
        described = {"type": "twosided", "bsdf": described}
    opacity = material.opacity
    if opacity.texture is None and opacity.constant[0] == 1:
        return described
    if material.alpha_cutoff is not None:
        raise UnavailableError(f"{where}: opacity with a threshold is not given to Mitsuba")
    return {"type": "mask", "opacity": value(mitsuba, opacity, grey=True), "bsdf": described}


def environment(mitsuba: Any, ours: Environment) -> dict[str, Any]:
    """Describe the light from infinity."""
    if ours.image.shape[:2] == (1, 1):
        return {"type": "constant", "radiance": _rgb([float(x) for x in ours.image[0, 0]])}
    to_world = np.eye(4)
    to_world[:3, :3] = np.asarray(ours.to_world) @ HALF_TURN
    bitmap = mitsuba.Bitmap(np.ascontiguousarray(ours.image, np.float32))
    return {"type": "envmap", "bitmap": bitmap, "to_world": mitsuba.ScalarTransform4f(to_world)}


def value(mitsuba: Any, ours: Value, *, grey: bool = False) -> Any:
    """Describe a parameter: a number or a colour, or a bitmap whose texels hold the constant factor too."""
    if ours.texture is None:
        constant = [float(x) for x in (1 - np.array(ours.constant) if ours.invert else ours.constant)]
        return constant[0] if grey else _rgb(constant)
    if ours.uv_set != 0 or ours.uv_transform != Value((1.0, 1.0, 1.0)).uv_transform:
        raise UnavailableError(
            f"texture {ours.texture.name!r}: only the first coordinates, as they are, are given to Mitsuba"
        )
    if ours.texture.wrap_u != ours.texture.wrap_v:
        raise UnavailableError(f"texture {ours.texture.name!r}: Mitsuba repeats along both axes in the same way")
    pixels = texels(ours)[..., :1] if grey else texels(ours)
    return {
        "type": "bitmap", "bitmap": mitsuba.Bitmap(np.ascontiguousarray(pixels, np.float32)), "raw": True,
        "wrap_mode": ours.texture.wrap_u, "filter_type": ours.texture.filter,
    }  # fmt: skip


def texels(ours: Value) -> NDArray[np.float32]:
    """Return the linear values (H, W, 3) of a textured parameter at its texels."""
    texture = ours.texture
    assert texture is not None
    image = np.asarray(texture.image, np.float32) / (255 if texture.image.dtype == np.uint8 else 1)
    colours = np.repeat(image[..., :1], 3, axis=2) if image.shape[2] < 3 else image[..., :3].copy()
    if texture.srgb:
        colours = srgb_decode(colours)
    if ours.channel is not None:
        plane = image[..., ours.channel] if ours.channel >= colours.shape[2] else colours[..., ours.channel]
        colours = np.repeat(plane[..., None], 3, axis=2)
    colours = 1 - colours if ours.invert else colours
    power = 2 if ours.square else 1
    return np.asarray((np.array(ours.constant, np.float32) * colours) ** power, np.float32)


def _read(material: Material, name: str) -> Value:
    return material.parameters.get(name, DEFAULTS[name])


def _alpha(material: Material) -> float:
    alpha = _read(material, "alpha_u")
    if alpha.texture is not None:
        raise UnavailableError(f"material {material.name!r}: textured roughness is not given to Mitsuba")
    return float(alpha.constant[0])


def _rough(described: dict[str, Any], material: Material) -> dict[str, Any]:
    """Make the smooth description a rough one, if the material is rough."""
    if (alpha := _alpha(material)) > 0:
        described |= {"type": f"rough{described['type']}", "alpha": alpha, "distribution": material.distribution}
    return described


def _diffuse(mitsuba: Any, material: Material) -> dict[str, Any]:
    return {"type": "diffuse", "reflectance": value(mitsuba, _read(material, "reflectance"))}


def _conductor(mitsuba: Any, material: Material) -> dict[str, Any]:
    eta, k = (_read(material, name).constant for name in ("eta", "k"))
    described = {
        "type": "conductor", "specular_reflectance": value(mitsuba, _read(material, "specular_reflectance")),
    }  # fmt: skip
    perfect = {"material": "none"}
    described |= perfect if not any(eta) and k == (1, 1, 1) else {"eta": _rgb(list(eta)), "k": _rgb(list(k))}
    return _rough(described, material)


def _dielectric(mitsuba: Any, material: Material) -> dict[str, Any]:
    described = {"type": "dielectric", "int_ior": float(_read(material, "ior").constant[0]), "ext_ior": 1.0}
    for name in ("specular_reflectance", "specular_transmittance"):
        described[name] = value(mitsuba, _read(material, name))
    return _rough(described, material)


def _plastic(mitsuba: Any, material: Material) -> dict[str, Any]:
    described = {
        "type": "plastic", "int_ior": float(_read(material, "ior").constant[0]), "ext_ior": 1.0,
        "nonlinear": material.nonlinear,
    }  # fmt: skip
    for name in ("diffuse_reflectance", "specular_reflectance"):
        described[name] = value(mitsuba, _read(material, name))
    return _rough(described, material)


def _rgb(color: list[float]) -> dict[str, Any]:
    return {"type": "rgb", "value": color}


_MAKERS: dict[str, Callable[[Any, Material], dict[str, Any]]] = {
    "diffuse": _diffuse, "conductor": _conductor, "dielectric": _dielectric, "plastic": _plastic,
}  # fmt: skip

_ON_BOTH_SIDES = {"dielectric"}
