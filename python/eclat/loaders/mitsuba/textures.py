# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Convert textures and colours to instances of `Value`."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.loaders.files import read_texture
from eclat.loaders.mitsuba.node import Blackbody, Color, Node, Rgb, Uniform, Vector, parse_numbers
from eclat.loaders.mitsuba.spectra import Role, check_curve, to_rgb
from eclat.measure.photometry import luminance
from eclat.measure.spectrum import srgb_to_linear
from eclat.scene import Texture, Value, grey, rgb

Kind = Literal["reflectance", "emission", "scalar", "normal"]
"""The use of a value. A scalar reads one channel of a texture, and a normal is never decoded from sRGB."""

Affine = tuple[tuple[float, float, float], tuple[float, float, float]]
Wrap = Literal["repeat", "mirror", "clamp"]

_WRAPS: dict[str, Wrap] = {"repeat": "repeat", "mirror": "mirror", "clamp": "clamp"}
_MAX_IMAGE = 1 << 28
"""The largest number of values in an image that a dict contains."""


@dataclass
class Textures:
    """The textures of a scene. Each is converted once, so that the same node always gives the same `Texture`."""

    made: dict[tuple[int, str], Value] = field(default_factory=dict)

    def value(self, node: Node, *names: str, default: float | Vector, kind: Kind) -> Value:
        """Convert the first property in `names` that `node` has, or return `default` if it has none of them.

        Raises
        ------
        EclatError : the value is negative, or it is neither a number nor a colour nor a texture.
        """
        given = node.get(*names)
        if given is None:
            return grey(default) if isinstance(default, (int, float)) else rgb(*default)
        value = self.of(given, node, names[0], kind)
        if min(value.constant) < 0:
            raise node.mismatch(names[0], "non-negative numbers", value.constant)
        if kind == "reflectance" and value.texture is None and max(value.constant) > 1:
            warn(f"{node.where}, {names[0]}: expected reflectances of at most 1, got {value.constant}; clipped to 1")
            r, g, b = (min(x, 1.0) for x in value.constant)
            return rgb(r, g, b)
        return value

    def of(self, given: Any, node: Node, name: str, kind: Kind) -> Value:
        """Convert `given`, the value of the property `name` of `node`: a number, a colour or a texture."""
        if isinstance(given, Node):
            if (id(given), kind) not in self.made:
                self.made[id(given), kind] = self._texture(given, kind)
            return self.made[id(given), kind]
        if isinstance(given, Color):
            role: Role = "emission" if kind == "emission" else "reflectance"
            return rgb(*to_rgb(given, role, f"{node.where}, {name}", node.legacy))
        if isinstance(given, tuple) and len(given) == 3:
            return rgb(*given)
        properties = Node(node.tag, node.type, node.where, node.folders, properties={name: given})
        return grey(properties.number(name, default=0.0))

    def _texture(self, node: Node, kind: Kind) -> Value:
        if node.tag == "spectrum" or node.type in _SPECTRA:
            role: Role = "emission" if kind == "emission" else "reflectance"
            return rgb(*to_rgb(_spectrum(node), role, node.where, node.legacy))
        if node.type == "bitmap":
            return _bitmap(node, kind)
        if node.type == "checkerboard":
            return self._checkerboard(node, kind)
        if node.type == "scale":
            return self._scaled(node, kind)
        if node.type in ("mesh_attribute", "vertexcolors"):
            name = node.string("name", default="vertex_color")
            if name != "vertex_color":
                warn(f"{node.where}: the mesh attribute {name[:60]!r} is not supported; the vertex colours are used")
            return grey(node.number("scale", default=1.0))
        warn(f"{node.where}: the texture type {node.type!r} is not supported; the constant 0.5 is used instead")
        return grey(0.5)

    def _checkerboard(self, node: Node, kind: Kind) -> Value:
        colors = [self._flat(node, name, default, kind) for name, default in (("color0", 0.4), ("color1", 0.2))]
        image = np.array([[colors[0], colors[1]], [colors[1], colors[0]]], dtype=np.float32)
        texture = Texture(image, filter="nearest", name=node.id or "checkerboard")
        return _textured(texture, kind, uv_transform(node))

    def _flat(self, node: Node, name: str, default: float, kind: Kind) -> Vector:
        value = self.value(node, name, default=default, kind=kind)
        if value.texture is not None:
            warn(f"{node.where}, {name}: textures in a checkerboard are not supported; the mean of the texture is used")
            mean = _linear(value.texture).reshape(-1, value.texture.image.shape[2]).mean(axis=0)
            mean = np.resize(mean[:3], 3) * value.constant
            return float(mean[0]), float(mean[1]), float(mean[2])
        return value.constant

    def _scaled(self, node: Node, kind: Kind) -> Value:
        inner = [child for _, child in node.children if child.tag in ("texture", "spectrum")]
        base = self.of(inner[0], node, "texture", kind) if inner else self.value(node, "value", default=1.0, kind=kind)
        factor = node.get("scale")
        if isinstance(factor, Node):
            raise node.mismatch("scale", "a number or a colour", factor)
        by = grey(1.0) if factor is None else self.of(factor, node, "scale", kind)
        r, g, b = (float(x) for x in np.multiply(base.constant, by.constant))
        return replace(base, constant=(r, g, b))


def uv_transform(node: Node) -> Affine:
    """Return the affine map of a texture's coordinates (u, v), as 2 rows of 3 numbers.

    It is read from `to_uv` or, in version 0.x, from uscale, vscale, uvscale, uoffset and voffset.
    """
    matrix = node.get("to_uv")
    if matrix is not None:
        m = node.transform("to_uv")
        return (float(m[0, 0]), float(m[0, 1]), float(m[0, 3])), (float(m[1, 0]), float(m[1, 1]), float(m[1, 3]))
    both = node.number("uvscale", "uv_scale", default=1.0)
    u = node.number("uscale", "u_scale", default=both), node.number("uoffset", "u_offset", default=0.0)
    v = node.number("vscale", "v_scale", default=both), node.number("voffset", "v_offset", default=0.0)
    return (u[0], 0.0, u[1]), (0.0, v[0], v[1])


def uses_vertex_colors(node: Node) -> bool:
    """Return whether a texture of the BSDF `node` reads the vertex colours of the mesh."""
    return any(child.type in ("mesh_attribute", "vertexcolors") for _, child in node.of_tag("texture"))


def peak(value: Value) -> NDArray[Any]:
    """Return the largest value of each of the three channels, shape (3,)."""
    if value.texture is None:
        return np.array(value.constant)
    texels = _linear(value.texture)[..., :3]
    return np.resize(texels.reshape(-1, texels.shape[2]).max(axis=0), 3) * value.constant


def image_data(node: Node) -> tuple[NDArray[Any], bool] | None:
    """Return the image in the property `bitmap` or `data` of a dict.

    Returns
    -------
    The image (H, W, C) and whether it is linear, or None if there is no such property.

    Raises
    ------
    EclatError : the image is not an array with 1 to 4 channels, or a value is not finite.
    """
    given = node.get("bitmap", "data")
    if given is None or isinstance(given, (str, Node)):
        return None
    try:
        image = np.asarray(given)
    except Exception as error:  # any object with __array__ may raise anything
        raise EclatError(f"{node.where}, bitmap: expected an image, got an object that raises {error!r}") from None
    if image.ndim == 2:
        image = image[..., None]
    if image.ndim != 3 or image.shape[2] not in (1, 2, 3, 4) or not 0 < image.size <= _MAX_IMAGE:
        raise EclatError(
            f"{node.where}, bitmap: expected an array of shape (H, W, C) with C in 1..4 and at most {_MAX_IMAGE} values, "
            f"got the shape {image.shape}"
        )
    if image.dtype == np.uint8:
        return image, False
    if not np.issubdtype(image.dtype, np.number) or not np.isfinite(image).all():
        raise EclatError(f"{node.where}, bitmap: expected finite numbers, got an array with other values")
    return image.astype(np.float32), True


def _bitmap(node: Node, kind: Kind) -> Value:
    raw = node.boolean("raw", default=False)
    gamma = node.number("gamma", default=-1.0)
    if kind == "normal" and not raw and gamma != 1:
        warn(f"{node.where}: the normal map is read as linear data (raw), although raw is not true")
    linear = raw or kind == "normal" or gamma == 1
    name = node.id or node.string("filename", default="bitmap").replace("\\", "/").rsplit("/", 1)[-1]
    options: dict[str, Any] = {"wrap_u": _wrap(node, "u"), "wrap_v": _wrap(node, "v"), "filter": _filter(node)}
    data = image_data(node)
    if data is None:
        options |= {"where": f"{node.where}, filename", "neutral": (0.5, 0.5, 1.0) if kind == "normal" else None}
        texture = read_texture(node.file("filename"), srgb=not linear, name=name, **options)
    else:
        texture = Texture(data[0], srgb=not (linear or data[1]), name=name, **options)
    if gamma > 0 and gamma != 1 and texture.srgb:
        powered = np.power(_unit(texture.image), np.float32(gamma))
        texture = replace(texture, image=powered, srgb=False)
    return _textured(texture, kind, uv_transform(node))


def _textured(texture: Texture, kind: Kind, transform: Affine) -> Value:
    """Return the value of `texture` with the constant factor 1. A scalar is the luminance of a coloured image."""
    if kind != "scalar":
        return Value((1.0, 1.0, 1.0), texture, uv_transform=transform)
    image = texture.image[..., :3]
    if image.shape[2] == 3 and not (image == image[..., :1]).all():
        scalars = luminance(_linear(texture)[..., :3])[..., None].astype(np.float32)
        texture = replace(texture, image=scalars, srgb=False)
    return Value((1.0, 1.0, 1.0), texture, channel=0, uv_transform=transform)


def _linear(texture: Texture) -> NDArray[Any]:
    """Return the texels of a texture as linear float32, decoded from sRGB if necessary."""
    image = _unit(texture.image)
    if texture.srgb:
        image = np.concatenate([srgb_to_linear(image[..., :3]).astype(np.float32), image[..., 3:]], axis=2)
    return image


def _unit(image: NDArray[Any]) -> NDArray[Any]:
    """Return the texels of an image as float32. Bytes are divided by 255."""
    scale = np.float32(1 / 255 if image.dtype == np.uint8 else 1)
    return image.astype(np.float32) * scale


def _wrap(node: Node, axis: str) -> Wrap:
    mode = node.string(f"wrap_mode_{axis}", "wrap_mode", default="repeat").lower()
    if mode not in _WRAPS:
        warn(f"{node.where}, wrap_mode: expected repeat, mirror or clamp, got {mode!r}; clamp is used")
        return "clamp"
    return _WRAPS[mode]


def _filter(node: Node) -> Literal["bilinear", "nearest"]:
    return "nearest" if node.string("filter_type", default="bilinear").lower() == "nearest" else "bilinear"


_SPECTRA = ("rgb", "srgb", "spectrum", "uniform", "d65", "blackbody", "regular", "irregular", "rawconstant")


def _spectrum(node: Node) -> Color:
    """Return the colour of a spectrum plugin."""
    scale = node.number("scale", default=1.0)
    if node.type == "blackbody":
        return Blackbody(node.number("temperature", default=6500.0), scale)
    if node.type == "d65":
        inner = node.get("color", "value")
        if isinstance(inner, Rgb):
            return Rgb((inner.values[0] * scale, inner.values[1] * scale, inner.values[2] * scale))
        return Rgb((scale,) * 3)
    if node.type in ("irregular", "regular"):
        return _sampled(node)
    color = node.get("color", "value")
    if isinstance(color, Color) and not isinstance(color, Uniform):
        return color
    vector = color if isinstance(color, tuple) else None
    return Rgb(vector if vector is not None else (node.number("value", "color", default=1.0),) * 3)


def _sampled(node: Node) -> Color:
    values = _floats(node, "values")
    if node.type == "irregular":
        return check_curve(_floats(node, "wavelengths"), values, node.where)
    first, last = node.number("wavelength_min", default=360.0), node.number("wavelength_max", default=830.0)
    return check_curve(np.linspace(first, last, len(values)).tolist(), values, node.where)


def _floats(node: Node, name: str) -> list[float]:
    value = node.get(name)
    if isinstance(value, str):
        return parse_numbers(value, f"{node.where}, {name}")
    if isinstance(value, tuple):
        return list(value)
    raise node.mismatch(name, "numbers", value)
