# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The comparison page: one file, well-formed, with everything in it."""

from __future__ import annotations

import base64
import dataclasses
import io
import re
import sys
from html import escape
from html.parser import HTMLParser
from pathlib import Path

import PIL.Image
import pytest

from eclat.loaders import load
from eclat.methods import METHODS
from eclat.report.compare_page import FLIP_MISSING, compare_page, error_scale, percent
from eclat.verbs.compare import Comparison, Effort, compare
from support.fake_api import FakeApi

VOID = {"meta", "img", "line", "circle", "rect", "path", "polyline", "br"}


@pytest.fixture
def comparison(monkeypatch: pytest.MonkeyPatch) -> Comparison:
    FakeApi(monkeypatch)
    return compare(load("cornell-box"), ["path", "irradiance-cache"], effort=Effort(3, 16), size=(40, 30))


class Checker(HTMLParser):
    """Collects tags and fails where they do not nest."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag


def parsed(page: str) -> Checker:
    checker = Checker()
    checker.feed(page)
    checker.close()
    assert checker.open == []
    return checker


def test_tags_nest_and_nothing_is_fetched(comparison: Comparison) -> None:
    page = compare_page(comparison)
    tags = parsed(page).tags
    assert not [tag for tag, _ in tags if tag in ("script", "link", "iframe")]
    sources = [attributes.get("src") or attributes.get("href") for _, attributes in tags]
    assert all(source.startswith("data:image/png;base64,") for source in sources if source)
    assert "url(" not in page and "http" not in page


def test_pictures_are_embedded_at_their_size(comparison: Comparison) -> None:
    images = [attributes for tag, attributes in parsed(compare_page(comparison)).tags if tag == "img"]
    named = {attributes["alt"]: attributes for attributes in images}
    methods = ("path", "irradiance-cache")
    expected = {f"{method}: {what}" for method in methods for what in ("picture", "signed error")}
    assert expected | {"reference: picture", "reference: noise"} <= set(named)
    for name in expected:
        data = base64.b64decode((named[name]["src"] or "").removeprefix("data:image/png;base64,"))
        with PIL.Image.open(io.BytesIO(data)) as picture:
            assert picture.size == (40, 30)


def test_the_table_has_a_row_for_each_level(comparison: Comparison) -> None:
    page = compare_page(comparison)
    assert page.count("<tr") == 1 + 6
    assert percent(comparison.results[0].measurements[-1].error) in page


def test_every_method_says_what_it_cannot_do(comparison: Comparison) -> None:
    said = {method: options.cannot for method, options in METHODS.items()}
    assert len(set(said.values())) == len(METHODS)
    page = compare_page(comparison)
    assert all((escape(said[method]) in page) == (method in ("path", "irradiance-cache")) for method in METHODS)


def test_names_from_files_cannot_break_the_page(comparison: Comparison) -> None:
    page = compare_page(dataclasses.replace(comparison, scene="<script>alert('x')</script>&"))
    parsed(page)
    assert "<script" not in page


def test_without_flip_the_page_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "flip_evaluator", None)
    FakeApi(monkeypatch)
    page = compare_page(compare(load("cornell-box"), ["path"], effort=Effort(1), size=(8, 8)))
    assert FLIP_MISSING in page
    assert "path: FLIP" not in page


def test_one_scale_serves_all_methods(comparison: Comparison) -> None:
    scale = error_scale(comparison)
    least = min(result.measurements[-1].error for result in comparison.results)
    assert 3 * least <= scale <= 7.5 * least
    assert re.fullmatch(r"[125]e[+-]\d+", f"{scale:.0e}")
    assert f"{100 * scale:g} % too bright" in compare_page(comparison)


def test_percentages_have_three_digits() -> None:
    values = (None, float("nan"), 0.0, 0.01234, 0.3, 0.9999, 12.0)
    assert [percent(v) for v in values] == ["–", "–", "0.00 %", "1.23 %", "30.0 %", "100 %", "1200 %"]


def test_the_page_opens_in_a_browser(comparison: Comparison, tmp_path: Path) -> None:
    (tmp_path / "a.html").write_text(compare_page(comparison), encoding="utf-8")
    assert (tmp_path / "a.html").read_text(encoding="utf-8").startswith('<!doctype html>\n<html lang="en">')
