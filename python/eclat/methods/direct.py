# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The method `direct`, which computes only light that arrives straight from lights."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from eclat.methods.method import Method, Prepared
from eclat.methods.traced import Traced
from eclat.methods.work import Care, Purpose, Work
from eclat.scene import Scene


@dataclass(frozen=True)
class Direct(Method):
    """Direct light only: emission, and light that reaches surfaces straight from lights (paths of at most two
    edges)."""

    name: ClassVar[str] = "direct"
    cannot: ClassVar[str] = (
        "All indirect light is missing: no path is longer than from a light to a surface to the camera."
    )

    def prepare(self, scene: Scene, purpose: Purpose, work: Work, care: Care | None = None) -> Prepared:
        return Traced(self, most_edges=2)
