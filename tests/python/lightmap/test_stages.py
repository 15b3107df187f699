# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The progress of a bake: it begins before any work, and names each of its parts."""

from __future__ import annotations

import pytest

import eclat
from eclat.lightmap import layout as layout_module
from eclat.lightmap.stages import stage


def test_stages_report_their_shares() -> None:
    said: list[tuple[str, float]] = []
    told = stage(lambda phase, fraction, statistics: said.append((phase, fraction)), "texels")
    assert told is not None
    told(0.5)
    assert said == [("texels", 0.0), ("texels", 0.5)]
    assert stage(None, "texels") is None


def test_a_bake_reports_before_it_works(monkeypatch: pytest.MonkeyPatch) -> None:
    phases: list[str] = []
    real = layout_module.solid_triangles

    def solids(*arguments: object) -> object:
        assert phases == ["surfaces"]
        return real(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(layout_module, "solid_triangles", solids)
    eclat.bake(
        "furnace", texel_size=0.5, samples=4, max_error=0.1, progress=lambda phase, fraction, _: phases.append(phase)
    )
    order = list(dict.fromkeys(phases))
    assert [name for name in order if name in ("surfaces", "texels", "hidden texels", "fit")] == [
        "surfaces",
        "texels",
        "hidden texels",
        "fit",
    ]
