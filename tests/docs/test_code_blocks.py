# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Every command and every block of code on the pages runs, in the order in which they stand, but for those that a visible
mark says cannot."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

import pytest

from eclat.gltf_export import encode_glb
from eclat.scenes import build
from support.brdf_files import merl_file, shiny_paint
from support.gltf_files import moving_file
from support.page_blocks import ROOT, blocks_of, run_block, write_command
from support.small_work import make_small, smaller

GENERATED = ("gallery", "project", "reference")
"""Folders of docs/ that a build of the site writes."""

MOST_MARKED = 23
"""Blocks that are marked as not run. Whoever adds one has a reason that no test can remedy, and raises this number."""

ROOM = """mtllib room.mtl
v 0 0 0
v 4 0 0
v 4 0 4
v 0 0 4
o floor
usemtl floor
f 4 3 2 1
"""


def pages() -> list[Path]:
    """All pages with blocks, but for those that a build writes."""
    docs = [
        page
        for page in sorted((ROOT / "docs").rglob("*.md"))
        if page.relative_to(ROOT / "docs").parts[0] not in GENERATED
    ]
    return [page for page in [ROOT / "README.md", *docs] if blocks_of(page)]


def give_files(page: Path) -> None:
    """Write the files that a page takes for granted: a reader's own scenes. Pages for beginners take nothing for
    granted."""
    if page.parent.name == "get_started":
        return
    room = encode_glb(build("cornell-box"))
    Path("upload").mkdir()
    for name in ("room.glb", "upload/room.glb"):
        Path(name).write_bytes(room)
    for name in ("hall.obj", "upload/room.obj", "room.obj"):
        Path(name).write_text(ROOM, encoding="utf-8")
        Path(name).with_name("room.mtl").write_text("newmtl floor\nKd 0.5 0.5 0.5\n", encoding="utf-8")
    sphere = '<scene version="3.0.0"><shape type="sphere"/></scene>'
    for name in ("scene.xml", "upload/room.xml", "sibenik/nave.xml", "sponza-dabrovic/sun.xml"):
        Path(name).parent.mkdir(exist_ok=True)
        Path(name).write_text(sphere, encoding="utf-8")
    for name in ("walk.glb", "scene.glb"):
        moving_file(Path(), name)
    if "gold-metallic-paint.binary" in page.read_text(encoding="utf-8"):
        Path("gold-metallic-paint.binary").write_bytes(merl_file(shiny_paint()))
    for name in ("points.csv", "desks.csv"):
        Path(name).write_text("0 0 0 0 1 0\n0.5 0 0 0 1 0\n", encoding="utf-8")


@pytest.mark.parametrize("page", pages(), ids=lambda page: page.relative_to(ROOT).as_posix())
def test_blocks_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder, commands = tmp_path / "here", tmp_path / "commands"
    folder.mkdir()
    write_command(commands, "support.small_work")
    monkeypatch.chdir(folder)
    monkeypatch.setenv("ECLAT_PAGE", "1")
    give_files(page)
    make_small(monkeypatch)
    names: dict[str, Any] = {"__name__": "__page__"}
    for block in blocks_of(page):
        if not block.reason:
            run_block(block, names, commands)


def test_marked_blocks_are_few_and_say_why() -> None:
    marked = [block for page in pages() for block in blocks_of(page) if block.reason]
    for block in marked:
        assert len(block.reason.split()) >= 3, f"{block.where}: the reason is no sentence"
    assert len(marked) <= MOST_MARKED, "\n".join(f"{block.where}: {block.reason}" for block in marked)


def test_mark_is_read(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        "*Not run by the tests: it needs\na network.*\n\n```sh\na\n```\n\n```sh\nb\n```\n\n```text\nc\n```\n", "utf-8"
    )
    assert [(block.code, block.reason) for block in blocks_of(page)] == [("a\n", "it needs a network"), ("b\n", "")]


def test_failing_command_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = ROOT / "docs/index.md"
    monkeypatch.chdir(tmp_path)
    write_command(tmp_path / "commands", "support.small_work")
    block = blocks_of(page)[0]
    for code in ("eclat render no-such-scene\ntrue\n", "false | true\n"):
        with pytest.raises(AssertionError, match=re.escape(block.where)):
            run_block(type(block)(page, block.line, "sh", code, ""), {}, tmp_path / "commands")


def test_small_work_keeps_the_command() -> None:
    assert smaller(["render", "room.glb", "--samples", "64", "-o", "x.png"]) == (
        ["render", "room.glb", "--samples", "4", "-o", "x.png", "--size", "32x24", "--max-error", "0.2"]
    )
    assert smaller(["render", "room.glb", "--continue", "x.exr", "--max-error", "0.01"])[-1] == "0.2"
    assert smaller(["scenes"]) == ["scenes"]
    assert os.environ.get("ECLAT_PAGE") is None
