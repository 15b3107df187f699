# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Tables in notebooks."""

from __future__ import annotations

from dataclasses import replace

import eclat
from eclat.html import facts_table
from support.two_lamps import lamps_of_all_kinds


def test_names_and_values_are_escaped() -> None:
    table = facts_table("a & b", {"<x>": "<script>"})
    assert "<script>" not in table and "&lt;script&gt;" in table and "a &amp; b" in table and "&lt;x&gt;" in table


def test_scenes_and_solutions_show_themselves() -> None:
    scene = lamps_of_all_kinds()
    table = replace(scene, warnings=("<b>",))._repr_html_()
    for part in ("light, globe, bulb, sky", "cornell-box", "camera", "radiometric", "&lt;b&gt;", "triangles"):
        assert part in table, part
    solved = eclat.solve(eclat.load("furnace"), eclat.Radiosity(patches=50))
    table = solved._repr_html_()
    for part in ("RadiositySolution", "radiosity", "patches=50", "MB"):
        assert part in table, part
