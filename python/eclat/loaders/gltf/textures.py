# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Read textures, images and samplers, and make textured parameters [glTF 2.0, 3.8; KHR_texture_transform]."""

from __future__ import annotations

import math
from typing import Any, Literal

from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.loaders.files import TextureOptions, read_bytes, stand_in
from eclat.loaders.gltf.container import Document
from eclat.loaders.gltf.element import Element
from eclat.loaders.images import decode_image
from eclat.scene import Texture, Value

Wrap = Literal["repeat", "mirror", "clamp"]
Pixels = NDArray[Any]
Affine = tuple[tuple[float, float, float], tuple[float, float, float]]

_WRAPS: dict[int, Wrap] = {10497: "repeat", 33648: "mirror", 33071: "clamp"}
_NEAREST = 9728
# The extensions that refer to an image in another format, in the order of preference.
_IMAGE_EXTENSIONS = ("EXT_texture_webp", "EXT_texture_avif", "MSFT_texture_dds", "KHR_texture_basisu")


class Textures:
    """The textures of a document. Each image is decoded once, and equal textures share one `Texture`."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._images: dict[int, Pixels | str] = {}
        self._textures: dict[tuple[object, ...], Texture] = {}

    def value(
        self,
        info: Element | None,
        constant: tuple[float, float, float],
        *,
        srgb: bool = False,
        channel: int | None = None,
        square: bool = False,
        neutral: tuple[float, float, float] | None = None,
    ) -> Value:
        """Make a parameter: `constant`, multiplied by the texture that `info` refers to.

        Parameters
        ----------
        info : the textureInfo, or None for a parameter without a texture.
        constant : the RGB factor.
        srgb : whether the image is encoded in sRGB.
        channel : the channel of the image to use, or None for RGB. A grey image is used for every colour channel. If the
            image has no alpha channel, alpha is 1.
        square : whether to square the product, as for roughness.
        neutral : the RGB value that replaces an invalid image (see `eclat.loaders.files.read_texture`).

        Raises
        ------
        EclatError : an element is invalid. An invalid image gives a warning instead.
        """
        found = self._find(info, srgb, neutral)
        if info is None or found is None:
            return Value(constant, square=square)
        channels = found.image.shape[2]
        if channel == 3 and channels < 4:
            return Value(constant, square=square)
        if channels == 1:
            channel = 0
        uv_set, matrix = _uv_mapping(info, self._document.second_uv_set)
        return Value(constant, found, channel, uv_set, matrix, square=square)

    def _find(self, info: Element | None, srgb: bool, neutral: tuple[float, float, float] | None) -> Texture | None:
        """Return the texture that the textureInfo `info` refers to, or None if there is none."""
        if info is None:
            return None
        element = self._document.element(info, "index", "textures")
        if element is None:
            raise EclatError(f"{info.where}: expected the index of a texture as 'index', but it is missing")
        image = self._image_index(element)
        if image is None:
            warn(f"{element.where}: the texture refers to no image; only the constant factor is used")
            return None
        options = self._sampler(element)
        usable = not isinstance(self._pixels(image), str)
        key = (image, srgb, None if usable else neutral, *options.values())
        if key not in self._textures:
            self._textures[key] = self._make(image, srgb, neutral, options)
        return self._textures[key]

    def _make(
        self, index: int, srgb: bool, neutral: tuple[float, float, float] | None, options: TextureOptions
    ) -> Texture:
        image = self._document.elements("images")[index]
        options["name"] = image.text("name") or f"images[{index}]"
        pixels = self._pixels(index)
        if isinstance(pixels, str):
            return stand_in(pixels, srgb=srgb, where=image.where, neutral=neutral, **options)
        return Texture(pixels, srgb=srgb, **options)

    def _pixels(self, index: int) -> Pixels | str:
        """Return the decoded image (H, W, C), or the reason why it cannot be decoded."""
        if index not in self._images:
            data = self._encoded(self._document.elements("images")[index])
            try:
                self._images[index] = data if isinstance(data, str) else decode_image(data)
            except EclatError as error:
                self._images[index] = str(error)
        return self._images[index]

    def _encoded(self, image: Element) -> bytes | str:
        """Return the bytes of an image file, or the reason why they cannot be read.

        Raises EclatError if a URI leads out of the folder of the document.
        """
        uri = image.text("uri")
        if not uri:
            view = self._document.buffer_view(image)
            return "the image has neither a 'uri' nor a 'bufferView'" if view is None else bytes(view[0])
        if uri[:5].lower() == "data:":
            try:
                return self._document.uri_bytes(uri, image.where)
            except EclatError as error:
                return str(error)
        path = self._document.uri_path(uri, image.where)
        try:
            return read_bytes(path, where=image.where)
        except EclatError as error:
            return str(error)

    def _image_index(self, texture: Element) -> int | None:
        count = len(self._document.elements("images"))
        source = texture.index("source", count, "images")
        if source is not None:
            return source
        for name in _IMAGE_EXTENSIONS:
            extension = texture.extension(name)
            if extension is not None:
                return extension.index("source", count, "images")
        return None

    def _sampler(self, texture: Element) -> TextureOptions:
        sampler = self._document.element(texture, "sampler", "samplers")
        if sampler is None:
            return {"wrap_u": "repeat", "wrap_v": "repeat", "filter": "bilinear"}
        nearest = sampler.integer("magFilter", 0) == _NEAREST
        return {
            "wrap_u": _wrap(sampler, "wrapS"),
            "wrap_v": _wrap(sampler, "wrapT"),
            "filter": "nearest" if nearest else "bilinear",
        }


def uv_sets(*values: Value | None) -> set[int]:
    """Return the numbers of the texture coordinate sets that the textures of `values` use."""
    return {value.uv_set for value in values if value is not None and value.texture is not None}


def _wrap(sampler: Element, name: str) -> Wrap:
    code = sampler.integer(name, 10497)
    if code not in _WRAPS:
        warn(f"{sampler.at(name)}: expected one of {list(_WRAPS)}, got {code}; the texture is repeated")
    return _WRAPS.get(code, "repeat")


def _uv_mapping(info: Element, second_uv_set: int) -> tuple[int, Affine]:
    """Return the texture coordinate set, 0 or 1, and the affine map of texture coordinates of a textureInfo."""
    transform = info.extension("KHR_texture_transform")
    uv_set = info.integer("texCoord", 0)
    matrix: Affine = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    if transform is not None:
        uv_set = transform.integer("texCoord", uv_set)
        angle = transform.number("rotation", 0.0)
        cos, sin = math.cos(angle), math.sin(angle)
        (dx, dy), (sx, sy) = transform.numbers("offset", 2, (0, 0)), transform.numbers("scale", 2, (1, 1))
        # The rotation is counter-clockwise in an image with v downwards, as in all viewers. The GLSL code in the
        # extension's specification rotates the other way, but contradicts the text and the example there
        # (github.com/KhronosGroup/glTF/issues/1563).
        matrix = ((cos * sx, sin * sy, dx), (-sin * sx, cos * sy, dy))
    if uv_set == second_uv_set:
        uv_set = 1
    elif uv_set > 0:
        warn(
            f"{info.where}: TEXCOORD_{uv_set} is not supported, only TEXCOORD_0 and TEXCOORD_1 are; TEXCOORD_0 is used "
            "instead"
        )
        uv_set = 0
    return uv_set, matrix
