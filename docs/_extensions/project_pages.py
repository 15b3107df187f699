# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Copies of the pages in the root of the repository, so that the site has them too: `project/changelog.md` and others.

They are written at each build. Links to pages of `docs/` are adjusted; names of other files become code.
"""

from __future__ import annotations

import re
from pathlib import Path

from sphinx.application import Sphinx

ROOT = Path(__file__).resolve().parent.parent.parent
PAGES = ("CHANGELOG.md", "ARCHITECTURE.md", "CONTRIBUTING.md")
LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")


def adjusted(text: str) -> str:
    """Rewrite the links of a page in the root for its copy in docs/project."""

    def of_link(match: re.Match[str]) -> str:
        mark, label, target = match.groups()
        path, hash_mark, anchor = target.partition("#")
        if path.startswith(("http:", "https:", "mailto:")) or not path:
            return match.group()
        if path.startswith("docs/"):
            path = "../" + path.removeprefix("docs/")
        elif path in PAGES:
            path = path.lower()
        else:
            return f"`{path}`"
        return f"{mark}[{label}]({path}{hash_mark}{anchor})"

    return LINK.sub(of_link, text)


def write_if_changed(target: Path, text: str) -> None:
    """Write a generated page, but leave it alone if it is the same, so that it is not read again."""
    target.parent.mkdir(parents=True, exist_ok=True)
    if not target.exists() or target.read_text(encoding="utf-8") != text:
        target.write_text(text, encoding="utf-8")


def write_pages(app: Sphinx) -> None:
    for name in PAGES:
        text = (ROOT / name).read_text(encoding="utf-8")
        write_if_changed(Path(app.srcdir) / "project" / name.lower(), adjusted(text))


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("builder-inited", write_pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
