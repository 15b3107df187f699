# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The settings of the documentation site, which `make docs` builds (`tools/docs.py`).

The pages are the Markdown files of this folder, which a git web page shows as well. Some pages are generated at each
build and are never committed: the gallery from `examples/gallery`, the reference of the command line from `--help`, the
reference of Python from docstrings, and copies of the pages in the root of the repository.
"""

from __future__ import annotations

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE / "_extensions"))

import eclat  # noqa: E402

project = "Éclat"
author = "the Éclat authors"
copyright = "the Éclat authors, Apache-2.0"
version = release = eclat.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
    "sphinxcontrib.bibtex",
    "captions",
    "citations",
    "commands",
    "docstrings",
    "mathjax_files",
    "project_pages",
    "python_reference",
    "repository_links",
    "viewer_demos",
]
exclude_patterns = [
    "_extensions",
    "README.md",
    "gallery/*.py",
    "gallery/*.ipynb",
    "**/sg_execution_times.rst",
    "sg_execution_times.rst",
]
suppress_warnings = [
    "config.cache",  # The settings of the gallery hold an object that cannot be compared.
]
nitpick_ignore_regex = [("py:.*", r"(numpy|np|collections|os|pathlib|NDArray).*")]

# Markdown -------------------------------------------------------------------------------------------------------------
myst_enable_extensions = ["deflist", "dollarmath"]
myst_fence_as_directive = ["math"]
myst_heading_anchors = 3
highlight_language = "text"

# Docstrings -----------------------------------------------------------------------------------------------------------
default_role = "literal"
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
python_maximum_signature_line_length = 72
python_use_unqualified_type_names = True
add_module_names = False

# References -----------------------------------------------------------------------------------------------------------
bibtex_bibfiles = ["references.bib"]
bibtex_default_style = "keyed"
bibtex_reference_style = "label"

# Gallery --------------------------------------------------------------------------------------------------------------
sphinx_gallery_conf = {
    "examples_dirs": [str(HERE.parent / "examples/gallery")],
    "gallery_dirs": ["gallery"],
    "filename_pattern": r"/plot_",
    "within_subsection_order": "FileNameSortKey",
    "image_scrapers": ("gallery_pictures",),
    "reset_modules": (),
    "capture_repr": (),
    "abort_on_example_error": True,
    "thumbnail_size": (320, 240),
    "min_reported_time": 10**6,
    "show_signature": False,
    "write_computation_times": False,
    "remove_config_comments": True,
}

# HTML -----------------------------------------------------------------------------------------------------------------
html_theme = "furo"
html_title = "Éclat"
html_favicon = "_static/logo.svg"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sourcelink = False
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#9a4b00", "color-brand-content": "#9a4b00"},
    "dark_css_variables": {"color-brand-primary": "#ffb466", "color-brand-content": "#ffb466"},
}
copybutton_prompt_text = r"^\$ "
copybutton_prompt_is_regexp = True

# Links ----------------------------------------------------------------------------------------------------------------
linkcheck_timeout = 20
linkcheck_anchors = False
