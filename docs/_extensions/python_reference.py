# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The reference of Python: one page for each public name, `reference/python/eclat.render.rst`, grouped by what the name
is. The pages are written at each build from `eclat.__all__`, so that no name can be missing."""

from __future__ import annotations

import inspect
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx
from sphinx.pycode import ModuleAnalyzer

import eclat
from project_pages import write_if_changed

GROUPS = {
    "Functions": "Every function accepts a scene, the path of a scene file or the name of a built-in scene.",
    "Methods": "A method is a value with its options. All are used in the same way.",
    "Values": "What functions take and return.",
    "Data": "Constants.",
    "Errors and warnings": "Mistakes of the user raise `EclatError`; what is replaced or guessed warns `EclatWarning`.",
}

MODULES = {
    "eclat.scene": "The parts of a scene: meshes, materials, lights and cameras.",
    "eclat.scenes": "The built-in scenes.",
    "eclat.daylight.sky": "The sun and the sky.",
    "eclat.measure.metrics": "The error of a picture.",
    "eclat.measure.photometry": "From radiometry to photometry.",
    "eclat.harmonics": "Spherical and hemispherical harmonics.",
    "eclat.brdf_table": "Tables of reflection.",
}
"""Modules with public names of their own."""

CLASS = """.. autoclass:: {name}
    :members:
    :inherited-members: Mapping, object
"""


def kind_of(value: Any) -> str:
    """The group of a public name."""
    if inspect.isclass(value):
        if issubclass(value, BaseException):
            return "Errors and warnings"
        return "Methods" if issubclass(value, eclat.Method) else "Values"
    return "Functions" if callable(value) else "Data"


def page_of(name: str, value: Any) -> str:
    """Return the page of one public name."""
    title = name.removeprefix("eclat.")
    if inspect.isclass(value):
        directive = CLASS.format(name=name)
    elif callable(value):
        directive = f".. autofunction:: {name}\n"
    else:
        directive = f".. py:data:: {name}\n\n" + "".join(f"    {line}\n" for line in comment_of(title))
        if isinstance(value, Mapping):
            directive += "\n    Its keys are " + ", ".join(f"``{key}``" for key in value) + ".\n"
    return f"{title}\n{'=' * len(title)}\n\n{directive}"


def comment_of(name: str) -> list[str]:
    """Return the string below the definition of a public constant."""
    found = ModuleAnalyzer.for_module(eclat._HOMES[name]).find_attr_docs()
    return next((lines for (_, attribute), lines in found.items() if attribute == name), [])


def summary_of(name: str, value: Any) -> str:
    """Return the first sentence of a docstring, as one line."""
    documented = inspect.isclass(value) or callable(value)
    text = (inspect.getdoc(value) or "") if documented else "\n".join(comment_of(name))
    sentence = re.split(r"(?<=\.)\s", " ".join(text.split("\n\n")[0].split()))[0]
    return sentence


def index_of(groups: dict[str, dict[str, Any]]) -> str:
    """Return the page that lists all public names."""
    text = "Python\n======\n\nEverything here is reached from ``import eclat``.\n"
    for title, sentence in GROUPS.items():
        if title not in groups:
            continue
        text += f"\n{title}\n{'-' * len(title)}\n\n{sentence}\n"
        for name, value in groups[title].items():
            text += f"\n:doc:`{name} <eclat.{name}>`\n    {summary_of(name, value)}\n"
        entries = "".join(f"    eclat.{name}\n" for name in groups[title])
        text += f"\n.. toctree::\n    :hidden:\n\n{entries}"
    text += "\nModules\n-------\n\n"
    text += "".join(f"\n:doc:`{name}`\n    {meaning}\n" for name, meaning in MODULES.items())
    return text + "\n.. toctree::\n    :hidden:\n\n" + "".join(f"    {name}\n" for name in MODULES)


def write_pages(app: Sphinx) -> None:
    folder = Path(app.srcdir) / "reference/python"
    groups: dict[str, dict[str, Any]] = {}
    pages = {}
    for name in eclat.__all__:
        value = getattr(eclat, name)
        groups.setdefault(kind_of(value), {})[name] = value
        pages[f"eclat.{name}"] = page_of(f"eclat.{name}", value)
    for name in MODULES:
        pages[name] = f"{name}\n{'=' * len(name)}\n\n.. automodule:: {name}\n    :members:\n"
        if name == "eclat.scene":
            pages[name] += "    :exclude-members: Scene\n"  # It has a page of its own, as `eclat.Scene`.
    pages["index"] = index_of(groups)
    for stale in set(folder.glob("*.rst")) - {folder / f"{name}.rst" for name in pages}:
        stale.unlink()
    for name, text in pages.items():
        write_if_changed(folder / f"{name}.rst", text)


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("builder-inited", write_pages)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
