# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Photon mapping: the method with its options, and its solution, the photons of a scene."""

from __future__ import annotations

import time as clock
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any, ClassVar, Literal

import numpy as np

from eclat import _core
from eclat.bridge.arguments import points_with_normals
from eclat.bridge.compiled import compiled, fingerprint
from eclat.bridge.running import ProgressReport, run
from eclat.errors import EclatError, warn
from eclat.methods.method import Method, PassEstimator, Prepared, Solved
from eclat.methods.path import missing_caustics
from eclat.methods.photon_tracing import PhotonRequest, trace_photons
from eclat.methods.ranges import check_names, check_range, check_types, core_enum
from eclat.methods.saved import Common, DamagedArrayError
from eclat.methods.work import Care, Purpose, View, Work
from eclat.scene import FloatArray, Material, Scene

COLUMNS = 13
"""Number of floats per photon: position (3), power (3), direction (3), normal (3) and number of edges (1)."""


@dataclass(frozen=True)
class Emission:
    """The paths from which photons were stored; maps with equal emissions hold the same photons."""

    seed: int
    paths: int
    """Number of paths emitted for the global map."""
    caustic_paths: int
    """Number of paths emitted for the caustic map."""


@dataclass(frozen=True, eq=False, repr=False)
class Photons(Solved):
    """The photons of a scene, on surfaces with a diffuse lobe.

    `stored` and `caustic` are float32 arrays (photons, 13) in the coordinates of the core. `stored` holds the global
    map, photons that were scattered diffusely before they arrived; `caustic` holds photons that met only mirrors, glass
    and glossy surfaces. Photons straight from lights are not stored, because direct light is sampled when it is needed.
    The properties give the values by name. `max_depth` is the greatest number of edges of a path with which the photons
    were traced.
    """

    called: ClassVar[str] = "photon map"
    consists_of: ClassVar[str] = "photons"
    format: ClassVar[int] = 2

    options: PhotonMap
    fingerprint: str
    stored: np.ndarray
    caustic: np.ndarray
    center: FloatArray
    emissions: tuple[Emission, ...]
    statistics: dict[str, float] = field(default_factory=dict)
    max_depth: int = -1

    def __len__(self) -> int:
        """Return the number of photons in both maps."""
        return len(self.stored) + len(self.caustic)

    def _both(self, columns: slice) -> np.ndarray:
        return np.concatenate([self.stored[:, columns], self.caustic[:, columns]])

    @property
    def paths(self) -> tuple[int, int]:
        """The numbers of paths that were emitted for the global and for the caustic map."""
        return sum(e.paths for e in self.emissions), sum(e.caustic_paths for e in self.emissions)

    @property
    def positions(self) -> FloatArray:
        """(N, 3) world positions in metres. In this and all other properties, the caustic photons come last."""
        return self._both(slice(0, 3)).astype(np.float64) + self.center

    @property
    def powers(self) -> FloatArray:
        """(N, 3) power of each photon in W. Their sum is the indirect flux that arrives on diffuse surfaces."""
        paths = np.repeat(np.maximum(self.paths, 1), (len(self.stored), len(self.caustic)))
        each: FloatArray = self._both(slice(3, 6)).astype(np.float64) / paths[:, None]
        return each

    @property
    def directions(self) -> np.ndarray:
        """(N, 3) unit vectors in the directions from which the photons came."""
        return self._both(slice(6, 9))

    @property
    def normals(self) -> np.ndarray:
        """(N, 3) unit normals of the surfaces, on the side at which the photons arrived."""
        return self._both(slice(9, 12))

    @property
    def edges(self) -> np.ndarray:
        """(N,) numbers of edges of the photons' paths: 2 after one bounce."""
        return self._both(slice(12, 13))[:, 0].astype(np.int64)

    @property
    def is_caustic(self) -> np.ndarray:
        """(N,) True for photons of the caustic map."""
        return np.arange(len(self)) >= len(self.stored)

    def maps(
        self, scene: Scene, *, gather: bool, threads: int = 0, progress: ProgressReport | None = None
    ) -> _core.PhotonMaps:
        """Convert the maps to the compiled core. With `gather`, the irradiance that gather rays read where they end is
        computed too.
        """
        options = _core.PhotonMapReading()
        options.nearest, options.caustic_nearest = self.options.nearest, self.options.caustic_nearest
        options.kernel = core_enum(_core.Kernel, self.options.kernel)
        options.gather, options.guided = gather, self.options.guided
        options.seed = (
            self.emissions[0].seed ^ 0x9E3779B9
        )  # The points at which irradiance is computed must not be photons of the map itself.
        options.threads = threads
        arrays = (np.ascontiguousarray(photons, np.float32) for photons in (self.stored, self.caustic))
        stored, caustic = zip(arrays, map(float, self.paths), strict=True)
        core = compiled(scene).core
        return run(
            "photons", lambda p: _core.photon_maps(core, stored, caustic, options, p), progress, _core.Progress()
        )

    def radiance_estimator(self, scene: Scene, work: Work) -> _core.Estimator:
        gather = self.options.gather
        maps = self.maps(scene, gather=gather > 0, threads=work.threads, progress=work.progress)
        return _core.photon_estimator(compiled(scene).core, maps, gather_rays=gather, max_depth=work.max_depth)

    def point_estimator(self, scene: Scene, work: Work) -> _core.PointEstimator:
        if missing := missing_caustics(scene, work):
            warn(
                f"photon-map: {missing}; points need not lie on surfaces, so caustics at points are found by paths, which "
                "cannot find this light, and it is missing there; use pictures or Photons.irradiance(..., caustic=True)"
            )
        maps = self.maps(scene, gather=True, threads=work.threads, progress=work.progress)
        return _core.photon_point_estimator(compiled(scene).core, maps)

    def irradiance(
        self, scene: Scene, points: FloatArray, normals: FloatArray, *, caustic: bool = False, threads: int = 0
    ) -> np.ndarray:
        """Estimate the irradiance (N, 3) in W·m⁻² at points of surfaces from the density of the photons of one map. The
        estimate is blurred and noisy.

        The global map gives the light that was scattered diffusely before it arrived; with `caustic`, the caustic map
        gives the light that met only mirrors, glass and glossy surfaces. `eclat.irradiance` gives a better estimate of
        all light, at any points.
        """
        self.require_match(scene, self.max_depth)
        places, sides = points_with_normals(points, normals)
        prepared = compiled(scene)
        maps = self.maps(scene, gather=False, threads=threads)
        positions, directions = prepared.to_core(places), np.ascontiguousarray(sides, np.float32)
        return np.asarray(_core.photon_density(prepared.core, positions, directions, maps, caustic, threads))

    def arrays(self) -> dict[str, np.ndarray]:
        return {"stored": self.stored, "caustic": self.caustic, "center": self.center}

    def header(self) -> dict[str, Any]:
        return {"emissions": [asdict(e) for e in self.emissions]}

    @classmethod
    def from_parts(cls, common: Common, header: Mapping[str, Any], arrays: Mapping[str, np.ndarray]) -> Photons:
        for name in ("stored", "caustic"):
            array = arrays.get(name, np.zeros(0))
            if (
                array.ndim != 2
                or array.shape[1] != COLUMNS
                or array.dtype != np.float32
                or not np.isfinite(array).all()
            ):
                raise DamagedArrayError(name)
        emissions = tuple(Emission(**e) for e in header["emissions"])
        counts = [count for e in emissions for count in (e.seed, e.paths, e.caustic_paths)]
        if not counts or not all(type(count) is int and 0 <= count < 1 << 63 for count in counts):
            raise ValueError("emissions")
        return cls(
            common.options, common.fingerprint, arrays["stored"], arrays["caustic"], arrays["center"],
            emissions, common.statistics, common.max_depth,
        )  # fmt: skip

    def merged(self, other: Photons) -> Photons:
        """Merge the photons of both maps as if they had been emitted together; the order of the two does not matter.

        Raises EclatError if both hold the same photons, those of the same seed.
        """
        shared = {e.seed for e in self.emissions} & {e.seed for e in other.emissions}
        if shared:
            raise EclatError(
                f"merge: expected photon maps of different seeds, got two that hold the photons of seed {min(shared)}"
            )
        one, two = sorted((self, other), key=lambda p: p.emissions[0].seed)
        # The photons are sorted, so that the result does not depend on the order in which maps are merged.
        return Photons(
            one.options, one.fingerprint, _in_order(one.stored, two.stored), _in_order(one.caustic, two.caustic),
            one.center, tuple(sorted(one.emissions + two.emissions, key=lambda e: e.seed)), max_depth=one.max_depth,
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class ProgressivePhotons(Prepared):
    """Progressive photon mapping, which keeps no photons: sample n of a pixel is estimated from the photons of pass n,
    and the discs in which photons are collected shrink from pass to pass.
    """

    options: PhotonMap
    statistics: dict[str, float] = field(default_factory=dict)

    def passes(self, scene: Scene, work: Work) -> PassEstimator:
        core = compiled(scene).core
        options = _core.ProgressiveOptions()
        options.max_edges = _photon_edges(work.max_depth)
        options.paths = 0 if options.max_edges in (0, 1) else self.options.photons
        options.nearest, options.alpha = self.options.nearest, self.options.alpha
        options.kernel = core_enum(_core.Kernel, self.options.kernel)
        options.seed, options.threads = work.seed, work.threads
        first: list[_core.PhotonMaps] = []

        def estimator(number: int, progress: _core.Progress) -> _core.Estimator:
            if not first:
                first.append(_core.progressive_maps(core, 0, None, options, progress))
            maps = first[0] if number == 0 else _core.progressive_maps(core, number, first[0], options, progress)
            return _core.photon_estimator(core, maps, gather_rays=0, max_depth=work.max_depth)

        return estimator

    def radiance_estimator(self, scene: Scene, work: Work) -> _core.Estimator:
        raise EclatError(
            "photon-map: expected progressive=False for a single estimator, got progressive=True, which makes a new "
            "estimator for each sample"
        )

    def point_estimator(self, scene: Scene, work: Work) -> _core.PointEstimator:
        raise EclatError(PROGRESSIVE_KEEPS_NO_PHOTONS)


PROGRESSIVE_KEEPS_NO_PHOTONS = (
    "photon-map: expected progressive=False, got True: progressive photon mapping keeps no photons "
    "and makes only pictures"
)
"""The message for uses of progressive photon mapping other than pictures."""


def _photon_edges(max_depth: int) -> int:
    """Return the greatest number of edges of a photon's path. A camera path of at most `max_depth` edges needs one edge
    from the photon to the camera.
    """
    return -1 if max_depth < 0 else max_depth - 1


def _in_order(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    both = np.concatenate([a, b])
    return both[np.lexsort(both.T)]


def _has_glossy_surfaces(scene: Scene) -> bool:
    """Return whether any surface could focus light."""

    def glossy(material: Material) -> bool:
        parts = [*material.children, *([] if material.back is None else [material.back])]
        return material.kind not in ("diffuse", "blend") or any(map(glossy, parts))

    return any(glossy(mesh.material) for mesh in scene.meshes)


def trace(scene: Scene, options: PhotonMap, work: Work) -> Photons:
    """Trace the photons of the whole scene. Warns if fewer photons than wanted were stored after many more paths.

    Raises EclatError for progressive photon mapping, which keeps no map.
    """
    if options.progressive:
        raise EclatError(PROGRESSIVE_KEEPS_NO_PHOTONS)
    started, counted, prepared = clock.perf_counter(), _core.Progress(), compiled(scene)
    max_edges = _photon_edges(work.max_depth)

    def traced(phase: str, caustic: bool, wanted: int) -> tuple[np.ndarray, int]:
        if max_edges in (0, 1) or (caustic and not _has_glossy_surfaces(scene)):
            return np.zeros((0, COLUMNS), np.float32), 0
        request = PhotonRequest(caustic, wanted, max_edges, options.guided)
        return trace_photons(scene, request, phase, work, counted)

    stored, paths = traced("photons", False, options.photons)
    caustic, caustic_paths = traced("caustic photons", True, options.caustic_photons)
    if 0 < len(stored) < options.photons:
        warn(
            f"photon-map: only {len(stored):,} of the wanted {options.photons:,} photons were stored after {paths:,} paths"
        )
    statistics = {
        "photons": float(len(stored)),
        "caustic_photons": float(len(caustic)),
        "paths": float(paths + caustic_paths),
        "rays": float(counted.rays),
        "seconds": clock.perf_counter() - started,
    }
    emission = Emission(work.seed, paths, caustic_paths)
    return Photons(
        options, fingerprint(scene), stored, caustic, prepared.center, (emission,), statistics, work.max_depth
    )


FEWEST_PHOTONS = 1000
"""Smallest number of photons that can be requested for either map."""


@dataclass(frozen=True)
class PhotonMap(Method):
    """Photon mapping: indirect light, including caustics, is estimated from photons that are traced from the lights."""

    name: ClassVar[str] = "photon-map"
    cannot: ClassVar[str] = (
        "Light is blurred over the discs in which photons are collected, and at edges and thin walls some light is lost or "
        "leaks; these errors vanish only with `progressive`. Glossy reflections are traced, with noise."
    )
    solved: ClassVar[type[Solved] | None] = Photons

    photons: int = 200_000
    """Number of photons in the global map, which were reflected diffusely at least once."""
    caustic_photons: int = 200_000
    """Number of photons in the caustic map, which met only mirrors, glass and glossy surfaces."""
    nearest: int = 100
    """Number of photons in one estimate. More photons give less noise and more blur."""
    caustic_nearest: int = 60
    """Number of photons in one estimate of caustics."""
    kernel: Literal["uniform", "cone", "epanechnikov"] = "epanechnikov"
    """Kernel by which the weight of a photon decreases with its distance."""
    gather: int = 4
    """Number of rays of the final gather per sample of a pixel. With 0, the photons are shown directly."""
    guided: bool = True
    """Whether to learn from which positions and in which directions of the lights photons are emitted that will be
    stored, and emit more photons there."""
    progressive: bool = False
    """Whether to trace new photons for each sample of the pixels and show them directly, in discs that shrink from
    sample to sample, so that noise and blur both vanish. `photons` is then the number of paths that are emitted per
    sample."""
    alpha: float = 0.7
    """Parameter of `progressive`, 0.1..0.95: with a larger value the discs shrink more slowly, which gives less noise,
    and blur that vanishes later."""

    def __post_init__(self) -> None:
        check_types(self)
        check_range(self, "photons", FEWEST_PHOTONS, 10**8)
        check_range(self, "caustic_photons", FEWEST_PHOTONS, 10**8)
        check_range(self, "nearest", 8, 10**5)
        check_range(self, "caustic_nearest", 8, 10**5)
        check_range(self, "gather", 0, 10**4)
        check_range(self, "alpha", 0.1, 0.95)
        check_names(self, "kernel")

    def solve(self, scene: Scene, purpose: Purpose, work: Work, care: Care | None = None) -> Photons:
        return trace(scene, self, work)

    def prepare(self, scene: Scene, purpose: Purpose, work: Work, care: Care | None = None) -> Prepared:
        if self.progressive and isinstance(purpose, View):
            return ProgressivePhotons(self)
        return trace(scene, self, work)

    def at_effort(self, share: float, max_error: float) -> PhotonMap:
        photons, caustic = (max(FEWEST_PHOTONS, int(n * share)) for n in (self.photons, self.caustic_photons))
        return replace(self, photons=photons, caustic_photons=caustic)
