# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The built page of the viewer. `make install` builds it from `web/view` into the folder `page` beside this module,
which the wheel contains. It is not under version control: it is half a megabyte of generated text, which would change
with every change of its sources."""

from __future__ import annotations

from pathlib import Path

from eclat.errors import EclatError

PAGE = Path(__file__).resolve().parent / "page"
"""The folder of the built page."""

TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
}
"""Maps the suffixes of the page's files to their media types."""


def page_files(folder: Path = PAGE) -> dict[str, bytes]:
    """Read the files of the page, by their paths below the page with forward slashes.

    Raises EclatError if the page was not built when Éclat was installed.
    """
    if not (folder / "index.html").is_file():
        raise EclatError(
            "view: the page of the viewer is missing, because Éclat was installed from its sources without Node.js. "
            "Install Node.js 20 or newer, and run `make page` and `make install` in the folder of the sources"
        )
    files = [path for path in sorted(folder.rglob("*")) if path.is_file() and path.suffix in TYPES]
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}
