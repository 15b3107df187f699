# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The built page of the viewer."""

from __future__ import annotations

from pathlib import Path

import pytest

from eclat.errors import EclatError
from eclat.viewer.page import page_files
from support.browser import require_page


def test_the_page_is_installed_and_asks_no_other_server() -> None:
    require_page()
    files = page_files()
    assert "index.html" in files and any(name.endswith(".js") for name in files)
    page = files["index.html"].decode()
    # The policy of the server forbids scripts and styles within the page, and everything from elsewhere.
    assert "<style" not in page and "http:" not in page and "https:" not in page
    assert all("src=" in tag for tag in page.split("<script")[1:])


def test_without_a_built_page_it_says_what_to_do(tmp_path: Path) -> None:
    with pytest.raises(EclatError, match=r"the page of the viewer is missing.*Node\.js.*make page"):
        page_files(tmp_path)


def test_files_are_named_by_their_paths(tmp_path: Path) -> None:
    (tmp_path / "assets").mkdir()
    (tmp_path / "index.html").write_text("page")
    (tmp_path / "assets/a.js").write_text("script")
    (tmp_path / "notes.txt").write_text("not served")
    assert page_files(tmp_path) == {"index.html": b"page", "assets/a.js": b"script"}
