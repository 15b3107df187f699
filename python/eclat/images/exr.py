# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Encode and decode OpenEXR files with radiance, layers and metadata.

Channels have the usual names, such as `R`, `indirect.R` and `depth.Z`.
"""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import OpenEXR

from eclat.errors import EclatError, warn
from eclat.images.exr_planes import REC_709, Float32, read_planes

PREFIX = "eclat."
"""The prefix of the names of attributes that contain metadata as JSON."""

_MAGIC = b"\x76\x2f\x31\x01"


def encode_exr(
    pixels: Float32, layers: Mapping[str, Float32], metadata: Mapping[str, Any], letters: Mapping[str, str]
) -> bytes:
    """Encode an image as an OpenEXR file with scan lines of float32 channels and lossless ZIP compression.

    Parameters
    ----------
    pixels : (H, W, 3) the radiance. It becomes the channels R, G and B.
    layers : the layers by name, (H, W, 3) or (H, W). They become channels of the form `name.<letter>`.
    metadata : values that JSON can represent. They become attributes.
    letters : the letters of the channels of known layers, such as "XYZ" for normals. Other layers get "RGB" or "Y".
    """
    channels = _channels("", "RGB", pixels)
    for name, layer in layers.items():
        channels |= _channels(f"{name}.", letters.get(name, "RGB" if layer.ndim == 3 else "Y"), layer)
    header: dict[str, Any] = {
        "type": OpenEXR.scanlineimage,
        "compression": OpenEXR.ZIP_COMPRESSION,
        "chromaticities": REC_709,
    }
    for key, value in metadata.items():
        header[PREFIX + key] = json.dumps(value, ensure_ascii=False)
    file = io.BytesIO()
    OpenEXR.File(header, channels).write(file)
    return file.getvalue()


def decode_exr(
    data: bytes, name: str, check_size: Callable[[int, int, str], None]
) -> tuple[Float32, dict[str, Float32], dict[str, Any]]:
    """Decode the first part with colours of an OpenEXR file, on its display window.

    Parameters
    ----------
    data : the bytes of the file.
    name : the name of the file, for messages.
    check_size : a function that raises EclatError if a width and a height are too large.

    Returns
    -------
    The pixels (H, W, 3), the layers by name, and the metadata. Grey files (`Y`) become RGB.

    Raises
    ------
    EclatError : the file is no OpenEXR file, is invalid or too large, or has no colour channels.
    """
    if data[:4] != _MAGIC:
        raise EclatError(f"{name}: expected an OpenEXR file, got one that starts with {data[:4]!r}")
    try:
        planes = read_planes(data, name, lambda width, height: check_size(width, height, name))
    except EclatError as error:
        raise EclatError(f"{name}: {str(error).removeprefix(f'{name}: ')}") from None
    except Exception as error:  # The library raises RuntimeError, ValueError, TypeError and others.
        raise EclatError(f"{name}: expected a valid OpenEXR file, got an error: {error}") from None
    layers = _layers(planes.channels, name)
    pixels = layers.pop("", None)
    if pixels is None:
        known = ", ".join(sorted(planes.channels)) or "none"
        raise EclatError(f"{name}: expected the channels R, G, B or the channel Y, got {known}")
    if pixels.ndim == 2:
        pixels = np.repeat(pixels[..., None], 3, axis=2)
    return pixels, layers, _metadata(planes.header, name)


def _channels(prefix: str, letters: str, array: Float32) -> dict[str, Float32]:
    planes = array[..., None] if array.ndim == 2 else array
    return {f"{prefix}{letter}": np.ascontiguousarray(planes[..., i]) for i, letter in enumerate(letters)}


def _layers(arrays: Mapping[str, Float32], name: str) -> dict[str, Float32]:
    """Group channels into layers by the part of their names before the last dot. This part is empty for the image
    itself.

    Channels that do not belong to a layer of a known form are ignored, with a warning.
    """
    groups: dict[str, dict[str, Float32]] = {}
    for key, array in arrays.items():
        layer, _, letter = key.rpartition(".")
        groups.setdefault(layer, {})[letter] = array
    layers: dict[str, Float32] = {}
    ignored: list[str] = []
    for layer, planes in groups.items():
        letters = next((s for s in ("RGB", "XYZ", "rgb", "Y", "Z", "R") if set(s) <= set(planes)), next(iter(planes)))
        if len(letters) not in (1, 3) or letters[0] not in planes or (not layer and letters[0] not in "RY"):
            ignored += [f"{layer}.{letter}".strip(".") for letter in planes]
            continue
        taken = [planes[letter] for letter in letters]
        layers[layer] = np.stack(taken, axis=-1) if len(taken) == 3 else taken[0]
        ignored += [f"{layer}.{letter}".strip(".") for letter in planes if letter not in letters]
    if ignored:
        warn(f"{name}: these channels are ignored: {', '.join(sorted(ignored))}")
    return layers


def _metadata(header: Mapping[str, Any], name: str) -> dict[str, Any]:
    metadata: dict[str, Any] = {}
    for key, value in header.items():
        if not key.startswith(PREFIX):
            continue
        try:
            metadata[key.removeprefix(PREFIX)] = json.loads(str(value))
        except (ValueError, RecursionError):
            warn(f"{name}: the attribute {key!r} is ignored, because it is not valid JSON")
    return metadata
