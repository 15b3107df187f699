# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A photon map of a scene as a value: save, load, merge, inspect as arrays, re-use."""

from __future__ import annotations

import os
import time as clock
from dataclasses import asdict, dataclass, field

import numpy as np

from eclat import _core
from eclat.bridge.arguments import points_with_normals
from eclat.bridge.compiled import compiled, fingerprint
from eclat.bridge.running import ProgressReport, run
from eclat.errors import EclatError, warn
from eclat.files.archive import read_archive, write_archive
from eclat.options import KERNELS, PhotonMap
from eclat.scene import FloatArray, Material, Scene

FORMAT_VERSION = 1

MOST_PATHS = 1 << 20
"""Emitted for a map in which nothing has been stored; where photons are found, `PATHS_PER_PHOTON` times their wanted number
may be emitted besides."""

PATHS_PER_PHOTON = 64


@dataclass(frozen=True)
class Emission:
    """Which paths a map's photons are of: maps of the same ones hold the same photons."""

    seed: int
    paths: int
    """Emitted for the global map."""
    caustic_paths: int
    """Emitted for the caustic map."""


@dataclass(frozen=True, eq=False)
class Photons:
    """The photons of a scene, on surfaces with a diffuse lobe.

    `stored` and `caustic` are (photons, 13) float32 arrays in the core's frame: light that was scattered diffusely before it
    arrived, and light that met mirrors, glass and gloss only. Light straight from lights is not stored: it is sampled where
    it is wanted. Use `positions`, `powers`, `directions`, `normals` and `edges` to look inside. `max_depth` is what it was
    traced with.
    """

    options: PhotonMap
    fingerprint: str
    stored: np.ndarray
    caustic: np.ndarray
    center: FloatArray
    emissions: tuple[Emission, ...]
    statistics: dict[str, float] = field(default_factory=dict)
    max_depth: int = -1

    def __len__(self) -> int:
        """Photons of both maps."""
        return len(self.stored) + len(self.caustic)

    @property
    def nbytes(self) -> int:
        """Of its arrays."""
        return self.stored.nbytes + self.caustic.nbytes

    def _both(self, columns: slice) -> np.ndarray:
        return np.concatenate([self.stored[:, columns], self.caustic[:, columns]])

    @property
    def paths(self) -> tuple[int, int]:
        """Paths emitted for either map."""
        return sum(e.paths for e in self.emissions), sum(e.caustic_paths for e in self.emissions)

    @property
    def positions(self) -> FloatArray:
        """(N, 3) world positions, those of caustic photons last, as in all arrays here."""
        return self._both(slice(0, 3)).astype(np.float64) + self.center

    @property
    def powers(self) -> FloatArray:
        """(N, 3) power of each photon, W: their sum is the indirect flux that arrives on diffuse surfaces."""
        paths = np.repeat(np.maximum(self.paths, 1), (len(self.stored), len(self.caustic)))
        each: FloatArray = self._both(slice(3, 6)).astype(np.float64) / paths[:, None]
        return each

    @property
    def directions(self) -> np.ndarray:
        """(N, 3) unit vectors towards where the photons came from."""
        return self._both(slice(6, 9))

    @property
    def normals(self) -> np.ndarray:
        """(N, 3) unit normals of the surfaces, on the side where the photons arrived."""
        return self._both(slice(9, 12))

    @property
    def edges(self) -> np.ndarray:
        """(N,) edges of the photons' paths: 2 after one bounce."""
        return self._both(slice(12, 13))[:, 0].astype(np.int64)

    @property
    def is_caustic(self) -> np.ndarray:
        """(N,) whether a photon is one of the caustic map."""
        return np.arange(len(self)) >= len(self.stored)

    def core(
        self, scene: Scene, *, gather: bool, threads: int = 0, progress: ProgressReport | None = None
    ) -> _core.PhotonMaps:
        """The maps as the core reads them; with `gather`, irradiance is computed for gather rays to end in."""
        options, (paths, caustic_paths) = self.options, self.paths
        # Where photons of another seed arrive.
        places = (self.emissions[0].seed ^ 0x9E3779B9, options.guided) if gather else None
        return run(
            "photons",
            lambda p: _core.PhotonMaps(
                compiled(scene).core, p,
                np.ascontiguousarray(self.stored, np.float32), float(paths),
                np.ascontiguousarray(self.caustic, np.float32), float(caustic_paths),
                (options.nearest, options.caustic_nearest), KERNELS.index(options.kernel), places, threads,
            ),
            progress,
            _core.Progress(),
        )  # fmt: skip

    def irradiance(
        self, scene: Scene, points: FloatArray, normals: FloatArray, *, caustic: bool = False, threads: int = 0
    ) -> np.ndarray:
        """(N, 3) irradiance at points of surfaces, W·m⁻²: the density of one map there, blur and noise included.

        Light that was scattered diffusely before it arrived, or with `caustic` what met mirrors, glass and gloss only.
        `eclat.irradiance` is the better estimate of all light, at points anywhere.
        """
        self.check(scene, self.max_depth)
        places, sides = points_with_normals(points, normals)
        prepared = compiled(scene)
        maps = self.core(scene, gather=False, threads=threads)
        positions, directions = prepared.to_core(places), np.ascontiguousarray(sides, np.float32)
        return np.asarray(_core.photon_density(prepared.core, positions, directions, maps, caustic, threads))

    def check(self, scene: Scene, max_depth: int) -> None:
        """Raises EclatError where the scene or the depth is not what was traced."""
        if self.fingerprint != fingerprint(scene) or not np.array_equal(self.center, compiled(scene).center):
            raise EclatError(
                "these photons were traced in another scene: geometry, materials or lights differ; trace them again"
            )
        if self.max_depth != max_depth:
            raise EclatError(
                f"these photons were traced with max_depth {self.max_depth}: expected the same, got {max_depth}"
            )

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write to an `.npz` file, whole or not at all. Raises EclatError where it cannot be written."""
        header = {
            "photons": FORMAT_VERSION,
            "fingerprint": self.fingerprint,
            "options": asdict(self.options),
            "emissions": [asdict(e) for e in self.emissions],
            "max_depth": self.max_depth,
            "statistics": self.statistics,
        }
        write_archive(path, header, {"stored": self.stored, "caustic": self.caustic, "center": self.center})

    @staticmethod
    def load(path: str | os.PathLike[str], scene: Scene | None = None) -> Photons:
        """Read saved photons; with `scene`, refuse those that were traced in another. Raises EclatError."""
        name = os.fspath(path)
        header, arrays = read_archive(path, "photons", ("stored", "caustic", "center"))
        if header.get("photons") != FORMAT_VERSION:
            raise EclatError(f"{name}: photons of another version of Éclat: trace them again")
        stored, caustic, center = arrays["stored"], arrays["caustic"], arrays["center"]
        for label, array in (("stored", stored), ("caustic", caustic)):
            if array.ndim != 2 or array.shape[1] != 13 or array.dtype != np.float32 or not np.isfinite(array).all():
                raise EclatError(f"{name}: the array {label!r} is damaged")
        try:
            photons = Photons(
                PhotonMap(**header["options"]), str(header["fingerprint"]), stored, caustic, center,
                tuple(Emission(**e) for e in header["emissions"]), dict(header["statistics"]), int(header["max_depth"]),
            )  # fmt: skip
        except (KeyError, TypeError, ValueError) as error:
            raise EclatError(f"{name}: its header is damaged ({error})") from error
        if scene is not None:
            photons.check(scene, photons.max_depth)
        return photons


def merge_photons(first: Photons, second: Photons) -> Photons:
    """The photons of both, as if they had been emitted together; the order of the two does not matter.

    Raises EclatError where scenes or options differ, or where both hold the same photons (the same seed).
    """
    if first.fingerprint != second.fingerprint:
        raise EclatError("these photons were traced in different scenes")
    if (first.options, first.max_depth) != (second.options, second.max_depth):
        raise EclatError("these photons were traced with different options")
    shared = {e.seed for e in first.emissions} & {e.seed for e in second.emissions}
    if shared:
        raise EclatError(f"these photons are the same, of seed {min(shared)}: expected maps of different seeds")
    one, two = sorted((first, second), key=lambda p: p.emissions[0].seed)
    # Maps of several seeds each may interleave: photons are put in an order of their own.
    return Photons(
        one.options, one.fingerprint, _in_order(one.stored, two.stored), _in_order(one.caustic, two.caustic), one.center,
        tuple(sorted(one.emissions + two.emissions, key=lambda e: e.seed)), max_depth=one.max_depth,
    )  # fmt: skip


class ProgressivePasses:
    """Maps for the samples of a picture, one a pass: sample n of a pixel reads the photons of pass n, in discs that shrink."""

    def __init__(self, scene: Scene, options: PhotonMap, *, max_depth: int, seed: int, threads: int) -> None:
        self._scene, self._options, self._seed, self._threads = compiled(scene), options, seed, threads
        self._max_edges = -1 if max_depth < 0 else max_depth - 1
        self._first: _core.PhotonMaps | None = None

    def maps(self, number: int, progress: _core.Progress) -> _core.PhotonMaps:
        """Those of pass `number`, from 0."""
        if self._first is None:
            self._first = self._traced(0, None, progress)
        return self._first if number == 0 else self._traced(number, self._first, progress)

    def _traced(self, number: int, first: _core.PhotonMaps | None, progress: _core.Progress) -> _core.PhotonMaps:
        o = self._options
        paths = 0 if self._max_edges in (0, 1) else o.photons
        return _core.photons_of_pass(
            self._scene.core, progress, number, paths, first, o.nearest, KERNELS.index(o.kernel), o.alpha,
            self._max_edges, self._seed, self._threads,
        )  # fmt: skip


def _in_order(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    both = np.concatenate([a, b])
    return both[np.lexsort(both.T)]


def _glossy_somewhere(scene: Scene) -> bool:
    """Whether any surface could focus light."""

    def glossy(material: Material) -> bool:
        parts = [*material.children, *([] if material.back is None else [material.back])]
        return material.kind not in ("diffuse", "blend") or any(map(glossy, parts))

    return any(glossy(mesh.material) for mesh in scene.meshes)


def trace(
    scene: Scene,
    options: PhotonMap,
    *,
    max_depth: int = -1,
    seed: int = 0,
    threads: int = 0,
    progress: ProgressReport | None = None,
) -> Photons:
    """Photons of the whole scene. Warns where fewer than wanted were found in many more paths.

    Raises EclatError for progressive photon mapping, which keeps no map.
    """
    if options.progressive:
        raise EclatError(
            "progressive photon mapping keeps no photons, it makes pictures only: expected progressive=False"
        )
    started, counted, prepared = clock.perf_counter(), _core.Progress(), compiled(scene)
    max_edges = -1 if max_depth < 0 else max_depth - 1

    def traced(phase: str, caustic: bool, wanted: int) -> tuple[np.ndarray, int]:
        if max_edges in (0, 1) or (caustic and not _glossy_somewhere(scene)):
            return np.zeros((0, 13), np.float32), 0
        found, paths = run(
            phase,
            lambda p: _core.trace_photons(
                prepared.core,
                p,
                caustic,
                wanted,
                MOST_PATHS + PATHS_PER_PHOTON * wanted,
                max_edges,
                options.guided,
                seed,
                threads,
            ),
            progress,
            counted,
        )
        return found, paths

    stored, paths = traced("photons", False, options.photons)
    caustic, caustic_paths = traced("caustic photons", True, options.caustic_photons)
    if 0 < len(stored) < options.photons:
        warn(f"only {len(stored):,} of {options.photons:,} photons found their way in {paths:,} paths")
    statistics = {
        "photons": float(len(stored)),
        "caustic_photons": float(len(caustic)),
        "paths": float(paths + caustic_paths),
        "rays": float(counted.rays),
        "seconds": clock.perf_counter() - started,
    }
    emission = Emission(seed, paths, caustic_paths)
    return Photons(options, fingerprint(scene), stored, caustic, prepared.center, (emission,), statistics, max_depth)
