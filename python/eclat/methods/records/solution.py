# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The records of a scene, which can be saved, loaded, merged, read as arrays and used again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar
from weakref import WeakKeyDictionary

import numpy as np

from eclat import _core
from eclat.bridge.compiled import compiled, fingerprint
from eclat.bridge.running import run
from eclat.measure.error_estimate import ErrorEstimate, without_light_by_chance
from eclat.methods.method import Method, Prepared, Solved
from eclat.methods.records.laws import core_options, core_radiance_options
from eclat.methods.records.options import RadianceOptions, RecordOptions
from eclat.methods.records.radiance_tables import radiance_tables
from eclat.methods.saved import Common, DamagedArrayError
from eclat.methods.traced import ROULETTE_DEPTH
from eclat.methods.work import Work
from eclat.scene import FloatArray, Scene

_COLUMNS = {name: slice(first, first + count) for name, first, count in _core.record_layout()}
"""Columns of each field in the row of floats of a record, as the core defines them."""


_cores: WeakKeyDictionary[Solution, _core.SolvedCaches] = WeakKeyDictionary()
"""The records of solutions in the compiled core. They are kept here, so that a solution can be copied and sent."""

_guides: WeakKeyDictionary[FinalGather, _core.PathGuide] = WeakKeyDictionary()
"""What guides the paths of final gathers, in the compiled core. It belongs to one scene, like the records."""


@dataclass(frozen=True, eq=False)
class RadianceRecords:
    """Records of incident radiance, in the coordinates of the core."""

    records: np.ndarray
    """(N, floats) positions, normals and radii, in the same layout as the `near` records of a Solution."""
    values: np.ndarray
    """(N, 3 · stride) float32: the order² coefficients of each colour channel in an orthonormal basis of the
    hemisphere, padded with zeros to a multiple of eight, the stride."""
    gradients: np.ndarray
    """(N, 6 · stride) uint16, the upper halves of float32: the derivatives of the coefficients along u, then those
    along v."""

    def __len__(self) -> int:
        return len(self.records)

    @staticmethod
    def of(caches: _core.SolvedCaches) -> RadianceRecords:
        """Copy the records of radiance out of the caches of the core."""
        return RadianceRecords(
            np.asarray(caches.radiance_records),
            np.asarray(caches.radiance_values),
            np.asarray(caches.radiance_gradients),
        )

    def arrays(self) -> dict[str, np.ndarray]:
        """Return the arrays by the names under which they are saved."""
        return {"radiance": self.records, "radiance_values": self.values, "radiance_gradients": self.gradients}

    def damage(self, order: int) -> str | None:
        """Return the name of an array that is malformed or does not fit the given order, or None if there is none."""
        stride = -(-(order**2) // 8) * 8
        if _damaged(self.records):
            return "radiance"
        if self.values.shape != (len(self), 3 * stride) and len(self):
            return "radiance_values"
        if self.values.dtype != np.float32 or not np.isfinite(self.values).all():
            return "radiance_values"
        if (self.gradients.shape != (len(self), 6 * stride) and len(self)) or self.gradients.dtype != np.uint16:
            return "radiance_gradients"
        return None


@dataclass(frozen=True, eq=False, repr=False)
class Solution(Solved):
    """The records of irradiance, and of radiance if there are any, that were solved for one scene.

    `near` and `far` are float32 arrays (records, floats) in the coordinates of the core; the properties give the values
    of the near records by name. `max_depth` is the greatest number of edges of a path with which the records were
    solved. A Solution that is not `complete` was interrupted: its records are correct, but where records are missing,
    reading takes longer and has more noise.
    """

    called: ClassVar[str] = "cache"
    consists_of: ClassVar[str] = "records"
    format: ClassVar[int] = 6

    options: RecordOptions
    fingerprint: str
    near: np.ndarray
    far: np.ndarray
    center: FloatArray
    statistics: dict[str, float] = field(default_factory=dict)
    max_depth: int = -1
    complete: bool = True
    radiance: RadianceRecords | None = None
    """The records of radiance caching; None for irradiance caching."""

    def __len__(self) -> int:
        return len(self.near)

    def _column(self, name: str) -> np.ndarray:
        return self.near[:, _COLUMNS[name]]

    @property
    def positions(self) -> FloatArray:
        """(N, 3) world positions of the records in metres."""
        return self._column("positions").astype(np.float64) + self.center

    @property
    def record_positions(self) -> FloatArray:
        return self.positions

    @property
    def normals(self) -> np.ndarray:
        """(N, 3) unit normals."""
        return self._column("normals")

    @property
    def irradiance(self) -> np.ndarray:
        """(N, 3) indirect irradiance in W·m⁻², without `excess`."""
        return self._column("irradiance")

    @property
    def excess(self) -> np.ndarray:
        """(N, 3) irradiance in W·m⁻² from the few gather rays that contribute more than a twentieth of the irradiance
        each. It is distributed over neighbouring records.
        """
        return self._column("excess")

    @property
    def radii(self) -> np.ndarray:
        """(N,) radii in metres within which the records are valid."""
        return self._column("radii")[:, 0]

    @property
    def enclosed(self) -> np.ndarray:
        """(N,) True for records inside a solid, most of whose rays hit backs of one-sided surfaces. Such records are
        never read."""
        return self._column("enclosed")[:, 0] > 0

    @property
    def rotation_gradients(self) -> np.ndarray:
        """(N, 3 channels, 3) rotation gradients of the irradiance in W·m⁻² per radian."""
        return self._column("rotation_gradients").reshape(-1, 3, 3)

    @property
    def translation_gradients(self) -> np.ndarray:
        """(N, 3 channels, 3) translation gradients of the irradiance in the tangent plane, in W·m⁻³."""
        return self._column("translation_gradients").reshape(-1, 3, 3)

    @property
    def estimate(self) -> ErrorEstimate | None:
        """The estimated error of the records; None if it was not estimated."""
        names = ("estimated_error", "estimated_error_low", "estimated_error_high", "unserved")
        if not set(names) <= set(self.statistics):
            return None
        seen = without_light_by_chance(self.statistics)
        return ErrorEstimate(*(seen[name] for name in names))

    def core(self) -> _core.SolvedCaches:
        """Return the records in the compiled core, which only reads them. They are converted at the first call and kept
        as long as this solution exists: building their trees takes as long as a sample of each pixel of a small picture.
        """
        found = _cores.get(self)
        if found is None:
            found = _cores[self] = self._converted()
        return found

    def _converted(self) -> _core.SolvedCaches:
        caches = _core.SolvedCaches(
            np.ascontiguousarray(self.near, np.float32),
            np.ascontiguousarray(self.far, np.float32),
            core_options(self.options),
        )
        if self.radiance is not None and len(self.radiance) and isinstance(self.options, RadianceOptions):
            r = self.radiance
            records, values, gradients = (np.ascontiguousarray(a) for a in (r.records, r.values, r.gradients))
            caches.set_radiance(records, values, gradients, core_radiance_options(self.options))
        return caches

    def radiance_estimator(self, scene: Scene, work: Work, *, guide: _core.PathGuide | None = None) -> _core.Estimator:
        """Make the estimator of paths that read the records, with a guide only after a matte surface, where it aims them."""
        tables = None
        if isinstance(self.options, RadianceOptions):
            tables = radiance_tables(scene, self.options, threads=work.threads or None, progress=work.progress)
        return _core.cached_path_estimator(
            compiled(scene).core, self.core(), tables, max_depth=work.max_depth, guide=guide
        )

    def final_gather(self) -> FinalGather:
        return FinalGather(self.options, self.statistics, self)

    def reference_estimator(self, scene: Scene, work: Work) -> _core.Estimator:
        return _core.path_estimator(compiled(scene).core, max_depth=work.max_depth, roulette_depth=ROULETTE_DEPTH)

    def point_estimator(self, scene: Scene, work: Work) -> _core.PointEstimator:
        settings = core_options(self.options, max_depth=work.max_depth, seed=work.seed, threads=work.threads)
        return _core.cached_point_estimator(compiled(scene).core, self.core(), settings)

    def layers(self, film: _core.Film) -> dict[str, np.ndarray]:
        if not isinstance(self.options, RadianceOptions):
            return {}
        return {"gloss_cached": film.gloss_cached, "gloss_traced": film.gloss_traced}

    def picture_statistics(self, film: _core.Film) -> dict[str, float]:
        statistics = super().picture_statistics(film) | {"cache_misses": float(film.cache_misses)}
        if self.radiance is not None:
            statistics["radiance_records"] = float(len(self.radiance))
        return statistics

    def arrays(self) -> dict[str, np.ndarray]:
        arrays = {"near": self.near, "far": self.far, "center": self.center}
        return arrays if self.radiance is None else arrays | self.radiance.arrays()

    @classmethod
    def from_parts(cls, common: Common, header: Mapping[str, object], arrays: Mapping[str, np.ndarray]) -> Solution:
        for name in ("near", "far"):
            if _damaged(arrays.get(name, np.zeros(0))):
                raise DamagedArrayError(name)
        radiance = None
        if isinstance(common.options, RadianceOptions):
            names = ("radiance", "radiance_values", "radiance_gradients")
            radiance = RadianceRecords(*(arrays.get(name, np.zeros(0)) for name in names))
            if (damaged := radiance.damage(common.options.order)) is not None:
                raise DamagedArrayError(damaged)
        return cls(
            common.options, common.fingerprint, arrays["near"], arrays["far"], arrays["center"], common.statistics,
            common.max_depth, common.complete, radiance,
        )  # fmt: skip

    def merged(self, other: Solution) -> Solution:
        """Merge the records of both solutions, sorted and without duplicates."""
        return Solution(
            self.options, self.fingerprint, _union(self.near, other.near), _union(self.far, other.far), self.center,
            max_depth=self.max_depth, complete=self.complete and other.complete,
            radiance=_radiance_union(self.radiance, other.radiance),
        )  # fmt: skip


def _damaged(array: np.ndarray) -> bool:
    if array.ndim != 2 or array.dtype != np.float32 or array.shape[1] < _COLUMNS["radii"].stop:
        return True
    # Distances may be infinite, as under an open sky.
    if not np.allclose((array[:, _COLUMNS["normals"]].astype(np.float64) ** 2).sum(axis=1), 1, atol=1e-3):
        return True
    known = np.delete(array, _COLUMNS["distances"], axis=1)[:, : _COLUMNS["radii"].stop - 1]
    return not np.isfinite(known).all() or bool((array[:, _COLUMNS["radii"]] < 0).any())


def _distinct(rows: np.ndarray) -> np.ndarray:
    """Return the indices of the distinct rows, sorted by their bytes."""
    if not len(rows):
        return np.arange(0)
    keys = np.ascontiguousarray(rows).view(np.dtype((np.void, rows.dtype.itemsize * rows.shape[1]))).ravel()
    first: np.ndarray = np.unique(keys, return_index=True)[1]
    return first


def _union(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    both = np.concatenate([a, b])
    kept: np.ndarray = both[_distinct(both)]
    return kept


def _radiance_union(a: RadianceRecords | None, b: RadianceRecords | None) -> RadianceRecords | None:
    given = [r for r in (a, b) if r is not None and len(r)]
    if not given:
        return a
    by_name = [r.arrays() for r in given]
    records, values, gradients = (np.concatenate([arrays[name] for arrays in by_name]) for name in by_name[0])
    kept = _distinct(records)
    return RadianceRecords(records[kept], values[kept], gradients[kept])


def solved_from_core(
    scene: Scene,
    options: RecordOptions,
    caches: _core.SolvedCaches,
    statistics: dict[str, float],
    *,
    max_depth: int,
    complete: bool,
) -> Solution:
    """Make a Solution from the caches of the core."""
    center = compiled(scene).center
    radiance = RadianceRecords.of(caches) if isinstance(options, RadianceOptions) else None
    return Solution(
        options, fingerprint(scene), caches.near, caches.far, center, statistics, max_depth, complete, radiance
    )


@dataclass(frozen=True, eq=False)
class FinalGather(Prepared):
    """The records of a solution, read only by paths that have gone on from a matte surface, as in a final gather [Reichert92].

    What a record gets wrong then reaches a pixel only as a small part of the light that its paths collect: it is averaged over
    the surfaces that they meet and multiplied by an albedo. The price is the noise of paths with one scattering more. The
    probes of a picture measure what is left of the errors of records.
    """

    options: Method
    statistics: dict[str, float]
    solution: Solution

    @property
    def errs_by_noise_alone(self) -> bool:
        return True

    @property
    def error_behind(self) -> ErrorEstimate | None:
        return self.solution.estimate

    @property
    def record_positions(self) -> FloatArray:
        return self.solution.record_positions

    def picture_statistics(self, film: _core.Film) -> dict[str, float]:
        return self.solution.picture_statistics(film)

    def radiance_estimator(self, scene: Scene, work: Work) -> _core.Estimator:
        return self.solution.radiance_estimator(scene, work, guide=self._guide(scene, work))

    def _guide(self, scene: Scene, work: Work) -> _core.PathGuide:
        """Return what guides its paths, which is learnt at the first call, in about an eighth of the time of the records."""
        found = _guides.get(self)
        if found is None:
            core, records = compiled(scene).core, self.solution.core()
            found = _guides[self] = run(
                "guide",
                lambda p: _core.learn_path_guide(core, records, self.solution.max_depth, work.threads, p),
                work.progress,
                _core.Progress(),
            )
        return found

    def reference_estimator(self, scene: Scene, work: Work) -> _core.Estimator:
        return self.solution.reference_estimator(scene, work)

    def point_estimator(self, scene: Scene, work: Work) -> _core.PointEstimator:
        return self.solution.point_estimator(scene, work)
