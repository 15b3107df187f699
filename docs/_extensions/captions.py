# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A paragraph that is one picture becomes a figure, and a paragraph in italics right below it becomes its caption.

So pages stay plain Markdown, which a git web page shows as well.
"""

from __future__ import annotations

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.transforms import SphinxTransform


class Captions(SphinxTransform):
    """Makes figures; runs before pictures are collected."""

    default_priority = 400

    def apply(self) -> None:
        for paragraph in list(self.document.findall(nodes.paragraph)):
            if not (len(paragraph) == 1 and isinstance(paragraph[0], nodes.image)):
                continue
            parent = paragraph.parent
            if not isinstance(parent, nodes.section | nodes.document):
                continue
            place = parent.index(paragraph)
            picture = paragraph[0]
            figure = nodes.figure("", picture, align="default")
            below = parent[place + 1] if place + 1 < len(parent) else None
            if is_caption(below):
                parent.remove(below)
                figure += nodes.caption("", "", *below[0].children if len(below) == 1 else below.children)
            self.document.set_id(figure)
            parent.replace(paragraph, figure)


def is_caption(node: nodes.Node | None) -> bool:
    """Whether a paragraph begins in italics."""
    return isinstance(node, nodes.paragraph) and len(node) > 0 and isinstance(node[0], nodes.emphasis)


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_transform(Captions)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
