# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Links that are right in the repository lead to the pages of the site.

The pages link to files that a git web page shows; on the site, the examples of the gallery and the pages in the root of the
repository are pages of their own. Code such as `eclat render`, `eclat render --help` and `eclat.render` becomes a link to
the reference, which only the site has.
"""

from __future__ import annotations

import re
from pathlib import PurePosixPath

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.transforms import SphinxTransform

import eclat
from eclat.cli import COMMANDS
from project_pages import PAGES

LINK = re.compile(r"\]\(((?:\.\./)+)([\w./-]+)([^)\s]*)\)")
COMMAND = re.compile(r"^eclat ([a-z]+)(?: --help)?$")
NAME = re.compile(r"^eclat\.(\w+)(?:\(.*\))?$")


def in_page(app: Sphinx, docname: str, source: list[str]) -> None:
    """Replace links to files of the repository that are pages of the site."""
    depth = len(PurePosixPath(docname).parts)

    def of_link(match: re.Match[str]) -> str:
        up, path, rest = match.groups()
        if up.count("../") != depth:
            return match.group()
        home = "../" * (depth - 1)
        if path in PAGES:
            return f"]({home}project/{path.lower()}{rest})"
        if path.startswith("examples/gallery"):
            page = PurePosixPath(path).stem if path.endswith(".py") else "index"
            return f"]({home}gallery/{page}.rst{rest})"
        return match.group()

    if app.env.doc2path(docname).suffix == ".md":
        source[0] = LINK.sub(of_link, source[0])


class CodeLinks(SphinxTransform):
    """Links code that names a command or a public name of Python."""

    default_priority = 210

    def apply(self) -> None:
        here = self.env.docname
        for code in list(self.document.findall(nodes.literal)):
            text, parent = code.astext(), code.parent
            target = target_of(text)
            if (
                target is None
                or target == here
                or isinstance(parent, nodes.reference | addnodes.pending_xref | nodes.title)
            ):
                continue
            link = addnodes.pending_xref(
                "", refdomain="std", reftype="doc", reftarget=f"/{target}", refexplicit=True, refdoc=here, refwarn=True
            )
            parent.replace(code, link)
            link += code


def target_of(text: str) -> str | None:
    """The page of the reference about this code."""
    if (command := COMMAND.match(text)) and command.group(1) in COMMANDS:
        return f"reference/commands/eclat-{command.group(1)}"
    if (name := NAME.match(text)) and name.group(1) in eclat.__all__:
        return f"reference/python/eclat.{name.group(1)}"
    return None


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("source-read", in_page)
    app.add_transform(CodeLinks)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
