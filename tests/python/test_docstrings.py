# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The examples in the docstrings of all modules run, and give what they say."""

from __future__ import annotations

import doctest
import importlib
import pkgutil
from pathlib import Path

import pytest

import eclat
from eclat.gltf_export import encode_glb
from eclat.scenes import build


def modules_with_examples() -> list[str]:
    """Names of the modules of the package whose text has examples; found without importing any of them."""
    found = pkgutil.walk_packages(eclat.__path__, "eclat.", onerror=lambda name: None)
    return [module.name for module in found if ">>> " in source_of(module)]


def source_of(module: pkgutil.ModuleInfo) -> str:
    spec = module.module_finder.find_spec(module.name, None)
    if spec is None or spec.origin is None or not spec.origin.endswith(".py"):
        return ""
    return Path(spec.origin).read_text(encoding="utf-8")


@pytest.mark.parametrize("name", modules_with_examples())
def test_examples_give_what_they_say(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("room.glb").write_bytes(encode_glb(build("furnace")))  # the file that an example loads
    failed, attempted = doctest.testmod(importlib.import_module(name))
    assert attempted > 0, "the examples stand where doctest does not look"
    assert failed == 0
