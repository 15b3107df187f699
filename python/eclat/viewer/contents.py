# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What the page shows: a scene, its records and its light map, and the files that hold them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from eclat.errors import EclatError, shown
from eclat.files.atomic_file import write_files
from eclat.lightmap.lightmap import Lightmap
from eclat.methods import IrradianceCache, Method, Source, as_method
from eclat.methods.records.options import RecordOptions
from eclat.methods.records.solution import Solution
from eclat.scene import Scene
from eclat.verbs.solve import solve
from eclat.viewer.gloss import GlossSource
from eclat.viewer.growth import empty_solution
from eclat.viewer.lamps import light_message, parts_of, soft_light_of
from eclat.viewer.page import page_files
from eclat.viewer.record_rows import records_message
from eclat.viewer.surfaces import scene_message

SCENE, LIGHT, RECORDS, GLOSS = (f"data/{kind}.eclat" for kind in ("scene", "light", "records", "gloss"))
"""The names of the messages, below the page."""


@dataclass(frozen=True, eq=False)
class Contents:
    """A scene with the light that the page shows."""

    scene: Scene
    solution: Solution
    lightmap: Lightmap | None
    """Direct light of glowing surfaces and of the sky; None if the scene has neither."""
    exposure: float = 0.0
    """The exposure in stops with which the page begins."""

    @cached_property
    def gloss(self) -> GlossSource:
        """The records of radiance, to which those that views lack are added."""
        return GlossSource(self.scene, self.solution)

    def messages(self) -> dict[str, bytes]:
        """Encode the messages by their names."""
        return {
            SCENE: scene_message(self.scene, parts_of(self.scene, self.lightmap), exposure=self.exposure),
            LIGHT: light_message(self.lightmap),
            RECORDS: records_message(self.solution),
            GLOSS: self.gloss.whole_message(),
        }

    def files(self) -> dict[str, bytes]:
        """Return the page and its messages, by their paths below the address of the page."""
        return page_files() | self.messages()

    def export(self, folder: Path) -> list[Path]:
        """Write the page as files that any web server can serve, and return their paths."""
        contents: dict[Any, bytes] = {folder / name: data for name, data in self.files().items()}
        try:
            for path in contents:
                path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise EclatError(f"{folder}: the folder cannot be made: {error.strerror}") from error
        write_files(contents)
        return list(contents)


def contents_of(
    scene: Scene,
    what: Source | type[Method] | str | None = None,
    *,
    solved: bool = True,
    exposure: float,
    max_error: float,
    soft_light: Mapping[str, Any],
    work: Mapping[str, Any],
) -> Contents:
    """Compute what is missing of the contents.

    Parameters
    ----------
    scene, what, exposure, max_error : as for `showing.view`.
    solved : whether a method is solved for all surfaces; otherwise there are no records yet.
    soft_light : the arguments `texel_size` and `samples` of `eclat.bake`.
    work : the arguments `seed`, `threads` and `progress` of `eclat.solve` and `eclat.bake`.
    """
    page_files()  # its absence is reported before the light is computed
    source = as_method(what, IrradianceCache(max_error=max_error), max_error=max_error)
    if isinstance(source, Method):
        if not source.has_records or source.solved is None:
            raise EclatError(f"view: expected a method with records, got {source.name!r}")
        if not solved and isinstance(source, RecordOptions):
            source = empty_solution(scene, source)
        else:
            source = solve(scene, source, view_independent=True, check=False, **work)
    if not isinstance(source, Solution):
        raise EclatError(f"view: expected records, as `eclat.solve` makes them, got {shown(source)}")
    if len(source):
        source.require_match(scene, source.max_depth)
    return Contents(scene, source, soft_light_of(scene, **soft_light, **work), exposure)
