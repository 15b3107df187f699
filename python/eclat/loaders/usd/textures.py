# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read UsdUVTexture, the UsdPrimvarReader and UsdTransform2d that place it, and images inside of `.usdz` archives.

The texture coordinates of USD have (0, 0) at the bottom left. Meshes get (s, 1 − t), so the transforms here are turned over.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.files.confinement import check_confined
from eclat.loaders.budget import count_file
from eclat.loaders.files import finite_texels, stand_in
from eclat.loaders.images import read_image_file
from eclat.loaders.triangles import linear_from_srgb
from eclat.loaders.usd.stages import Stage, pxr
from eclat.scene import Texture, Value

Rgba = NDArray[np.float64]
Wrap = Literal["repeat", "mirror", "clamp"]

LARGEST_FILE = 1 << 32
"""The largest number of bytes of an image file."""
MOST_STEPS = 100
"""The largest number of nodes between a texture and its coordinates. More of them are taken for a circle."""
_WRAPS: dict[str, Wrap] = {"repeat": "repeat", "mirror": "mirror", "clamp": "clamp", "useMetadata": "repeat"}
_CHANNELS = {"r": 0, "g": 1, "b": 2, "a": 3}
_TURNED_OVER = np.array([[1.0, 0, 0], [0, -1, 1], [0, 0, 1]])


@dataclass(frozen=True)
class Source:
    """What an input of a shader gets: a value, or the output `output` of a node."""

    value: Any = None
    node: Any = None
    output: str = ""


def source_of(stage: Stage, shader: Any, name: str) -> Source:
    """Return what the input `name` of a shader gets, through the interfaces of materials and node graphs."""
    shade = pxr("UsdShade")
    given = shader.GetInput(name)
    attributes = given.GetValueProducingAttributes() if given else []
    if not attributes:
        return Source()
    attribute = attributes[0]
    base, kind = shade.Utils.GetBaseNameAndType(attribute.GetName())
    if kind == shade.AttributeType.Output:
        return Source(node=shade.Shader(attribute.GetPrim()), output=str(base))
    return Source(value=attribute.Get(stage.time))


class Textures:
    """The textures of a stage. Each image is decoded once."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._images: dict[str, tuple[NDArray[Any], bool] | str] = {}
        self._textures: dict[tuple[object, ...], Texture] = {}

    def value(
        self, node: Any, output: str, uv_sets: list[str], *, normals: bool = False, default: float = 1.0
    ) -> Value | None:
        """Make a parameter of the output `output` of a UsdUVTexture.

        Parameters
        ----------
        node : the shader.
        output : "rgb", "r", "g", "b" or "a".
        uv_sets : the names of the primvars of texture coordinates that the material uses. The name of this one is added.
        normals : whether the texel is a normal in −1..1, which a `NormalMap` wants in 0..1.
        default : the value of an output that the image does not have, such as its alpha.

        Returns
        -------
        The parameter; None if the node is no texture, with a warning.
        """
        stage = self._stage
        where = stage.where(node.GetPrim())
        kind = str(node.GetIdAttr().Get() or "")
        if kind != "UsdUVTexture" or output not in ("rgb", *_CHANNELS):
            warn(
                f"{where}: expected a UsdUVTexture, got {kind[:40] or 'no shader'!r} with {output[:20]!r}; it is ignored"
            )
            return None
        scale = _numbers(stage, node, "scale", (1, 1, 1, 1))
        bias = _numbers(stage, node, "bias", (0, 0, 0, 0))
        if normals:
            scale, bias = self._of_normals(node, where, scale, bias)
        texture = self._texture(node, where, scale, bias)
        if (bias != 0).any():
            scale = np.ones(4)  # It is in the texels now, with the bias.
        uv_set, transform = self._coordinates(node, where, uv_sets)
        channels = texture.image.shape[2]
        if output == "rgb":
            red, green, blue = (float(factor) for factor in scale[:3])
            return Value((red, green, blue), texture, 0 if channels == 1 else None, uv_set, transform)
        channel = _CHANNELS[output]
        if channel == 3 and channels < 4:
            return Value((default,) * 3)
        return Value(
            (float(scale[channel]),) * 3, texture, 0 if channels == 1 else min(channel, channels - 1), uv_set, transform
        )

    def _of_normals(self, node: Any, where: str, scale: Rgba, bias: Rgba) -> tuple[Rgba, Rgba]:
        """Return the scale and the bias that give (normal + 1) / 2, as a `NormalMap` has it.

        The scale 2 and the bias −1, which normal maps in 0..1 need, give the texel itself.
        """
        if source_of(self._stage, node, "scale").value is None and source_of(self._stage, node, "bias").value is None:
            warn(f"{where}: a normal map needs scale and bias; 2 and −1 are used, as for every normal map in 0..1")
            return np.ones(4), np.zeros(4)
        scale, bias = scale / 2, (bias + 1) / 2
        scale[3], bias[3] = 1, 0
        if (scale != 1).any() and not (bias != 0).any():
            bias[3] = 1  # The alpha of a normal map is not read, so that this only says that the texels change.
        return scale, bias

    def _texture(self, node: Any, where: str, scale: Rgba, bias: Rgba) -> Texture:
        stage = self._stage
        asset = source_of(stage, node, "file").value
        space = str(source_of(stage, node, "sourceColorSpace").value or "auto")
        has_fallback = source_of(stage, node, "fallback").value is not None
        wraps = [self._wrap(node, name) for name in ("wrapS", "wrapT")]
        name = str(getattr(asset, "path", "") or "")
        resolved = str(getattr(asset, "resolvedPath", "") or "")
        key = (resolved or where, space, *wraps, *scale, *bias)
        if key not in self._textures:
            found = self._image(name, resolved, where)
            if isinstance(found, str):
                red, green, blue, _ = _numbers(stage, node, "fallback", (0, 0, 0, 1)).tolist()
                neutral = (red, green, blue) if has_fallback else None
                made = stand_in(found, srgb=neutral is None and space != "raw", where=where, neutral=neutral)
            else:
                image, linear = found
                # "auto" is sRGB for images of 8 bits and colours, and linear for others.
                eight = image.dtype == np.uint8 and image.shape[2] >= 3
                srgb = not linear and (space == "sRGB" or (space != "raw" and eight))
                made = _shifted(image, srgb, scale, bias)
            self._textures[key] = Texture(
                made.image, srgb=made.srgb, wrap_u=wraps[0], wrap_v=wraps[1], name=Path(name).name or where
            )
        return self._textures[key]

    def _wrap(self, node: Any, name: str) -> Wrap:
        text = str(source_of(self._stage, node, name).value or "useMetadata")
        if text not in _WRAPS:
            self._stage.once(
                f"wrap {text}", f"textures that are {text[:20]!r} outside of the image are clamped instead"
            )
        return _WRAPS.get(text, "clamp")

    def _image(self, name: str, resolved: str, where: str) -> tuple[NDArray[Any], bool] | str:
        """Return the image (H, W, C) and whether its format is linear, or the reason why it cannot be read."""
        if not resolved:
            return f"the image {name[:100]!r} does not exist" if name else "the texture names no image"
        if resolved not in self._images:
            try:
                data = _read(resolved, where)
                image, linear = read_image_file(Path(name), data)
                self._images[resolved] = finite_texels(image, where), linear
            except EclatError as error:
                self._images[resolved] = str(error)
        return self._images[resolved]

    def _coordinates(
        self, node: Any, where: str, uv_sets: list[str]
    ) -> tuple[int, tuple[tuple[float, float, float], tuple[float, float, float]]]:
        """Return which of the `uv_sets` a texture uses, and the affine map of texture coordinates with v downwards."""
        stage = self._stage
        transform, name = np.eye(3), "st"
        for _ in range(MOST_STEPS):
            found = source_of(stage, node, "st" if node.GetInput("st") else "in")
            if found.node is None:
                break
            node = found.node
            kind = str(node.GetIdAttr().Get() or "")
            if kind == "UsdTransform2d":
                transform = transform @ _affine(stage, node)
            elif kind.startswith("UsdPrimvarReader"):
                name = str(source_of(stage, node, "varname").value or "st")
                break
            else:
                warn(
                    f"{where}: expected a UsdPrimvarReader_float2, got {kind[:40]!r}; the primvar 'st' is used instead"
                )
                break
        if name not in uv_sets:
            if len(uv_sets) == 2:
                warn(
                    f"{where}: a material may use two primvars of texture coordinates; {uv_sets[0]!r} replaces {name!r}"
                )
                name = uv_sets[0]
            else:
                uv_sets.append(name)
        a, b, _ = (_TURNED_OVER @ transform @ _TURNED_OVER).tolist()
        return uv_sets.index(name), ((a[0], a[1], a[2]), (b[0], b[1], b[2]))


def _numbers(stage: Stage, node: Any, name: str, default: tuple[float, ...]) -> NDArray[np.float64]:
    """Return the numbers of an input, as many as `default` has, which replaces invalid ones with a warning.

    The file chooses the type of an input of a shader.
    """
    value = source_of(stage, node, name).value
    if value is None:
        return np.array(default, dtype=np.float64)
    try:
        numbers = np.array(value, dtype=np.float64).ravel()
    except (TypeError, ValueError):
        numbers = np.zeros(0)
    if numbers.shape == (len(default),) and np.isfinite(numbers).all():
        return numbers
    warn(
        f"{stage.where(node.GetPrim())}: expected {len(default)} finite numbers as {name}, got others; {default} is used"
    )
    return np.array(default, dtype=np.float64)


def _affine(stage: Stage, node: Any) -> NDArray[np.float64]:
    """Return the 3×3 matrix of a UsdTransform2d: scaled, then rotated counter-clockwise, then moved."""
    angle = math.radians(float(_numbers(stage, node, "rotation", (0,))[0]))
    size = _numbers(stage, node, "scale", (1, 1))
    moved = _numbers(stage, node, "translation", (0, 0))
    cos, sin = math.cos(angle), math.sin(angle)
    return np.array(
        [[cos * size[0], -sin * size[1], moved[0]], [sin * size[0], cos * size[1], moved[1]], [0.0, 0.0, 1.0]]
    )


def _read(resolved: str, where: str) -> bytes:
    """Return the bytes of a file, which may be in an archive. Raises EclatError if it cannot be read."""
    resolver = pxr("Ar")
    real = Path(resolved.partition("[")[0])
    check_confined(real, where)
    asset = resolver.GetResolver().OpenAsset(resolver.ResolvedPath(resolved))
    if not asset:
        raise EclatError(f"{where}: the image cannot be opened")
    if asset.GetSize() > LARGEST_FILE:
        raise EclatError(f"{where}: expected an image of at most {LARGEST_FILE} bytes, got {asset.GetSize()}")
    data = bytes(asset.GetBuffer())
    count_file(real, real.stat().st_size)
    return data


def _shifted(image: NDArray[Any], srgb: bool, scale: Rgba, bias: Rgba) -> Texture:
    """Return a texture whose texels are scale · texel + bias, if there is a bias; without one, the image as it is."""
    if not (bias != 0).any():
        return Texture(image, srgb=srgb)
    values = image.astype(np.float32) / (255 if image.dtype == np.uint8 else 1)
    if srgb:
        values[..., :3] = linear_from_srgb(values[..., :3])
    count = image.shape[2]
    return Texture((values * scale[:count] + bias[:count]).astype(np.float32))


def read_linear_image(stage: Stage, attribute: Any, where: str) -> NDArray[np.float32]:
    """Return the linear image (H, W, 3) that an attribute names; one white texel, with a warning, if it cannot be read."""
    asset = stage.value(attribute)
    name, resolved = (str(getattr(asset, part, "") or "") for part in ("path", "resolvedPath"))
    white = np.ones((1, 1, 3), np.float32)
    if not name:
        return white
    try:
        if not resolved:
            raise EclatError(f"{where}: the image {name[:100]!r} does not exist")
        image, linear = read_image_file(Path(name), _read(resolved, where))
    except EclatError as error:
        warn(f"{str(error).removeprefix(where + ': ')}, which {where} uses; the dome has one colour")
        return white
    values = finite_texels(image, where).astype(np.float32) / np.float32(255 if image.dtype == np.uint8 else 1)
    colors = values[..., :3] if values.shape[2] >= 3 else np.repeat(values[..., :1], 3, axis=2)
    return np.maximum(colors if linear else linear_from_srgb(colors), 0).astype(np.float32)
