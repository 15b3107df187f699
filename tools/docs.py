#!/usr/bin/env python3
# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Builds the documentation site into build/docs/html, with warnings as errors, and checks its links.

tools/docs.py                    the whole site; the examples of the gallery that changed are run
tools/docs.py --fast             without running any example of the gallery, and without scenes to walk through
tools/docs.py --external-links   also asks every other host that the pages link to, for which a network is needed
tools/docs.py --output FOLDER    writes the site to another folder

It needs what the extra `docs` of pyproject.toml installs; `make docs` sets up all of it.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

ROOT = Path(__file__).resolve().parent.parent
LOADED = {"img": "src", "script": "src", "iframe": "src", "source": "src", "video": "src"}
"""What a browser loads by itself, by the attribute that names it. So do `link`s, but for a few relations."""

NOT_LOADED = {"canonical", "index", "search", "next", "prev", "author", "genindex", "license"}

FAST = ("-D", "plot_gallery=0", "-D", "viewer_demos=0")
"""Options of Sphinx that leave out what takes minutes."""


class Page(HTMLParser):
    """What a page links to, what it loads, and which anchors it has."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.anchors: set[str] = set()
        self.feed(text)

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        known = {name: value or "" for name, value in attributes}
        self.anchors.update(known[name] for name in ("id", "name") if name in known)
        if tag == "a" and "href" in known:
            self.links.append(known["href"])
        if tag == "link" and not NOT_LOADED & set(known.get("rel", "").split()):
            self.loads.append(known["href"])
        if tag in LOADED and LOADED[tag] in known:
            self.loads.append(known[LOADED[tag]])


def problems_of(site: Path) -> Iterator[str]:
    """Name every link inside the site that leads nowhere, and everything that a page loads from another host."""
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in sorted(site.rglob("*.html"))}
    for path, page in pages.items():
        name = path.relative_to(site).as_posix()
        yield from (f"{name}: loads {url} from another host" for url in page.loads if urlsplit(url).netloc)
        for url in [*page.links, *page.loads]:
            parts = urlsplit(url)
            if parts.scheme or parts.netloc:
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            target = target / "index.html" if target.is_dir() else target
            if not target.exists():
                yield f"{name}: {url} does not exist"
            elif parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].anchors:
                yield f"{name}: {url}: no such place on that page"


def build(builder: str, output: Path, *options: str) -> int:
    """Run Sphinx with warnings as errors and return its exit code."""
    trees = ROOT / "build/docs/doctrees"
    command = [sys.executable, "-m", "sphinx", "-b", builder, "-W", "--keep-going", "-q", "-d", trees, *options]
    # Chosen here, because the examples of the gallery shall not depend on the caller's terminal.
    return subprocess.run(
        [*map(str, command), str(ROOT / "docs"), str(output)], env={**os.environ, "COLUMNS": "100"}
    ).returncode


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--fast",
        action="store_true",
        help="leave out the pictures of the gallery and the scenes to walk through",
    )
    parser.add_argument("--external-links", action="store_true", help="also check links to other hosts")
    parser.add_argument("--output", type=Path, default=ROOT / "build/docs/html", help="folder to write")
    arguments = parser.parse_args()
    options = list(FAST) if arguments.fast else []
    if (arguments.output / ".buildinfo").exists():
        for page in arguments.output.rglob("*.html"):
            page.unlink()  # Pages whose source is gone would stay.
    failed = build("html", arguments.output, *options) != 0
    problems = list(problems_of(arguments.output))
    print("".join(f"{problem}\n" for problem in problems), end="")
    if arguments.external_links:
        failed |= build("linkcheck", arguments.output.parent / "linkcheck", *FAST) != 0
    if failed or problems:
        print("tools/docs.py: FAILED")
        return 1
    print(f"tools/docs.py: {len(list(arguments.output.rglob('*.html')))} pages in {arguments.output}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
