# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What an algorithm learned about a scene, as a value: save, load, merge, inspect as arrays, re-use."""

from __future__ import annotations

import json
import os
import tempfile
import zipfile
from dataclasses import asdict, dataclass, field
from pathlib import Path as FilePath

import numpy as np

from eclat import _core
from eclat.compiled import compiled, fingerprint
from eclat.errors import EclatError
from eclat.options import IrradianceCache
from eclat.scene import FloatArray, Scene

FORMAT_VERSION = 2

_COLUMNS = {
    "positions": slice(0, 3),
    "normals": slice(3, 6),
    "irradiance": slice(6, 9),
    "excess": slice(9, 12),
    "rotation_gradients": slice(12, 21),
    "translation_gradients": slice(21, 30),
    "distances": slice(30, 31),
    "radii": slice(31, 32),
}


def core_options(options: IrradianceCache, *, max_depth: int = -1, seed: int = 0, threads: int = 0) -> _core.IrradianceCacheOptions:
    """The core's options. `max_error` sets what is None: the error of first-order extrapolation grows with the square
    of a record's radius, a gather's noise falls with the number of its rows."""
    out = _core.IrradianceCacheOptions()
    relative = options.max_error / 0.01
    out.spacing = options.spacing if options.spacing is not None else min(0.9, 0.4 * relative**0.5)
    out.rows = options.rows if options.rows is not None else int(np.clip(round(18 * relative**-0.5), 8, 64))
    out.harmonic = options.distance == "harmonic"
    out.ward_weight = options.weight == "ward"
    for name in (
        "relaxation", "rotation_gradient", "translation_gradient", "neighbor_clamping", "gradient_limit",
        "least_pixels", "largest_pixels", "far_rows", "far_records",
    ):  # fmt: skip
        setattr(out, name, getattr(options, name))
    out.max_depth, out.seed, out.threads = max_depth, seed, threads
    return out


@dataclass(frozen=True, eq=False)
class Solution:
    """A solved irradiance cache of one scene.

    `near` and `far` are (records, floats) float32 arrays in the core's frame; use `positions`, `normals`, `radii`,
    `irradiance` and the gradients to look inside.
    """

    options: IrradianceCache
    fingerprint: str
    near: np.ndarray
    far: np.ndarray
    center: FloatArray
    statistics: dict[str, float] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.near)

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
    def rotation_gradients(self) -> np.ndarray:
        """(N, 3 channels, 3) gradient for a turn of the normal, W·m⁻² per radian."""
        return self._column("rotation_gradients").reshape(-1, 3, 3)

    @property
    def translation_gradients(self) -> np.ndarray:
        """(N, 3 channels, 3) gradient in the tangent plane, W·m⁻³."""
        return self._column("translation_gradients").reshape(-1, 3, 3)

    def core(self) -> _core.SolvedCaches:
        """The caches as the core reads them."""
        return _core.SolvedCaches(
            np.ascontiguousarray(self.near, np.float32), np.ascontiguousarray(self.far, np.float32), core_options(self.options)
        )

    def check(self, scene: Scene) -> None:
        """Raises EclatError where the scene is not the one that was solved."""
        if self.fingerprint != fingerprint(scene):
            raise EclatError("this cache was solved for another scene (geometry, materials or lights differ): solve it again")

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write to an `.npz` file, whole or not at all."""
        target = FilePath(path)
        header = {
            "format": FORMAT_VERSION,
            "fingerprint": self.fingerprint,
            "options": asdict(self.options),
            "statistics": self.statistics,
        }
        descriptor, temporary = tempfile.mkstemp(dir=target.parent or ".", prefix=f".{target.name}.", suffix=".part")
        try:
            with os.fdopen(descriptor, "wb") as file:
                np.savez(file, header=json.dumps(header), near=self.near, far=self.far, center=self.center)
            os.replace(temporary, target)
        except BaseException:
            FilePath(temporary).unlink(missing_ok=True)
            raise

    @staticmethod
    def load(path: str | os.PathLike[str], scene: Scene | None = None) -> Solution:
        """Read a saved cache; with `scene`, refuse one that was solved for another. Raises EclatError."""
        try:
            with np.load(path, allow_pickle=False) as data:
                header = json.loads(str(data["header"]))
                near, far, center = data["near"], data["far"], data["center"]
        except FileNotFoundError as error:
            raise EclatError(f"{path}: no such file") from error
        except (OSError, ValueError, KeyError, zipfile.BadZipFile, EOFError) as error:
            raise EclatError(f"{path}: not a cache that Éclat saved, or damaged ({error})") from error
        if not isinstance(header, dict) or header.get("format") != FORMAT_VERSION:
            raise EclatError(f"{path}: a cache of another version of Éclat: solve the scene again")
        for name, array in (("near", near), ("far", far)):
            if array.ndim != 2 or array.dtype != np.float32 or not np.isfinite(array[:, :12]).all():
                raise EclatError(f"{path}: the array {name!r} is damaged")
        solution = Solution(
            IrradianceCache(**header["options"]), header["fingerprint"], near, far, center, header.get("statistics", {})
        )
        if scene is not None:
            solution.check(scene)
        return solution


def merge(first: Solution, second: Solution) -> Solution:
    """The records of both, sorted, without duplicates. Commutative; not the same as one joint solve.

    Raises EclatError where scenes or options differ.
    """
    if first.fingerprint != second.fingerprint:
        raise EclatError("these caches were solved for different scenes")
    if first.options != second.options:
        raise EclatError("these caches were solved with different options")

    def union(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        both = np.concatenate([a, b])
        keys = np.ascontiguousarray(both).view(np.dtype((np.void, both.dtype.itemsize * both.shape[1]))).ravel()
        return both[np.unique(keys, return_index=True)[1]] if len(both) else both

    return Solution(
        first.options, first.fingerprint, union(first.near, second.near), union(first.far, second.far), first.center
    )


def solved_from_core(
    scene: Scene, options: IrradianceCache, caches: _core.SolvedCaches, statistics: dict[str, float]
) -> Solution:
    """A Solution from what the core solved."""
    return Solution(options, fingerprint(scene), caches.near, caches.far, compiled(scene).center, statistics)
