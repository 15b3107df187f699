# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The gallery shows the pictures that its examples write: after each block of an example, the new .png and .jpg files
of its folder move to the site. What else an example writes is removed at its end."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

from sphinx_gallery.scrapers import figure_rst

SHOWN = (".png", ".jpg")


def move_pictures(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """Move the pictures that a block wrote, and return the reStructuredText that shows them."""
    folder = Path(block_vars["src_file"]).parent
    names = iter(block_vars["image_path_iterator"])
    shown = []
    # Numbers at the ends of names would be sorted as text; the order of writing is what the example means.
    for picture in sorted(folder.iterdir(), key=lambda path: path.stat().st_mtime_ns):
        if picture.suffix in SHOWN:
            target = Path(next(names)).with_suffix(picture.suffix)
            shutil.move(picture, target)
            shown.append(target)
        elif picture.is_file() and picture.suffix not in (".py", ".rst", ".txt"):
            picture.unlink()
    return figure_rst([str(path) for path in shown], gallery_conf["src_dir"]) if shown else ""


def _get_sg_image_scraper() -> Any:
    return move_pictures
