# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Tables of facts and short lists, which objects show in notebooks."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from html import escape


def facts_table(title: str, facts: Mapping[str, object]) -> str:
    """Return an HTML table with a title and a row for each fact; names and values are escaped."""
    rows = "".join(
        f'<tr><th style="text-align:left">{escape(str(name))}</th><td style="text-align:left">{escape(str(value))}</td></tr>'
        for name, value in facts.items()
    )
    return f"<table><caption><b>{escape(title)}</b></caption>{rows}</table>"


def listed(names: Iterable[str], most: int = 8) -> str:
    """List distinct names, or "none"; of more than `most`, the first ones and the number of the others."""
    distinct = list(dict.fromkeys(names))
    more = f" and {len(distinct) - most:,} more" if len(distinct) > most else ""
    return (", ".join(distinct[:most]) + more) or "none"
