# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Files that a scene file names: found safely, read safely, with a stand-in for the image that cannot be read."""

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
from eclat.loaders.images import decode_image, read_image_file
from eclat.scene import Texture

# Two letters at least, so that a Windows drive (`C:`) is not taken for a scheme.
_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.\-]+:")
_DRIVE = re.compile(r"[A-Za-z]:")
_CONTROL = re.compile(r"[\x00-\x1f\x7f]")


class TextureOptions(TypedDict, total=False):
    """The fields of `Texture` that a caller may set beside the image and `srgb`."""

    wrap_u: Literal["repeat", "mirror", "clamp"]
    wrap_v: Literal["repeat", "mirror", "clamp"]
    filter: Literal["bilinear", "nearest"]
    name: str


def resolve(folder: Path, name: str, *, where: str, allow_parent: bool = False) -> Path:
    """The path of the file that a scene in `folder` calls `name`; it need not exist.

    Backslashes count as slashes, and where the exact name is absent a name that differs only in case is taken.

    Parameters
    ----------
    folder : the folder of the file that names the other one.
    name : a relative path, already percent-decoded.
    where : file and element for messages, e.g. ``"room.gltf, buffers[0]"``.
    allow_parent : let `name` leave the folder (OBJ and XML do that lawfully) and, where nothing is found there,
        take a file of the same base name beside the scene, with a warning. Without it, links that lead out of the
        folder are refused too.

    Raises
    ------
    EclatError : empty names, control characters, URLs; without `allow_parent` also absolute paths and escapes.
    """
    text = name.replace("\\", "/").strip()
    if not text or _CONTROL.search(text):
        raise EclatError(f"{where}: expected a file name, got {_shown(name)}")
    if _SCHEME.match(text):
        raise EclatError(f"{where}: expected a file beside the scene, got the URL {_shown(name)}")
    try:
        if allow_parent:
            return _resolve_anywhere(folder, text, where)
        return _resolve_inside(folder, text, where, name)
    except EclatError:
        raise
    except (OSError, ValueError, RuntimeError) as error:  # RuntimeError: Path.resolve on a loop of links
        raise EclatError(f"{where}: cannot look up {_shown(name)}: {error}") from None


def read_bytes(path: Path, *, where: str, limit: int = 1 << 32) -> bytes:
    """The bytes of a regular file of at most `limit` bytes; EclatError for anything else (missing, folder, pipe)."""
    return read_file(path, where=where, limit=limit)


def read_texture(
    path: Path,
    *,
    srgb: bool,
    where: str,
    neutral: tuple[float, float, float] | None = None,
    **options: Unpack[TextureOptions],
) -> Texture:
    """The texture in an image file, or, with a warning, a stand-in when it is missing or broken.

    The image gets 1, 3 or 4 channels: grey, RGB, RGBA (grey with alpha becomes RGBA), uint8, or float32 for files of
    more than 8 bits. Those whose format is linear by definition (EXR, HDR, PFM) get `srgb=False` whatever is asked.

    Parameters
    ----------
    srgb : the value for `Texture.srgb`.
    where : file and element for warnings.
    neutral : the one texel of the stand-in. Without it, colours (`srgb`) get a mauve and grey checker, so that one
        sees what is missing, and data gets 1, so that the parameter's constant acts alone.
    options : wrap_u, wrap_v, filter, name (default: the file's name).
    """
    options.setdefault("name", path.name)
    try:
        image, linear = read_image_file(path, read_bytes(path, where=where))
    except EclatError as error:
        return stand_in(str(error), srgb=srgb, where=where, neutral=neutral, **options)
    return Texture(_finite(image, where), srgb=srgb and not linear, **options)


def texture_from_bytes(
    data: bytes,
    *,
    srgb: bool,
    where: str,
    neutral: tuple[float, float, float] | None = None,
    **options: Unpack[TextureOptions],
) -> Texture:
    """The same as `read_texture` for the bytes of an encoded image (PNG, JPEG, …)."""
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
    """Warn that a texture is unusable for `reason`, and return what is shown instead (see `read_texture`)."""
    reason = reason.removeprefix(f"{where}: ")
    if neutral is None and srgb:
        warn(f"{where}: {reason}; a mauve and grey checker stands in")
        return Texture(_checker(), srgb=True, **options)
    texel = neutral or (1.0, 1.0, 1.0)
    warn(f"{where}: {reason}; the constant {texel} stands in")
    return Texture(np.array(texel, dtype=np.float32).reshape(1, 1, 3), srgb=False, **options)


def _resolve_inside(folder: Path, text: str, where: str, name: str) -> Path:
    tidy = posixpath.normpath(text)
    if text.startswith("/") or _DRIVE.match(text) or tidy == ".." or tidy.startswith("../"):
        raise EclatError(f"{where}: expected a file in the scene's folder, got {_shown(name)}, which leads out of it")
    path = _find(folder, tidy) or folder / tidy
    if not path.resolve().is_relative_to(folder.resolve()):
        raise EclatError(f"{where}: expected a file in the scene's folder, got {_shown(name)}, a link that leads out")
    return path


def _resolve_anywhere(folder: Path, text: str, where: str) -> Path:
    found = _find(folder, text)
    if found is not None:
        return found
    base = posixpath.basename(text.rstrip("/"))
    beside = _find(folder, base) if base and base != text else None
    if beside is not None:
        warn(f"{where}: {_shown(text)} does not exist; the file of that name in the scene's folder is used")
        return beside
    return folder / text


def _find(folder: Path, text: str) -> Path | None:
    """The path `folder / text` if it exists, else one that differs only in case, else None."""
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
    """8×8 fields of mauve and grey (sRGB bytes), two texels each so that bilinear filtering keeps the fields."""
    rows, columns = np.indices((16, 16)) // 2
    tones: NDArray[np.uint8] = np.array([[150, 144, 150], [196, 128, 178]], dtype=np.uint8)
    return np.take(tones, (rows + columns) % 2, axis=0)


def _finite(image: NDArray[Any], where: str) -> NDArray[Any]:
    """The image in which the largest finite value replaces +∞ and 0 replaces other values that are not finite, with a
    warning."""
    good = np.isfinite(image)
    if good.all():
        return image
    warn(f"{where}: {int((~good).any(axis=-1).sum())} texels are not finite; they are replaced")
    largest = image[good].max(initial=0)
    return np.where(good, image, np.where(image == np.inf, largest, 0)).astype(image.dtype)


def _shown(name: str) -> str:
    """A name for a message: quoted, and not longer than a line."""
    return repr(name if len(name) <= 100 else name[:97] + "...")
