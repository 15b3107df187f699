# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures: linear radiance with layers and metadata, written whole or not at all."""

from __future__ import annotations

import io
import json
import os
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image as PillowImage

from eclat.errors import EclatError, warn

SUFFIXES = (".exr", ".png", ".npy", ".pfm")


def to_srgb(linear: np.ndarray) -> np.ndarray:
    """The sRGB transfer function (IEC 61966-2-1), clipped to 0..1."""
    x = np.clip(linear, 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.power(np.maximum(x, 1e-9), 1 / 2.4) - 0.055)


def filmic(linear: np.ndarray) -> np.ndarray:
    """A film-like shoulder: x (1 + x / w²) / (1 + x) per channel with white at w = 4 (Reinhard 2002, eq. 4)."""
    x = np.maximum(linear, 0)
    return x * (1 + x / 16) / (1 + x)


TONE_MAPPINGS: dict[str, Callable[[np.ndarray], np.ndarray]] = {"none": lambda x: x, "filmic": filmic}


def write_whole(path: Path, write: Callable[[Path], None]) -> None:
    """Let `write` fill a temporary file beside `path`, then move it there. Raises EclatError naming the file."""
    try:
        descriptor, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.stem}.", suffix=path.suffix)
        os.close(descriptor)
    except OSError as error:
        raise EclatError(f"{path}: cannot write here ({error.strerror})") from error
    temporary = Path(name)
    try:
        write(temporary)
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except OSError as error:
        raise EclatError(f"{path}: writing failed ({error.strerror or error}); nothing was changed") from error
    finally:
        temporary.unlink(missing_ok=True)


@dataclass(eq=False)
class Image:
    """`pixels` (H, W, 3) float32 linear radiance, named `layers` of the same height and width, JSON-able `metadata`."""

    pixels: np.ndarray
    layers: dict[str, np.ndarray] = field(default_factory=dict)
    metadata: dict[str, Any] = field(default_factory=dict)

    def save(self, path: str | os.PathLike[str], exposure: float = 0.0, tone_mapping: str = "none") -> None:
        """Write by suffix: .exr (all layers, linear), .png (sRGB), .npy, .pfm. Raises EclatError."""
        target = Path(path)
        writers: dict[str, Callable[[Path], None]] = {
            ".exr": self._write_exr,
            ".png": lambda p: p.write_bytes(self.to_png(exposure, tone_mapping)),
            ".npy": self._write_npy,
            ".pfm": self._write_pfm,
        }
        suffix = target.suffix.lower()
        if suffix not in writers:
            raise EclatError(f"{target}: unknown picture format {suffix!r}, expected one of {', '.join(SUFFIXES)}")
        if not np.isfinite(self.pixels).all():
            warn(f"{target}: {int((~np.isfinite(self.pixels)).any(axis=-1).sum())} pixels are not finite")
        write_whole(target, writers[suffix])

    def to_png(self, exposure: float = 0.0, tone_mapping: str = "none") -> bytes:
        """The picture as PNG bytes, `exposure` in stops."""
        if tone_mapping not in TONE_MAPPINGS:
            raise EclatError(f"tone mapping must be one of {', '.join(TONE_MAPPINGS)}, got {tone_mapping!r}")
        display = to_srgb(TONE_MAPPINGS[tone_mapping](np.nan_to_num(self.pixels) * 2.0**exposure))
        buffer = io.BytesIO()
        PillowImage.fromarray(np.round(display * 255).astype(np.uint8)).save(buffer, "PNG")
        return buffer.getvalue()

    def _repr_png_(self) -> bytes:
        return self.to_png()

    def _write_npy(self, path: Path) -> None:
        with path.open("wb") as file:
            np.save(file, self.pixels)

    def _write_pfm(self, path: Path) -> None:
        height, width = self.pixels.shape[:2]
        rows = np.ascontiguousarray(self.pixels[::-1], "<f4")
        path.write_bytes(f"PF\n{width} {height}\n-1.0\n".encode() + rows.tobytes())

    def _write_exr(self, path: Path) -> None:
        import OpenEXR

        channels: dict[str, np.ndarray] = {n: self.pixels[..., i] for i, n in enumerate("RGB")}
        for name, layer in self.layers.items():
            if layer.ndim == 2:
                channels["Z" if name == "depth" else f"{name}.Y"] = layer
            else:
                for i, n in enumerate("XYZ" if name == "normal" else "RGB"):
                    channels[f"{name}.{n}"] = layer[..., i]
        channels = {k: np.ascontiguousarray(v, np.float32) for k, v in channels.items()}
        header = {
            "compression": OpenEXR.ZIP_COMPRESSION,
            "type": OpenEXR.scanlineimage,
            "eclat": json.dumps(self.metadata, default=str),
        }
        with OpenEXR.File(header, channels) as file:
            file.write(str(path))
