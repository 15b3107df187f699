# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The gallery shows the pictures that its examples write: after each block of an example, the new .png and .jpg files
of its folder move to the site, side by side, with the names of the files as captions and for those who cannot see them.
What else an example writes is removed at its end."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

SHOWN = (".png", ".jpg")


def move_pictures(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Move the pictures that a block wrote, and return the reStructuredText that shows them."""
    folder = Path(block_vars["src_file"]).parent
    names = iter(block_vars["image_path_iterator"])
    shown: dict[Path, str] = {}
    # Numbers at the ends of names would be sorted as text; the order of writing is what the example means.
    for picture in sorted(folder.iterdir(), key=lambda path: path.stat().st_mtime_ns):
        if picture.suffix in SHOWN:
            target = Path(next(names)).with_suffix(picture.suffix)
            shutil.move(picture, target)
            shown[target] = picture.stem.replace("-", " ")
        elif picture.is_file() and picture.suffix not in (".py", ".rst", ".txt"):
            picture.unlink()
    return side_by_side(shown, Path(gallery_conf["src_dir"])) if shown else ""


def side_by_side(pictures: dict[Path, str], pages: Path) -> str:
    """Write reStructuredText that shows pictures in a row, each with its name below where there are several."""
    lines = ["", ".. container:: gallery-pictures", ""]
    for path, name in pictures.items():
        lines += [f"   .. figure:: /{path.relative_to(pages).as_posix()}", f"      :alt: {name}", ""]
        lines += [f"      {name}", ""] if len(pictures) > 1 else []
    return "\n".join([*lines, ""])


def _get_sg_image_scraper() -> Any:
    return move_pictures
