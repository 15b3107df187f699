# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What an algorithm learned about a scene, as a value: save, load, merge, inspect as arrays, re-use."""

from __future__ import annotations

import math
import os
from dataclasses import asdict, dataclass, field
from typing import Any, TypeVar

import numpy as np

from eclat import _core
from eclat.bridge.compiled import compiled, fingerprint
from eclat.error_estimate import ErrorEstimate
from eclat.errors import EclatError, warn
from eclat.files.archive import read_archive, write_archive
from eclat.options import BALANCED, METHODS, METRICS, WEIGHTS, IrradianceCache, RadianceCache, method_name
from eclat.photons import Photons, merge_photons
from eclat.scene import FloatArray, Scene

FORMAT_VERSION = 5

Solved = TypeVar("Solved", "Solution", Photons)
"""What can be merged."""

_COLUMNS = {
    "positions": slice(0, 3),
    "normals": slice(3, 6),
    "irradiance": slice(6, 9),
    "excess": slice(9, 12),
    "rotation_gradients": slice(12, 21),
    "translation_gradients": slice(21, 30),
    "distances": slice(30, 31),
    "radii": slice(31, 32),
    "elongations": slice(32, 33),
    "axes": slice(33, 34),
    "curvatures": slice(34, 35),
    "enclosed": slice(52, 53),
}


def core_options(
    options: IrradianceCache, *, max_depth: int = -1, seed: int = 0, threads: int = 0
) -> _core.IrradianceCacheOptions:
    """The core's options. `max_error` sets what is None.

    The error of first-order extrapolation grows with the square of a record's radius, a gather's noise falls with the
    number of its rows. Records are never more than √2 times as far apart as at 1 %: where they are wider than what
    stands beside them, others must be crowded in between. What far records do not know is averaged over hemispheres, so
    that they are spared more slowly than the error grows.
    """
    out = _core.IrradianceCacheOptions()
    relative = options.max_error / 0.01
    usual = 0.4 if options.metric in ("minimum", "harmonic") else 0.8
    out.spacing = options.spacing if options.spacing is not None else usual * min(2.0, relative) ** 0.5
    out.rows = options.rows if options.rows is not None else int(np.clip(round(14 * relative**-0.5), 8, 64))
    out.far_records = options.far_records if options.far_records is not None else round(2000 * relative ** (-1 / 3))
    out.far_rows = options.far_rows if options.far_rows is not None else round(9 * relative**-0.2)
    out.disagreement = 2 * options.max_error if options.adaptive else math.inf
    out.metric = METRICS.index(options.metric)
    out.balanced = BALANCED.index(options.balanced)
    out.weight = WEIGHTS.index(options.weight)
    for name in (
        "relaxation", "rotation_gradient", "translation_gradient", "neighbor_clamping", "gradient_limit", "obstacle_limit",
        "least_pixels", "largest_pixels", "far_spacing",
    ):  # fmt: skip
        setattr(out, name, getattr(options, name))
    out.max_depth, out.seed, out.threads = max_depth, seed, threads
    return out


def core_radiance_options(
    options: RadianceCache, *, max_depth: int = -1, seed: int = 0, threads: int = 0
) -> _core.RadianceCacheOptions:
    """The core's options; `max_error` sets what is None, by the same laws as in `core_options`."""
    out = _core.RadianceCacheOptions()
    out.irradiance = core_options(options, max_depth=max_depth, seed=seed, threads=threads)
    relative = options.max_error / 0.01
    out.order = options.order
    out.spacing = options.gloss_spacing if options.gloss_spacing is not None else out.irradiance.spacing
    rows = int(np.clip(round(16 * relative**-0.5), 10, 96))
    out.rows = options.gloss_rows if options.gloss_rows is not None else rows
    return out


@dataclass(frozen=True, eq=False)
class RadianceRecords:
    """Records of incident radiance, in the core's frame."""

    records: np.ndarray
    """(N, floats) as the `near` records of a Solution."""
    values: np.ndarray
    """(N, 3 · stride) float32: coefficients a colour in a basis that is orthonormal on the hemisphere, order² and zeros up
    to a multiple of eight."""
    gradients: np.ndarray
    """(N, 6 · stride) uint16, upper halves of float32: their derivatives along u, then along v."""

    def __len__(self) -> int:
        return len(self.records)

    @property
    def nbytes(self) -> int:
        """Of its arrays."""
        return self.records.nbytes + self.values.nbytes + self.gradients.nbytes

    @staticmethod
    def of(caches: _core.SolvedCaches) -> RadianceRecords:
        """From what the core solved."""
        return RadianceRecords(
            np.asarray(caches.radiance_records),
            np.asarray(caches.radiance_values),
            np.asarray(caches.radiance_gradients),
        )

    def arrays(self) -> dict[str, np.ndarray]:
        """By the names under which they are saved."""
        return {"radiance": self.records, "radiance_values": self.values, "radiance_gradients": self.gradients}

    def damage(self, order: int) -> str | None:
        """Name of an array that cannot belong to records of that order."""
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


@dataclass(frozen=True, eq=False)
class Solution:
    """A solved irradiance cache of one scene.

    `near` and `far` are (records, floats) float32 arrays in the core's frame; use `positions`, `normals`, `radii`,
    `irradiance` and the gradients to look inside. `max_depth` is what it was solved with. One that is not `complete`
    was interrupted: its records are right, but where some are missing, reading takes longer and is noisier.
    """

    options: IrradianceCache
    fingerprint: str
    near: np.ndarray
    far: np.ndarray
    center: FloatArray
    statistics: dict[str, float] = field(default_factory=dict)
    max_depth: int = -1
    complete: bool = True
    radiance: RadianceRecords | None = None
    """Of radiance caching, else None."""

    def __len__(self) -> int:
        return len(self.near)

    @property
    def nbytes(self) -> int:
        """Of its arrays."""
        return self.near.nbytes + self.far.nbytes + (self.radiance.nbytes if self.radiance else 0)

    def _column(self, name: str) -> np.ndarray:
        return self.near[:, _COLUMNS[name]]

    @property
    def positions(self) -> FloatArray:
        """(N, 3) world positions of the records."""
        return self._column("positions").astype(np.float64) + self.center

    @property
    def normals(self) -> np.ndarray:
        """(N, 3) unit normals."""
        return self._column("normals")

    @property
    def irradiance(self) -> np.ndarray:
        """(N, 3) indirect irradiance, W·m⁻², but for `excess`."""
        return self._column("irradiance")

    @property
    def excess(self) -> np.ndarray:
        """(N, 3) irradiance from the few rays that brought more than a twentieth each, W·m⁻²: shared by neighbours."""
        return self._column("excess")

    @property
    def radii(self) -> np.ndarray:
        """(N,) radius within which each record is valid, in metres."""
        return self._column("radii")[:, 0]

    @property
    def enclosed(self) -> np.ndarray:
        """(N,) whether a record lies inside a solid, unseen, where most rays met backs of one-sided surfaces: never
        read."""
        return self._column("enclosed")[:, 0] > 0

    @property
    def rotation_gradients(self) -> np.ndarray:
        """(N, 3 channels, 3) gradient for a turn of the normal, W·m⁻² per radian."""
        return self._column("rotation_gradients").reshape(-1, 3, 3)

    @property
    def translation_gradients(self) -> np.ndarray:
        """(N, 3 channels, 3) gradient in the tangent plane, W·m⁻³."""
        return self._column("translation_gradients").reshape(-1, 3, 3)

    @property
    def estimate(self) -> ErrorEstimate | None:
        """The error of the records where they were wanted, unless that was not checked."""
        names = ("estimated_error", "estimated_error_low", "estimated_error_high", "unserved")
        if not set(names) <= set(self.statistics):
            return None
        return ErrorEstimate(*(self.statistics[name] for name in names))

    def core(self) -> _core.SolvedCaches:
        """The caches as the core reads them."""
        caches = _core.SolvedCaches(
            np.ascontiguousarray(self.near, np.float32),
            np.ascontiguousarray(self.far, np.float32),
            core_options(self.options),
        )
        if self.radiance is not None and len(self.radiance) and isinstance(self.options, RadianceCache):
            r = self.radiance
            records, values, gradients = (np.ascontiguousarray(a) for a in (r.records, r.values, r.gradients))
            caches.set_radiance(records, values, gradients, core_radiance_options(self.options))
        return caches

    def check(self, scene: Scene, max_depth: int) -> None:
        """Raises EclatError where the scene or the depth is not what was solved; warns of an incomplete cache."""
        if self.fingerprint != fingerprint(scene) or not np.array_equal(self.center, compiled(scene).center):
            raise EclatError(
                "this cache was solved for another scene: geometry, materials or lights differ; solve it again"
            )
        if self.max_depth != max_depth:
            raise EclatError(
                f"this cache was solved with max_depth {self.max_depth}: expected the same, got {max_depth}"
            )
        if not self.complete:
            warn("this cache is incomplete, since its solve was interrupted: more is traced, with more noise")

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write to an `.npz` file, whole or not at all. Raises EclatError where it cannot be written."""
        header = {
            "format": FORMAT_VERSION,
            "fingerprint": self.fingerprint,
            "method": method_name(self.options),
            "options": asdict(self.options),
            "max_depth": self.max_depth,
            "complete": self.complete,
            "statistics": self.statistics,
        }
        arrays: dict[str, Any] = {"near": self.near, "far": self.far, "center": self.center}
        if self.radiance is not None:
            arrays |= self.radiance.arrays()
        write_archive(path, header, arrays)

    @staticmethod
    def load(path: str | os.PathLike[str], scene: Scene | None = None) -> Solution:
        """Read a saved cache; with `scene`, refuse one that was solved for another. Raises EclatError."""
        name = os.fspath(path)
        parts = ("radiance", "radiance_values", "radiance_gradients")
        header, arrays = read_archive(path, "a cache", ("near", "far", "center"), parts)
        if header.get("format") != FORMAT_VERSION:
            raise EclatError(f"{name}: a cache of another version of Éclat: solve the scene again")
        near, far, center = arrays["near"], arrays["far"], arrays["center"]
        radiance = RadianceRecords(*(arrays[n] for n in parts)) if parts[0] in arrays else None
        for label, array in (("near", near), ("far", far)):
            if _damaged(array):
                raise EclatError(f"{name}: the array {label!r} is damaged")
        try:
            solution = Solution(
                _options(header), str(header["fingerprint"]), near, far, center,
                dict(header["statistics"]), int(header["max_depth"]), bool(header["complete"]), radiance,
            )  # fmt: skip
        except (KeyError, TypeError, ValueError) as error:
            raise EclatError(f"{name}: its header is damaged ({error})") from error
        if radiance is not None and isinstance(solution.options, RadianceCache):
            damaged = radiance.damage(solution.options.order)
            if damaged:
                raise EclatError(f"{name}: the array {damaged!r} is damaged")
        if scene is not None:
            solution.check(scene, solution.max_depth)
        return solution


def _options(header: dict[str, Any]) -> IrradianceCache:
    cls = METHODS[header["method"]]
    if not issubclass(cls, IrradianceCache):
        raise ValueError(f"method {header['method']!r}")
    return cls(**header["options"])


def _damaged(array: np.ndarray) -> bool:
    if array.ndim != 2 or array.dtype != np.float32 or array.shape[1] < _COLUMNS["radii"].stop:
        return True
    # Distances may be infinite, under an open sky.
    known = np.delete(array, _COLUMNS["distances"], axis=1)[:, : _COLUMNS["radii"].stop - 1]
    return not np.isfinite(known).all() or bool((array[:, _COLUMNS["radii"]] < 0).any())


def merge(first: Solved, second: Solved) -> Solved:
    """The records of both, sorted, without duplicates; or the photons of both. Commutative. For records it is not the same
    as one joint solve; photons are then those of one emission.

    Raises EclatError where scenes or options differ, or where both hold the same photons (by their seed).
    """
    if isinstance(first, Photons) and isinstance(second, Photons):
        return merge_photons(first, second)
    if isinstance(first, Photons) or isinstance(second, Photons):
        raise EclatError("merge: expected records and records, or photons and photons")
    if first.fingerprint != second.fingerprint:
        raise EclatError("these caches were solved for different scenes")
    if (first.options, first.max_depth) != (second.options, second.max_depth):
        raise EclatError("these caches were solved with different options")

    def distinct(both: np.ndarray) -> np.ndarray:
        if not len(both):
            return np.arange(0)
        keys = np.ascontiguousarray(both).view(np.dtype((np.void, both.dtype.itemsize * both.shape[1]))).ravel()
        first: np.ndarray = np.unique(keys, return_index=True)[1]
        return first

    def union(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        both = np.concatenate([a, b])
        kept: np.ndarray = both[distinct(both)]
        return kept

    def radiance(a: RadianceRecords | None, b: RadianceRecords | None) -> RadianceRecords | None:
        given = [r for r in (a, b) if r is not None and len(r)]
        if not given:
            return a
        by_name = [r.arrays() for r in given]
        records, values, gradients = (np.concatenate([arrays[name] for arrays in by_name]) for name in by_name[0])
        kept = distinct(records)
        return RadianceRecords(records[kept], values[kept], gradients[kept])

    return Solution(
        first.options, first.fingerprint, union(first.near, second.near), union(first.far, second.far), first.center,
        max_depth=first.max_depth, complete=first.complete and second.complete,
        radiance=radiance(first.radiance, second.radiance),
    )  # fmt: skip


def solved_from_core(
    scene: Scene,
    options: IrradianceCache,
    caches: _core.SolvedCaches,
    statistics: dict[str, float],
    *,
    max_depth: int,
    complete: bool,
) -> Solution:
    """A Solution from what the core solved."""
    center = compiled(scene).center
    radiance = RadianceRecords.of(caches) if isinstance(options, RadianceCache) else None
    return Solution(
        options, fingerprint(scene), caches.near, caches.far, center, statistics, max_depth, complete, radiance
    )
