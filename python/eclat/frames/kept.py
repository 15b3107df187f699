# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Finished frames: what each was made from is in its metadata, so that it can be kept when an animation is started again."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import eclat
from eclat.errors import EclatError
from eclat.images.image import Image
from eclat.images.image_files import read_png_metadata

KEY = "frame"
"""The key of the metadata of a frame."""
FORMAT = 3
"""Version of what a frame is made of, which is incremented whenever the same settings give another picture or file."""


def fingerprint_of(parts: Mapping[str, Any]) -> str:
    """Compute a hash of what a frame is made from, in types that JSON can represent, and of the version of Éclat."""
    text = json.dumps({**parts, "format": FORMAT, "version": eclat.__version__}, sort_keys=True, default=repr)
    return hashlib.sha256(text.encode()).hexdigest()[:32]


def is_finished(path: Path, fingerprint: str) -> bool:
    """Return whether the frame exists and was made from what the fingerprint says.

    Raises
    ------
    EclatError : the file exists, but was made from something else.
    """
    if not path.exists():
        return False
    try:
        image = path.suffix.lower() == ".exr"
        metadata = Image.load(path).metadata if image else read_png_metadata(path)
    except EclatError as error:
        raise EclatError(f"{path}: expected a frame of this animation, got another file ({error}); {_WAYS}") from None
    made = metadata.get(KEY)
    if not isinstance(made, dict) or made.get("fingerprint") != fingerprint:
        raise EclatError(
            f"{path}: expected a frame of this animation, got a picture of another scene or with other settings; {_WAYS}"
        )
    return True


_WAYS = "pass overwrite (--overwrite) to replace it, or choose another name"
