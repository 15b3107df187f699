# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Find and read the files that a scene file names, safely. Images that cannot be read are replaced by a stand-in."""

from __future__ import annotations

import os
import posixpath
import re
from pathlib import Path
from typing import Any, Literal, TypedDict, Unpack

import numpy as np
from numpy.typing import NDArray

from eclat.errors import EclatError, warn
from eclat.files.arrays import read_file
from eclat.files.confinement import check_confined, is_outside
from eclat.loaders.budget import count_file
from eclat.loaders.images import decode_image, read_image_file
from eclat.scene import Texture

# A scheme has at least two letters here, so that a Windows drive (`C:`) is not taken for one.
_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.\-]+:")
_DRIVE = re.compile(r"[A-Za-z]:")
_CONTROL = re.compile(r"[\x00-\x1f\x7f]")


class TextureOptions(TypedDict, total=False):
    """The fields of `Texture` that a caller may set, in addition to the image and `srgb`."""

    wrap_u: Literal["repeat", "mirror", "clamp"]
    wrap_v: Literal["repeat", "mirror", "clamp"]
    filter: Literal["bilinear", "nearest"]
    name: str


def resolve(folder: Path, name: str, *, where: str, allow_parent: bool = False) -> Path:
    """Find the path of the file that a scene in `folder` calls `name`. The file need not exist.

    Backslashes count as slashes. If no file has the exact name, one whose name differs only in case is used.

    Parameters
    ----------
    folder : the folder of the scene file.
    name : a relative path, already percent-decoded.
    where : file and element for messages, e.g. ``"room.gltf, buffers[0]"``.
    allow_parent : whether `name` may lead out of the folder, as the OBJ and XML formats allow. If no such file
        exists, a file of the same base name in the folder is used, with a warning. If False, symbolic links that lead
        out of the folder are refused too.

    Raises
    ------
    EclatError : the name is empty, contains control characters or is a URL. Without `allow_parent`, also if it is an
        absolute path or leads out of the folder. With it, if it leads out of the root folder (`eclat.files.confinement`).
    """
    text = name.replace("\\", "/").strip()
    if not text or _CONTROL.search(text):
        raise EclatError(f"{where}: expected a file name, got {_shown(name)}")
    if _SCHEME.match(text):
        raise EclatError(f"{where}: expected the name of a local file, got the URL {_shown(name)}")
    try:
        if allow_parent:
            return _resolve_anywhere(folder, text, where)
        return _resolve_inside(folder, text, where, name)
    except EclatError:
        raise
    except (OSError, ValueError, RuntimeError) as error:  # RuntimeError: Path.resolve on a loop of links
        raise EclatError(f"{where}: cannot look up {_shown(name)}: {error}") from None


def read_bytes(path: Path, *, where: str, limit: int = 1 << 32) -> bytes:
    """Read a regular file of at most `limit` bytes.

    Raises EclatError if it does not exist, cannot be read, is larger, or is no regular file (a folder, a pipe).
    """
    data = read_file(path, where=where, limit=limit)
    count_file(path, len(data))
    return data


def read_texture(
    path: Path,
    *,
    srgb: bool,
    where: str,
    neutral: tuple[float, float, float] | None = None,
    **options: Unpack[TextureOptions],
) -> Texture:
    """Read a texture from an image file. If the file is missing or invalid, warn and return a stand-in.

    The image of the texture has 1 channel (grey), 3 (RGB) or 4 (RGBA, also for grey with alpha). Its type is uint8,
    or float32 for files of more than 8 bits per channel.

    Parameters
    ----------
    path : the image file.
    srgb : the value of `Texture.srgb`. It is ignored for formats that are linear by definition (EXR, HDR, PFM), whose
        textures have `srgb=False`.
    where : file and element for warnings.
    neutral : the RGB value of the stand-in. If it is None, the stand-in is a mauve and grey checkerboard for colours
        (`srgb`), so that the missing texture is easy to see. For other data it is 1, so that the constant which the
        texture multiplies is used alone.
    options : wrap_u, wrap_v, filter, and name, whose default is the name of the file.
    """
    options.setdefault("name", path.name)
    try:
        image, linear = read_image_file(path, read_bytes(path, where=where))
    except EclatError as error:
        return stand_in(str(error), srgb=srgb, where=where, neutral=neutral, **options)
    return Texture(finite_texels(image, where), srgb=srgb and not linear, **options)


def texture_from_bytes(
    data: bytes,
    *,
    srgb: bool,
    where: str,
    neutral: tuple[float, float, float] | None = None,
    **options: Unpack[TextureOptions],
) -> Texture:
    """Decode a texture from the bytes of an image in a format such as PNG or JPEG. All else is as in `read_texture`."""
    try:
        return Texture(decode_image(data), srgb=srgb, **options)
    except EclatError as error:
        return stand_in(str(error), srgb=srgb, where=where, neutral=neutral, **options)


def stand_in(
    reason: str,
    *,
    srgb: bool,
    where: str,
    neutral: tuple[float, float, float] | None = None,
    **options: Unpack[TextureOptions],
) -> Texture:
    """Warn that a texture cannot be used, with the `reason`, and return a stand-in (see `read_texture`)."""
    reason = reason.removeprefix(f"{where}: ")
    if neutral is None and srgb:
        warn(f"{where}: {reason}; a mauve and grey checkerboard is used instead")
        return Texture(_checker(), srgb=True, **options)
    texel = neutral or (1.0, 1.0, 1.0)
    warn(f"{where}: {reason}; the constant {texel} is used instead")
    return Texture(np.array(texel, dtype=np.float32).reshape(1, 1, 3), srgb=False, **options)


def _resolve_inside(folder: Path, text: str, where: str, name: str) -> Path:
    tidy = posixpath.normpath(text)
    if text.startswith("/") or _DRIVE.match(text) or tidy == ".." or tidy.startswith("../"):
        raise EclatError(f"{where}: expected a file in the scene's folder, got {_shown(name)}, which leads out of it")
    path = _find(folder, tidy) or folder / tidy
    if not path.resolve().is_relative_to(folder.resolve()):
        raise EclatError(
            f"{where}: expected a file in the scene's folder, got {_shown(name)}, a symbolic link that leads out of it"
        )
    return path


def _resolve_anywhere(folder: Path, text: str, where: str) -> Path:
    # What lies outside the root folder is not looked for, so that no message tells what is there.
    outside = is_outside(folder / text)
    found = None if outside else _find(folder, text)
    if found is not None:
        return found
    base = posixpath.basename(text.rstrip("/"))
    beside = _find(folder, base) if base and base != text else None
    if beside is not None:
        reason = "lies outside the root folder" if outside else "does not exist"
        warn(f"{where}: {_shown(text)} {reason}; the file {_shown(base)} in the scene's folder is used instead")
        return beside
    check_confined(folder / text, where, text)
    return folder / text


def _find(folder: Path, text: str) -> Path | None:
    """Return the path `folder / text` if it exists, otherwise a path that differs only in case, otherwise None."""
    exact = folder / text
    if exact.exists():
        return exact
    path = Path("/") if text.startswith("/") else folder
    for part in text.split("/"):
        if part in ("", "."):
            continue
        if part != ".." and not (path / part).exists():
            try:
                names = sorted(entry for entry in os.listdir(path) if entry.casefold() == part.casefold())
            except OSError:
                return None
            if not names:
                return None
            part = names[0]
        path = path / part
    return path if path.exists() else None


def _checker() -> NDArray[np.uint8]:
    """Return a checkerboard (16, 16, 3) of mauve and grey squares in sRGB bytes.

    Each square has 2 × 2 texels, so that bilinear filtering does not blur it away.
    """
    rows, columns = np.indices((16, 16)) // 2
    tones: NDArray[np.uint8] = np.array([[150, 144, 150], [196, 128, 178]], dtype=np.uint8)
    return np.take(tones, (rows + columns) % 2, axis=0)


def finite_texels(image: NDArray[Any], where: str) -> NDArray[Any]:
    """Replace +∞ by the largest finite value of the image, and NaN and −∞ by 0, with a warning."""
    good = np.isfinite(image)
    if good.all():
        return image
    warn(
        f"{where}: {int((~good).any(axis=-1).sum())} texels are not finite; infinity is replaced by the largest finite "
        "value, and NaN by 0"
    )
    largest = image[good].max(initial=0)
    return np.where(good, image, np.where(image == np.inf, largest, 0)).astype(image.dtype)


def _shown(name: str) -> str:
    """Quote `name` for a message, and shorten it to 100 characters."""
    return repr(name if len(name) <= 100 else name[:97] + "...")
