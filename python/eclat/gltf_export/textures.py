# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Write textures and the images that they use [glTF 2.0, 3.8; KHR_texture_transform].

An image with 8 bits per channel that glTF can represent is written without loss. Any other image is converted to 8 bits
per channel.
"""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image as PillowImage

from eclat.errors import warn
from eclat.gltf_export.document import Document, Json
from eclat.images.tone import srgb_decode, srgb_encode
from eclat.scene import Texture, Value

Floats = NDArray[np.floating]
Bytes = NDArray[np.uint8]

_WRAPS = {"repeat": 10497, "mirror": 33648, "clamp": 33071}
_LINEAR, _NEAREST, _TRILINEAR, _NEAREST_MIPMAP = 9729, 9728, 9987, 9984
_IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))


def texels(value: Value) -> Floats:
    """Return the linear texels (H, W, C) that multiply the constant of `value`, with C = 1 or 3."""
    assert value.texture is not None
    image = np.asarray(value.texture.image)
    image = image if image.ndim == 3 else image[:, :, None]
    numbers = image.astype(np.float64) / 255 if image.dtype == np.uint8 else image.astype(np.float64)
    if value.texture.srgb:
        numbers[..., :3] = srgb_decode(numbers[..., :3])
    if value.channel is not None:
        numbers = numbers[..., min(value.channel, numbers.shape[2] - 1), None]
    elif numbers.shape[2] in (2, 4):
        numbers = numbers[..., :-1]
    if value.invert:
        numbers = 1 - numbers
    return numbers**2 if value.square else numbers


def constant_of(value: Value) -> tuple[float, float, float]:
    """Return the constant RGB factor of `value`, squared if `value.square`."""
    r, g, b = value.constant
    return (r * r, g * g, b * b) if value.square else (r, g, b)


def average(value: Value) -> Value:
    """Replace the texture of `value` by the mean of its texels."""
    if value.texture is None:
        return value
    mean = texels(value).mean(axis=(0, 1))
    r, g, b = (c * float(m) for c, m in zip(constant_of(value), np.broadcast_to(mean, 3), strict=True))
    return Value((r, g, b))


class Textures:
    """The images, samplers and textures of a document. Equal ones are written only once."""

    def __init__(self, document: Document, uv_sets: Mapping[int, int]) -> None:
        """Prepare to write into `document`. `uv_sets` maps each UV set of the scene to its TEXCOORD in the file."""
        self._document = document
        self._uv_sets = uv_sets
        self._images: dict[object, int] = {}
        self._textures: dict[object, int] = {}
        self._samplers: dict[object, int] = {}
        self._kept: list[object] = []  # the keys contain ids, which are only valid while the textures exist

    def color(self, value: Value, alpha: Value | None = None, *, scale: float = 1.0) -> Json | None:
        """Write a texture of sRGB colours, and return its textureInfo, or None if neither value has a texture.

        The texels of `value` are divided by `scale`. `alpha` becomes the alpha channel of the image.
        """
        owner = value if value.texture is not None else alpha
        if owner is None or owner.texture is None:
            return None
        if alpha is not None and alpha.texture is not None and not _same_mapping(owner, alpha):
            warn(
                "an opacity texture is replaced by its mean, because glTF requires the same texture coordinates and "
                "wrapping for opacity and colour"
            )
            alpha = None if value.texture is not None else alpha
        key = ("color", *(self._name(v) for v in (value, alpha)), scale)
        if key not in self._images:
            self._images[key] = self.image(_color_bytes(value, alpha, scale))
        return self._info(owner, self._images[key])

    def channels(self, values: Mapping[int, Value], *, neutral: int = 255) -> Json | None:
        """Write a texture of linear channels, and return its textureInfo, or None if no value has a texture.

        `values` has the value of each channel by number, from 0 (red) to 3 (alpha). Other channels are filled with the
        byte `neutral`.
        """
        varying = {i: v for i, v in values.items() if v.texture is not None}
        if not varying:
            return None
        owner = next(iter(varying.values()))
        key = ("channels", *((i, self._name(v)) for i, v in sorted(varying.items())))
        if key not in self._images:
            self._images[key] = self.image(_channel_bytes(varying, neutral))
        return self._info(owner, self._images[key])

    def image(self, pixels: Bytes) -> int:
        """Embed the bytes (H, W, C) as a PNG image, and return the index of the image."""
        file = io.BytesIO()
        PillowImage.fromarray(pixels[..., 0] if pixels.shape[2] == 1 else pixels).save(file, format="PNG")
        return self._document.add(
            "images", {"bufferView": self._document.view(file.getvalue()), "mimeType": "image/png"}
        )

    def texture(self, image: int, wraps: tuple[str, str], *, nearest: bool = False, mipmaps: bool = True) -> int:
        """Write a texture, and return its index.

        Parameters
        ----------
        image : the index of the image.
        wraps : the wrap modes in u and v.
        nearest : whether to use the nearest texel instead of bilinear interpolation.
        mipmaps : whether viewers may use mipmaps.
        """
        small = (_NEAREST_MIPMAP if nearest else _TRILINEAR) if mipmaps else _LINEAR
        sampler = (_NEAREST if nearest else _LINEAR, small, _WRAPS[wraps[0]], _WRAPS[wraps[1]])
        if sampler not in self._samplers:
            names = ("magFilter", "minFilter", "wrapS", "wrapT")
            self._samplers[sampler] = self._document.add("samplers", dict(zip(names, sampler, strict=True)))
        key = image, sampler
        if key not in self._textures:
            self._textures[key] = self._document.add("textures", {"source": image, "sampler": self._samplers[sampler]})
        return self._textures[key]

    def _info(self, value: Value, image: int) -> Json:
        texture = value.texture
        assert texture is not None
        index = self.texture(image, (texture.wrap_u, texture.wrap_v), nearest=texture.filter == "nearest")
        info: Json = {"index": index}
        uv_set = self._uv_sets[value.uv_set]
        if uv_set:
            info["texCoord"] = uv_set
        transform = _transform(value.uv_transform)
        if transform:
            info["extensions"] = {self._document.use("KHR_texture_transform"): transform}
        return info

    def _name(self, value: Value | None) -> object:
        """Return a hashable key that is equal for two values if they have the same texels."""
        if value is None or value.texture is None:
            return None
        self._kept.append(value.texture)
        return id(value.texture), value.channel, value.invert, value.square


def _same_mapping(a: Value, b: Value) -> bool:
    """Return whether two textures have the same texture coordinates and wrap modes."""
    if a.texture is None or b.texture is None:
        return True
    wraps = [(t.wrap_u, t.wrap_v) for t in (a.texture, b.texture)]
    return wraps[0] == wraps[1] and a.uv_set == b.uv_set and a.uv_transform == b.uv_transform


def _color_bytes(value: Value, alpha: Value | None, scale: float) -> Bytes:
    plain = value.texture is not None and _is_plain(value, value.texture) and scale == 1
    if plain and value.texture is not None and (alpha is None or alpha.texture is None):
        return _without_alpha(value.texture.image)
    if plain and alpha is not None and alpha.texture is value.texture and alpha.channel == 3 and not alpha.invert:
        assert value.texture is not None
        return np.asarray(value.texture.image)
    opaque = alpha is None or alpha.texture is None
    colors = texels(value) / scale if value.texture is not None else np.ones((1, 1, 1))
    if colors.max(initial=0) > 1:
        warn("a colour texture has texels above 1, which are clipped, because glTF stores 8 bits per channel")
    height, width = colors.shape[:2]
    if opaque:
        return _to_bytes(srgb_encode(colors))
    assert alpha is not None
    coverage = texels(alpha)
    height, width = max(height, coverage.shape[0]), max(width, coverage.shape[1])
    rgb = np.broadcast_to(_resized(srgb_encode(colors), height, width), (height, width, 3))
    return _to_bytes(np.concatenate((rgb, _resized(coverage, height, width)[..., :1]), axis=2))


def _channel_bytes(values: Mapping[int, Value], neutral: int) -> Bytes:
    first = next(iter(values.values())).texture
    assert first is not None
    same = all(
        v.texture is first and v.channel == i and not v.invert and not v.square and not first.srgb
        for i, v in values.items()
    )
    count = 4 if 3 in values else 3
    image = np.asarray(first.image)
    if same and image.dtype == np.uint8 and image.ndim == 3 and image.shape[2] >= count:
        return image[..., :count]
    planes = {i: texels(v) for i, v in values.items()}
    height, width = (max(p.shape[axis] for p in planes.values()) for axis in (0, 1))
    out = np.full((height, width, count), neutral, np.uint8)
    for i, plane in planes.items():
        out[..., i] = _to_bytes(_resized(plane, height, width).mean(axis=2))
    return out


def _is_plain(value: Value, texture: Texture) -> bool:
    """Return whether the image can be written unchanged as a colour texture, which in glTF consists of sRGB bytes."""
    image = np.asarray(texture.image)
    grey = image.ndim == 2 or image.shape[2] == 1
    one_of_many = value.channel is not None and not grey
    return texture.srgb and image.dtype == np.uint8 and not one_of_many and not value.invert and not value.square


def _without_alpha(image: NDArray[Any]) -> Bytes:
    image = image if image.ndim == 3 else image[:, :, None]
    return np.asarray(image[..., :-1] if image.shape[2] in (2, 4) else image)


def _resized(planes: Floats, height: int, width: int) -> Floats:
    """Resize each of the planes (H, W, C) bilinearly to `height` × `width`."""
    if planes.shape[:2] == (height, width):
        return planes
    scaled = [
        PillowImage.fromarray(planes[..., i].astype(np.float32)).resize(
            (width, height), PillowImage.Resampling.BILINEAR
        )
        for i in range(planes.shape[2])
    ]
    return np.stack([np.asarray(p, np.float64) for p in scaled], axis=2)


def _to_bytes(numbers: Floats) -> Bytes:
    return np.rint(np.clip(numbers, 0, 1) * 255).astype(np.uint8)


def _transform(matrix: tuple[tuple[float, float, float], tuple[float, float, float]]) -> Json:
    """Convert an affine map of texture coordinates to the offset, rotation and scale of KHR_texture_transform.

    The identity gives an empty object. A shear cannot be represented and is left out, with a warning.
    """
    if matrix == _IDENTITY:
        return {}
    (a, b, dx), (c, d, dy) = matrix
    # As in the loader, a = cos · sx, b = sin · sy, c = −sin · sx and d = cos · sy.
    angle = math.atan2(-c, a) if (a, c) != (0, 0) else math.atan2(b, d)
    cos, sin = math.cos(angle), math.sin(angle)
    sx, sy = a * cos - c * sin, b * sin + d * cos
    if max(abs(b - sin * sy), abs(d - cos * sy)) > 1e-6 * max(abs(sx), abs(sy)):
        warn("glTF does not support sheared texture coordinates; the shear is left out")
    transform: Json = {"offset": [dx, dy], "scale": [sx, sy]}
    return transform | ({"rotation": angle} if angle else {})


def square_root(value: Value) -> Value:
    """Return the square root of `value`. If `value.square`, this is the same value without the square."""
    if value.square:
        return replace(value, square=False)
    if value.texture is None:
        return replace(value, constant=tuple(math.sqrt(max(c, 0.0)) for c in value.constant))  # type: ignore[arg-type]
    roots = np.sqrt(np.clip(texels(value), 0, None)).astype(np.float32)
    texture = replace(value.texture, image=roots, srgb=False)
    r, g, b = (math.sqrt(max(c, 0.0)) for c in value.constant)
    return replace(value, constant=(r, g, b), texture=texture, channel=None if roots.shape[2] == 3 else 0, invert=False)
