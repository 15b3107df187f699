# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""MathJax is shipped with the site, so that pages with equations ask no other host.

The files come from the package sphinx-mathjax-offline, of which only what is needed for TeX is copied.
"""

from __future__ import annotations

import shutil
from importlib.metadata import files
from pathlib import Path

from sphinx.application import Sphinx

NEEDED = ("tex-chtml.js", "output/chtml/fonts/woff-v2/")


def copy(app: Sphinx, error: Exception | None) -> None:
    """Copy MathJax and its fonts to the static files of the built site."""
    if error is not None or app.builder.format != "html":
        return
    for file in files("sphinx-mathjax-offline") or []:
        inside = file.as_posix().partition("static/mathjax/")[2]
        if inside.startswith(NEEDED):
            target = Path(app.outdir) / "_static/mathjax" / inside
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(str(file.locate()), target)


def setup(app: Sphinx) -> dict[str, bool]:
    app.config.mathjax_path = "mathjax/tex-chtml.js"
    app.config.mathjax3_config = {"options": {"enableMenu": False}}
    app.config.mathjax4_config = {}
    app.connect("build-finished", copy)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
