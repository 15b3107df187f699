# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Images: linear radiance, additional layers, and metadata about the rendering."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
import PIL.Image
from numpy.typing import ArrayLike, DTypeLike, NDArray

from eclat.errors import EclatError, did_you_mean, warn
from eclat.files.atomic_file import check_writable, write_file
from eclat.images import image_files
from eclat.images.exposure_slider import exposure_slider
from eclat.images.tone import check_display, exposure_stops, srgb_decode, to_display
from eclat.typed import typed

LAYERS: dict[str, str] = {
    "direct": "RGB",
    "indirect": "RGB",
    "albedo": "RGB",
    "normal": "XYZ",
    "depth": "Z",
    "record_density": "Y",
    "record_weight": "Y",
    "object_id": "Y",
    "motion_next": "XYZ",
    "motion_previous": "XYZ",
}
"""The layers that `render` and `animate` can write, with the letters of their channels in an EXR file (`indirect.R`,
`depth.Z`)."""

RECORD_MARK = (1.0, 0.25, 0.0)
"""The linear RGB colour of the marks of records, relative to white. Orange is rare in scenes, and visible on dark and on
bright surfaces."""

MAX_SIDE = 1 << 16
"""The largest width and height of an image in pixels."""
MAX_PIXELS = 1 << 27
"""The largest number of pixels of an image: 16384 × 8192. The radiance then takes 1.6 GB, and so does each colour layer."""


def check_size(width: int, height: int, what: str = "size") -> None:
    """Raise EclatError if an image would be empty or too large. Call it before memory is allocated.

    Parameters
    ----------
    width, height : the size in pixels.
    what : the name of the size, for the message.

    Raises
    ------
    EclatError : a side is below 1 or above `MAX_SIDE`, or there are more than `MAX_PIXELS` pixels.
    """
    got = f"got {width}x{height}"
    if not (1 <= width <= MAX_SIDE and 1 <= height <= MAX_SIDE):
        raise EclatError(f"{what}: expected a width and a height between 1 and {MAX_SIDE:,} pixels, {got}")
    if width * height > MAX_PIXELS:
        raise EclatError(f"{what}: expected at most {MAX_PIXELS:,} pixels in total, {got}")


@dataclass(frozen=True, eq=False)
class Image:
    """An image: the radiance of each pixel, additional layers, and metadata. A notebook displays it as PNG.

    Parameters
    ----------
    pixels : (H, W, 3) float32 scene-linear radiance with Rec. 709 primaries, in W·sr⁻¹·m⁻² or, for a photometric scene,
        in cd·m⁻². Row 0 is the top row.
    layers : further data for each pixel by name, (H, W, 3) or (H, W) float32. The names are those of `LAYERS` or others.
        `normal` is in world space. `depth` is the distance along the ray in metres, and infinite if the ray hits no
        surface. `record_density` is the number of records in the pixel.
    metadata : values that JSON can represent, such as the scene, options, seed, version, time and statistics.

    Examples
    --------
    >>> grey = Image(np.full((2, 3, 3), 0.18, dtype=np.float32), metadata={"seed": 7})
    >>> grey.width, grey.height
    (3, 2)

    Raises
    ------
    EclatError : the shapes do not match, or the size is refused by `check_size`.
    """

    pixels: NDArray[np.float32]
    layers: dict[str, NDArray[np.float32]] = field(default_factory=dict)
    metadata: dict[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        layers = f", layers {', '.join(self.layers)}" if self.layers else ""
        return f"<Image: {self.width}×{self.height}{layers}>"

    def __post_init__(self) -> None:
        pixels = np.asarray(self.pixels)
        if pixels.ndim != 3 or pixels.shape[2] != 3:
            raise EclatError(f"image: expected pixels of shape (height, width, 3), got {pixels.shape}")
        check_size(pixels.shape[1], pixels.shape[0], "image")
        layers = {name: np.asarray(layer) for name, layer in self.layers.items()}
        for name, layer in layers.items():
            if layer.shape[:2] != pixels.shape[:2] or layer.shape[2:] not in ((), (3,)):
                size = f"({pixels.shape[0]}, {pixels.shape[1]})"
                raise EclatError(
                    f"image, layer {name!r}: expected the shape {size} or {size[:-1]}, 3), got {layer.shape}"
                )
        object.__setattr__(self, "pixels", np.ascontiguousarray(pixels, dtype=np.float32))
        object.__setattr__(self, "layers", {n: np.ascontiguousarray(v, dtype=np.float32) for n, v in layers.items()})

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        """Convert the image to an array: `np.asarray(image)` is `pixels`."""
        return self.pixels if dtype is None and not copy else np.array(self.pixels, dtype=dtype)

    @property
    def width(self) -> int:
        """The width in pixels."""
        return int(self.pixels.shape[1])

    @property
    def height(self) -> int:
        """The height in pixels."""
        return int(self.pixels.shape[0])

    @typed
    def save(
        self, path: str | os.PathLike[str], exposure: float | Literal["auto"] = 0.0, tone_mapping: str = "none"
    ) -> None:
        """Write the image to a file. The suffix of `path` determines the format.

        ======  ===========================================================================================
        .exr    float32 radiance with all layers, and the metadata as JSON in attributes `eclat.<key>`
        .png    8-bit sRGB for display, with exposure and tone mapping; the metadata are in the text `eclat`
        .hdr    radiance only, with 8 bits for the largest channel (Radiance RGBE); negative channels become 0
        .pfm    float32 radiance only
        .npy    float32 radiance only, for NumPy
        ======  ===========================================================================================

        The file is written atomically: after a failure or an interrupt, the previous file is unchanged. Pixels that are
        not finite cause a warning. Formats with radiance keep them, and in a PNG file they are magenta.

        Parameters
        ----------
        path : the file to write.
        exposure : the exposure in stops, for PNG only. Radiance is multiplied by 2^exposure. "auto" chooses the exposure
            that maps the log-average luminance to mid grey, to the nearest half stop (see `auto_exposure`), and writes it
            to the metadata of the file as `exposure`.
        tone_mapping : "none" or "filmic", for PNG only.

        Raises
        ------
        EclatError : the suffix is unknown, the exposure or the tone mapping is invalid, or the file cannot be written.
        """
        file_format = check_output(path)
        stops = exposure_stops(exposure, self.pixels)
        check_display(stops, tone_mapping)
        self._warn_if_not_finite(os.fspath(path), file_format.not_finite)
        chosen = {"exposure": stops} if exposure == "auto" and file_format is image_files.FORMATS[".png"] else {}
        content = image_files.Content(self.pixels, self.layers, {**self.metadata, **chosen})
        write_file(path, file_format.encode(content, LAYERS, stops, tone_mapping))

    def show_records(self, exposure: float = 0.0) -> Image:
        """Mark each pixel that contains records.

        `exposure` is the exposure in stops at which the image will be displayed, so that the marks have the right
        brightness.

        Raises
        ------
        EclatError : the image has no layer `record_density`, because it was not rendered with records.
        """
        density = self.layers.get("record_density")
        if density is None:
            raise EclatError(
                "show_records: expected an image with the layer 'record_density', got none; "
                "render the image with a method that uses records"
            )
        marked = density > 0
        # A mark is one pixel large in images up to 800 pixels high, and larger in larger images, to remain visible.
        for _ in range(self.height // 800):
            taller = marked.copy()
            taller[1:] |= marked[:-1]
            marked = taller.copy()
            marked[:, 1:] |= taller[:, :-1]
        pixels = self.pixels.copy()
        pixels[marked] = np.float32(2.0**-exposure) * np.array(RECORD_MARK, dtype=np.float32)
        return replace(self, pixels=pixels)

    @staticmethod
    @typed
    def load(path: str | os.PathLike[str]) -> Image:
        """Read an image from an .exr, .hdr, .pfm or .npy file.

        Raises
        ------
        EclatError : the file does not exist or is invalid, or its format contains no radiance (.png).
        """
        content = image_files.read(path, check_size)
        return Image(content.pixels, content.layers, content.metadata)

    def __getitem__(self, name: str) -> NDArray[np.float32]:
        """Return a layer by its name, or the pixels by "pixels". Raises KeyError for an unknown name."""
        if name == "pixels":
            return self.pixels
        if name not in self.layers:
            known = ["pixels", *self.layers]
            raise KeyError(f"no layer {name!r}, expected one of {', '.join(known)}{did_you_mean(str(name), known)}")
        return self.layers[name]

    def __contains__(self, name: object) -> bool:
        return name == "pixels" or name in self.layers

    def __iter__(self) -> Iterator[str]:
        return iter(self.keys())

    def keys(self) -> list[str]:
        """List what `image[name]` accepts: "pixels" and the names of the layers."""
        return ["pixels", *self.layers]

    def values(self) -> list[NDArray[np.float32]]:
        """List the arrays in the order of `keys`."""
        return [self.pixels, *self.layers.values()]

    def items(self) -> list[tuple[str, NDArray[np.float32]]]:
        """List pairs of a name and its array."""
        return list(zip(self.keys(), self.values(), strict=True))

    def __len__(self) -> int:
        return 1 + len(self.layers)

    @staticmethod
    @typed
    def from_array(pixels: ArrayLike, layers: Mapping[str, ArrayLike] | None = None) -> Image:
        """Make an image of linear radiance from arrays: (H, W, 3), or (H, W) and (H, W, 1) for grey.

        Raises
        ------
        EclatError : an array has another shape or does not contain numbers.
        """
        try:
            array = np.asarray(pixels, np.float32)
            others = {name: np.asarray(layer, np.float32) for name, layer in (layers or {}).items()}
        except (TypeError, ValueError):
            raise EclatError("image: expected arrays of numbers, got something else") from None
        if array.ndim == 2 or (array.ndim == 3 and array.shape[2] == 1):
            array = np.repeat(array.reshape(*array.shape[:2], 1), 3, axis=2)
        return Image(array, others)

    @typed
    def to_pil(self, exposure: float | Literal["auto"] = 0.0, tone_mapping: str = "none") -> PIL.Image.Image:
        """Convert the image to a Pillow image of 8-bit sRGB, as `save` writes a PNG file.

        Parameters and errors are those of `save`.
        """
        stops = exposure_stops(exposure, self.pixels)
        check_display(stops, tone_mapping)
        return PIL.Image.fromarray(to_display(self.pixels, stops, tone_mapping))

    @staticmethod
    def from_pil(picture: PIL.Image.Image) -> Image:
        """Make an image of linear radiance from a Pillow image, whose colours are sRGB if it has 8 bits per channel.

        White becomes 1, and alpha is left out. Raises EclatError if it is no Pillow image.
        """
        if not isinstance(picture, PIL.Image.Image):
            raise EclatError(f"from_pil: expected a Pillow image, got {type(picture).__name__}")
        if picture.mode in ("F", "I", "I;16", "I;16B"):
            grey = np.asarray(picture, np.float32)
            return Image.from_array(grey if picture.mode == "F" else grey / np.float32(65535))
        return Image(srgb_decode(np.asarray(picture.convert("RGB")) / 255).astype(np.float32))

    def _repr_html_(self) -> str:
        """Return the image with a slider for its exposure, for notebooks."""
        return exposure_slider(self.pixels, self._repr_png_())

    def _repr_png_(self) -> bytes:
        """Return the image as a PNG file, for notebooks."""
        return image_files.encode_png(image_files.Content(self.pixels, {}, {}), LAYERS, 0.0, "none")

    def _warn_if_not_finite(self, name: str, treatment: str) -> None:
        """Warn if pixels are not finite. The warning names the file, and `treatment` says how they are written."""
        bad = ~np.isfinite(self.pixels).all(axis=2)
        count = int(np.count_nonzero(bad))
        if count:
            row, column = divmod(int(np.argmax(bad)), self.width)
            which = f"{count:,} of {bad.size:,} pixels {'is' if count == 1 else 'are'} not finite"
            warn(f"{name}: {which}, the first one at column {column}, row {row}; {treatment}")


def check_output(path: str | os.PathLike[str]) -> image_files.Format:
    """Return the format of the image file `path`.

    Raises EclatError if its suffix is unknown or the file cannot be written.
    """
    file_format = image_files.format_of(path)
    check_writable(path)
    return file_format
