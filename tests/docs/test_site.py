# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The documentation site builds without warnings, its links lead somewhere, it loads nothing from other hosts, and its
references are complete. The examples of the gallery run with little work; `make docs` runs them as they are."""

from __future__ import annotations

import importlib.util
import runpy
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import eclat
from eclat.cli import COMMANDS
from eclat.images.denoiser import has_denoiser
from support.page_blocks import ROOT
from support.small_work import make_small

pytestmark = pytest.mark.slow

EXAMPLES = sorted((ROOT / "examples/gallery").glob("plot_*.py"))
DEAR = ("plot_05_caustics", "plot_06_day")
"""Examples whose least work is many seconds; `make docs` runs them, too."""


@pytest.fixture(scope="module")
def builder() -> ModuleType:
    """The program that builds the site."""
    spec = importlib.util.spec_from_file_location("docs_builder", ROOT / "tools/docs.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The built site, without the pictures of the gallery."""
    pytest.importorskip("sphinx", reason="the site needs the extra `docs`")
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, str(ROOT / "tools/docs.py"), "--fast", "--output", str(folder / "html")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stdout + done.stderr
    return folder / "html"


def names_of(site: Path) -> set[str]:
    """The objects that the site documents, as `domain:role name`."""
    from sphinx.util.inventory import InventoryFile

    inventory = InventoryFile.loads((site / "objects.inv").read_bytes(), uri="")
    return {f"{kind} {name}" for kind, names in inventory.data.items() for name in names}


def test_the_site_has_a_page_of_scenes_to_walk_through(site: Path) -> None:
    # They are made by `make docs` only, because they take minutes.
    page = (site / "demo/index.html").read_text(encoding="utf-8")
    assert "no scenes" in page and "<iframe" not in page
    assert "../demo/index.html" in (site / "guides/index.html").read_text(encoding="utf-8")


def test_every_public_name_of_python_is_documented(site: Path) -> None:
    known = {entry.split(" ", 1)[1] for entry in names_of(site) if entry.startswith("py:")}
    assert {f"eclat.{name}" for name in eclat.__all__} <= known
    assert {"eclat.Image.save", "eclat.scene.Mesh", "eclat.IrradianceCache.weight"} <= known


def test_every_command_and_option_is_documented(site: Path) -> None:
    known = names_of(site)
    for name in COMMANDS:
        assert (site / f"reference/commands/eclat-{name}.html").exists()
        assert any(entry.startswith(f"std:cmdoption eclat-{name}.-") for entry in known), name
    assert "std:cmdoption eclat-render.--max-error" in known


def test_equations_citations_and_captions_are_rendered(site: Path) -> None:
    page = (site / "algorithms/irradiance_cache.html").read_text(encoding="utf-8")
    assert 'class="math notranslate' in page and "mathjax/tex-chtml.js" in page
    assert (site / "_static/mathjax/tex-chtml.js").exists()
    assert "references.html#" in page
    assert "<figcaption>" in page


def test_dead_links_and_foreign_hosts_are_found(builder: ModuleType, tmp_path: Path) -> None:
    (tmp_path / "a.html").write_text(
        '<a href="b.html">x</a><a href="#here">y</a><a href="https://a.org">z</a>', "utf-8"
    )
    (tmp_path / "c.html").write_text(
        '<p id="here"><a href="a.html#there">x</a><script src="//a.org/x.js"></script>', "utf-8"
    )
    (tmp_path / "d.html").write_text('<p id="here"><a href="c.html#here">x</a><img src="a.html">', "utf-8")
    assert list(builder.problems_of(tmp_path)) == [
        "a.html: b.html does not exist",
        "a.html: #here: no such place on that page",
        "c.html: loads //a.org/x.js from another host",
        "c.html: a.html#there: no such place on that page",
    ]


@pytest.mark.parametrize(
    "example",
    [pytest.param(path, marks=[pytest.mark.full] if path.stem in DEAR else [], id=path.stem) for path in EXAMPLES],
)
def test_example_of_the_gallery_runs(example: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if "denoise=True" in example.read_text(encoding="utf-8") and not has_denoiser():
        pytest.skip("the example needs Open Image Denoise")
    monkeypatch.chdir(tmp_path)
    make_small(monkeypatch)
    runpy.run_path(str(example))
    assert list(tmp_path.glob("*.png")), "an example without a picture"
