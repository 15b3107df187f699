# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The records of all times of an animation, as they are at each time; they can be kept in a file."""

from __future__ import annotations

import os
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from eclat.bridge.anchors import Posed
from eclat.bridge.compiled import compiled, fingerprint
from eclat.errors import EclatError
from eclat.files.archive import read_archive, write_archive
from eclat.methods.records.kept_tracks import arrays_of, tracks_from
from eclat.methods.records.options import RadianceOptions, RecordOptions
from eclat.methods.records.radiance_rows import RECORD, Rows, records_of
from eclat.methods.records.solution import Solution
from eclat.methods.records.tracks import COLUMNS, Tracks, in_core_space
from eclat.methods.saved import DamagedArrayError
from eclat.methods.work import Times
from eclat.scene import Scene

FILE_FORMAT = 1
"""Version of the format of files with records of all times."""


@dataclass(eq=False)
class MovingSolution:
    """The records of all times of an animation. `at` gives those of one time."""

    options: RecordOptions
    times: Times
    max_depth: int
    near: Tracks
    far: Tracks
    radiance: Tracks | None = None
    statistics: dict[str, float] = field(default_factory=dict)

    def at(self, time: int) -> Solution:
        """Return the records at a time, by its index."""
        scene = self.times.scene(time)
        near, far = (rows_at(tracks, self.times, time) for tracks in (self.near, self.far))
        statistics = {"records": float(len(near)), "far_records": float(len(far))}
        radiance = None
        if self.radiance is not None:
            radiance = records_of(rows_at(self.radiance, self.times, time))
            statistics["radiance_records"] = float(len(radiance))
        return Solution(
            self.options, fingerprint(scene), near, far, compiled(scene).center, statistics, self.max_depth, True,
            radiance,
        )  # fmt: skip

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write an `.npz` file, either completely or not at all. Raises EclatError if it cannot be written."""
        kept = {"near": self.near, "far": self.far} | ({} if self.radiance is None else {"radiance": self.radiance})
        arrays = {name: array for kind, tracks in kept.items() for name, array in arrays_of(tracks, kind).items()}
        write_archive(path, {"format": FILE_FORMAT, "statistics": self.statistics}, arrays)


def load_over_time(
    path: str | os.PathLike[str], options: RecordOptions, times: Times, max_depth: int
) -> MovingSolution:
    """Read records that `save` wrote, solved with the same options for the same times. Raises EclatError if the file cannot
    be read, is damaged, or is of another version of Éclat.
    """
    header, arrays = read_archive(path)
    name, again = os.fspath(path), "remove it, and the records are solved again"
    if header.get("format") != FILE_FORMAT:
        raise EclatError(f"{name}: expected the records of an animation of this version of Éclat; {again}")
    widths = {"near": RECORD, "far": RECORD}
    if isinstance(options, RadianceOptions):
        widths["radiance"] = RECORD + 9 * options.order**2
    try:
        kept = {kind: tracks_from(arrays, kind, width, len(times)) for kind, width in widths.items()}
    except DamagedArrayError as error:
        raise EclatError(f"{name}: the array {str(error)!r} is damaged; {again}") from error
    return MovingSolution(options, times, max_depth, **kept, statistics=dict(header.get("statistics", {})))


def rows_at(tracks: Tracks, times: Times, time: int) -> Rows:
    """Return the rows of records as they are at a time, in coordinates of the core. Those whose surface has no extent are
    left out.
    """
    scene = times.scene(time)
    rows = tracks.at(time, times.states, np.asarray(times.seconds, np.float64))
    known = np.asarray(np.isfinite(rows[:, COLUMNS["irradiance"]]).all(axis=1))
    return placed(rows, tracks, known, scene)[0]


def placed(rows: Rows, tracks: Tracks, known: NDArray[np.bool_], scene: Scene) -> tuple[Rows, Posed, NDArray[np.bool_]]:
    """Return rows where their surfaces are in a scene, how these lie, and which rows these are."""
    posed = tracks.anchors.posed(scene)
    which = known & posed.valid
    posed = posed.taken(which)
    local = compiled(scene).to_core(posed.positions)
    return in_core_space(rows[which], posed, tracks.moving[which], local), posed, which
