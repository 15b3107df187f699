# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""OpenEXR: radiance, layers and metadata in one file, channels named the usual way (`R`, `indirect.R`, `depth.Z`)."""

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
"""Before the name of each attribute that holds a piece of metadata as JSON."""

_MAGIC = b"\x76\x2f\x31\x01"


def encode_exr(
    pixels: Float32, layers: Mapping[str, Float32], metadata: Mapping[str, Any], letters: Mapping[str, str]
) -> bytes:
    """A scan-line file of float32 channels, ZIP-compressed (lossless).

    Parameters
    ----------
    pixels : (H, W, 3) radiance → R, G, B.
    layers : (H, W, 3) or (H, W) each → `name.<letter>`.
    letters : of known layers, such as "XYZ" for normals; others get "RGB" or "Y".
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
    """Pixels, layers and metadata of the first part of a file, on its display window; grey (`Y`) files become RGB.

    Raises
    ------
    EclatError : not an EXR file, broken, of another size than it may be, or without colour.
    """
    if data[:4] != _MAGIC:
        raise EclatError(f"{name}: expected an OpenEXR file, got one that starts with {data[:4]!r}")
    try:
        planes = read_planes(data, name, lambda width, height: check_size(width, height, name))
    except EclatError as error:
        raise EclatError(f"{name}: {str(error).removeprefix(f'{name}: ')}") from None
    except Exception as error:  # The library raises plain RuntimeError, ValueError and TypeError alike.
        raise EclatError(f"{name}: expected an OpenEXR file that can be read: {error}") from None
    layers = _layers(planes.channels, name)
    pixels = layers.pop("", None)
    if pixels is None:
        known = ", ".join(sorted(planes.channels)) or "none"
        raise EclatError(f"{name}: expected channels R, G, B or Y, got {known}")
    if pixels.ndim == 2:
        pixels = np.repeat(pixels[..., None], 3, axis=2)
    return pixels, layers, _metadata(planes.header, name)


def _channels(prefix: str, letters: str, array: Float32) -> dict[str, Float32]:
    planes = array[..., None] if array.ndim == 2 else array
    return {f"{prefix}{letter}": np.ascontiguousarray(planes[..., i]) for i, letter in enumerate(letters)}


def _layers(arrays: Mapping[str, Float32], name: str) -> dict[str, Float32]:
    """Channels grouped into layers by the part of their names before the last dot; the picture's own name is empty."""
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
            warn(f"{name}: the attribute {key!r} is not JSON and is ignored")
    return metadata
