# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A picture: linear radiance, layers beside it, and how it was made."""

from __future__ import annotations

import os
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import DTypeLike, NDArray

from eclat.errors import EclatError, warn
from eclat.files.atomic_file import check_writable, write_file
from eclat.images import image_files
from eclat.images.tone import check_display, stops_of

LAYERS: dict[str, str] = {
    "direct": "RGB",
    "indirect": "RGB",
    "albedo": "RGB",
    "normal": "XYZ",
    "depth": "Z",
    "record_density": "Y",
}
"""The layers that `render` makes, with the letters of their channels in an EXR file (`indirect.R`, `depth.Z`)."""

RECORD_MARK = (1.0, 0.25, 0.0)
"""Colour of a mark, times the picture's white: orange is rare in scenes and seen on dark and bright walls."""

MAX_SIDE = 1 << 16
MAX_PIXELS = 1 << 27
"""16384 × 8192: 1.6 GB for radiance alone, as much again for each colour layer."""


def check_size(width: int, height: int, what: str = "size") -> None:
    """Raise EclatError unless a picture of that size can sensibly be made; call it before allocating anything.

    Raises
    ------
    EclatError : a side below 1 or above `MAX_SIDE`, or more than `MAX_PIXELS` pixels.
    """
    got = f"got {width}x{height}"
    if not (1 <= width <= MAX_SIDE and 1 <= height <= MAX_SIDE):
        raise EclatError(f"{what}: expected a width and a height between 1 and {MAX_SIDE:,} pixels, {got}")
    if width * height > MAX_PIXELS:
        raise EclatError(f"{what}: expected at most {MAX_PIXELS:,} pixels in all, {got}")


@dataclass(frozen=True, eq=False)
class Image:
    """A picture: the radiance of each pixel, layers and metadata. A notebook displays it as PNG.

    Parameters
    ----------
    pixels : (H, W, 3) float32 scene-linear radiance in W·sr⁻¹·m⁻² (cd·m⁻² of a photometric scene), Rec. 709
        primaries; row 0 is the top.
    layers : by name (those of `LAYERS`, or others), each (H, W, 3) or (H, W) float32. `normal` is in world space,
        `depth` in metres along the ray (infinite where it meets nothing), `record_density` records per pixel.
    metadata : values that JSON can represent: scene, options, seed, version, time, statistics.

    Examples
    --------
    >>> grey = Image(np.full((2, 3, 3), 0.18, dtype=np.float32), metadata={"seed": 7})
    >>> grey.width, grey.height
    (3, 2)

    Raises
    ------
    EclatError : shapes that do not agree, sizes beyond `check_size`.
    """

    pixels: NDArray[np.float32]
    layers: dict[str, NDArray[np.float32]] = field(default_factory=dict)
    metadata: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        pixels = np.asarray(self.pixels)
        if pixels.ndim != 3 or pixels.shape[2] != 3:
            raise EclatError(f"image: expected pixels of shape (height, width, 3), got {pixels.shape}")
        check_size(pixels.shape[1], pixels.shape[0], "image")
        layers = {name: np.asarray(layer) for name, layer in self.layers.items()}
        for name, layer in layers.items():
            if layer.shape[:2] != pixels.shape[:2] or layer.shape[2:] not in ((), (3,)):
                size = f"({pixels.shape[0]}, {pixels.shape[1]})"
                raise EclatError(f"image, layer {name!r}: expected {size} or {size[:-1]}, 3), got {layer.shape}")
        object.__setattr__(self, "pixels", np.ascontiguousarray(pixels, dtype=np.float32))
        object.__setattr__(self, "layers", {n: np.ascontiguousarray(v, dtype=np.float32) for n, v in layers.items()})

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        """The pixels, for `np.asarray(image)`."""
        return self.pixels if dtype is None and not copy else np.array(self.pixels, dtype=dtype)

    @property
    def width(self) -> int:
        """Pixels in a row."""
        return int(self.pixels.shape[1])

    @property
    def height(self) -> int:
        """Number of rows."""
        return int(self.pixels.shape[0])

    def save(
        self, path: str | os.PathLike[str], exposure: float | Literal["auto"] = 0.0, tone_mapping: str = "none"
    ) -> None:
        """Write the picture in the format that `path` ends in.

        ======  ===========================================================================================
        .exr    float32 radiance with all layers and the metadata (string attributes `eclat.<key>`, JSON)
        .png    8-bit sRGB for the screen, with exposure and tone mapping; metadata in the text field `eclat`
        .pfm    float32 radiance only
        .npy    float32 radiance only, for NumPy
        ======  ===========================================================================================

        The file is either whole or untouched, whatever fails or interrupts. Pixels that are not finite are warned
        about; radiance formats keep them as they are, PNG shows them in magenta.

        Parameters
        ----------
        exposure : stops, for PNG only: radiance times 2^exposure. "auto" takes the log-average luminance to mid grey, to
            the nearest half stop (`auto_exposure`), and the file's metadata say so as `exposure`.
        tone_mapping : "none" or "filmic", of PNG only.

        Raises
        ------
        EclatError : unknown suffix, bad exposure or tone mapping, or the file cannot be written.
        """
        file_format = check_output(path)
        stops = stops_of(exposure, self.pixels)
        check_display(stops, tone_mapping)
        self._warn_if_not_finite(os.fspath(path), file_format.not_finite)
        chosen = {"exposure": stops} if exposure == "auto" and file_format is image_files.FORMATS[".png"] else {}
        content = image_files.Content(self.pixels, self.layers, {**self.metadata, **chosen})
        write_file(path, file_format.encode(content, LAYERS, stops, tone_mapping))

    def show_records(self, exposure: float = 0.0) -> Image:
        """The picture with a mark over each pixel in which records lie, bright at that `exposure` (stops).

        Raises
        ------
        EclatError : the picture was not made with records.
        """
        density = self.layers.get("record_density")
        if density is None:
            raise EclatError("show_records: expected a picture made with records (layer record_density), got none")
        marked = density > 0
        # A pixel in pictures up to 800 pixels high; in larger ones marks would get lost.
        for _ in range(self.height // 800):
            taller = marked.copy()
            taller[1:] |= marked[:-1]
            marked = taller.copy()
            marked[:, 1:] |= taller[:, :-1]
        pixels = self.pixels.copy()
        pixels[marked] = np.float32(2.0**-exposure) * np.array(RECORD_MARK, dtype=np.float32)
        return replace(self, pixels=pixels)

    @staticmethod
    def load(path: str | os.PathLike[str]) -> Image:
        """The picture in an .exr, .pfm or .npy file.

        Raises
        ------
        EclatError : the file is absent or broken, or its format holds no radiance (.png).
        """
        content = image_files.read(path, check_size)
        return Image(content.pixels, content.layers, content.metadata)

    def _repr_png_(self) -> bytes:
        """The picture as PNG, for notebooks."""
        return image_files.encode_png(image_files.Content(self.pixels, {}, {}), LAYERS, 0.0, "none")

    def _warn_if_not_finite(self, name: str, treatment: str) -> None:
        bad = ~np.isfinite(self.pixels).all(axis=2)
        count = int(np.count_nonzero(bad))
        if count:
            row, column = divmod(int(np.argmax(bad)), self.width)
            which = f"{count:,} of {bad.size:,} pixels {'is' if count == 1 else 'are'} not finite"
            warn(f"{name}: {which}, the first at ({column}, {row}); {treatment}")


def check_output(path: str | os.PathLike[str]) -> image_files.Format:
    """The format to write `path` in. Raises EclatError for an unknown suffix or a place that cannot be written."""
    file_format = image_files.format_of(path)
    check_writable(path)
    return file_format
