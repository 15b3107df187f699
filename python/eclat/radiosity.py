# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""A radiosity solution of a scene as a value: save, load, inspect as arrays, re-use."""

from __future__ import annotations

import json
import os
import time as clock
import zipfile
from collections.abc import Iterator
from dataclasses import asdict, dataclass, field

import numpy as np

from eclat import _core
from eclat.bridge.compiled import compiled, fingerprint
from eclat.bridge.running import ProgressReport, run
from eclat.errors import EclatError, warn
from eclat.files.archive import read_archive, write_archive
from eclat.options import SOLVERS, Radiosity
from eclat.scene import FloatArray, Material, Scene
from eclat.solution import Solution

FORMAT_VERSION = 1

_BACK, _UNKNOWN = 1, 2
"""Bits of the second column of `patches`."""


@dataclass(frozen=True, eq=False)
class RadiositySolution:
    """The patches of a scene and the light on them, for all views.

    `patches` is (N, 4) uint32: the triangle, bits (1 the back, 2 unknown light), and two halves of the path that leads
    to the patch through the halvings of the triangle. `values` is (N, 12) float32: irradiance straight from lights, all
    irradiance, albedo, emitted radiosity. `local_corners` is (N, 3, 3) float32 in the core's frame. Use the properties to
    look inside. `max_depth` is what it was solved with.
    """

    options: Radiosity
    fingerprint: str
    patches: np.ndarray
    values: np.ndarray
    local_corners: np.ndarray
    center: FloatArray
    statistics: dict[str, float] = field(default_factory=dict)
    max_depth: int = -1

    def __len__(self) -> int:
        """Patches."""
        return len(self.patches)

    @property
    def nbytes(self) -> int:
        """Of its arrays."""
        return self.patches.nbytes + self.values.nbytes + self.local_corners.nbytes

    @property
    def triangles(self) -> np.ndarray:
        """(N,) the triangle that each patch is a part of, counted through all meshes of the scene."""
        return self.patches[:, 0]

    @property
    def is_back(self) -> np.ndarray:
        """(N,) whether a patch is of the side that the triangle's normal looks away from."""
        back: np.ndarray = (self.patches[:, 1] & _BACK) != 0
        return back

    @property
    def is_unknown(self) -> np.ndarray:
        """(N,) whether a patch is not shown, but its surroundings: it lies inside a solid and has no light, or a wall that
        stands on it parts it and only the light of the largest part is known."""
        unknown: np.ndarray = (self.patches[:, 1] & _UNKNOWN) != 0
        return unknown

    @property
    def corners(self) -> FloatArray:
        """(N, 3, 3) world positions of the patches' corners, in the order of their triangle."""
        return self.local_corners.astype(np.float64) + self.center

    @property
    def areas(self) -> FloatArray:
        """(N,) area of each patch, m²."""
        a, b, c = np.moveaxis(self.local_corners.astype(np.float64), 1, 0)
        area: FloatArray = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
        return area

    @property
    def normals(self) -> FloatArray:
        """(N, 3) unit normals, on the patch's side."""
        a, b, c = np.moveaxis(self.local_corners.astype(np.float64), 1, 0)
        normal = np.cross(b - a, c - a)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        turned: FloatArray = np.where(self.is_back[:, None], -normal, normal)
        return turned

    @property
    def direct(self) -> np.ndarray:
        """(N, 3) irradiance straight from lights, W·m⁻²."""
        return self.values[:, 0:3]

    @property
    def irradiance(self) -> np.ndarray:
        """(N, 3) irradiance, W·m⁻²."""
        return self.values[:, 3:6]

    @property
    def albedo(self) -> np.ndarray:
        """(N, 3) mean albedo, of gloss as if it were diffuse."""
        return self.values[:, 6:9]

    @property
    def emitted(self) -> np.ndarray:
        """(N, 3) radiosity of the patches' own light, W·m⁻²: π times the emitted radiance."""
        return self.values[:, 9:12]

    @property
    def radiosity(self) -> np.ndarray:
        """(N, 3) all light that leaves the patches, W·m⁻²; over π it is their radiance."""
        leaving: np.ndarray = self.emitted + self.albedo * self.irradiance
        return leaving

    def core(self, scene: Scene, *, threads: int = 0) -> _core.RadiosityField:
        """The solution as the core reads it. Raises EclatError where its patches are not those of the scene."""
        patches, values = np.ascontiguousarray(self.patches), np.ascontiguousarray(self.values)
        try:
            return _core.RadiosityField(compiled(scene).core, patches, values, threads)
        except ValueError as error:
            raise EclatError(f"radiosity solution: {error}") from error

    def check(self, scene: Scene, max_depth: int) -> None:
        """Raises EclatError where the scene or the depth is not what was solved."""
        if self.fingerprint != fingerprint(scene) or not np.array_equal(self.center, compiled(scene).center):
            raise EclatError(
                "this radiosity was solved for another scene: geometry, materials or lights differ; solve it again"
            )
        if self.max_depth != max_depth:
            raise EclatError(
                f"this radiosity was solved with max_depth {self.max_depth}: expected the same, got {max_depth}"
            )

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write to an `.npz` file, whole or not at all. Raises EclatError where it cannot be written."""
        header = {
            "radiosity": FORMAT_VERSION,
            "fingerprint": self.fingerprint,
            "options": asdict(self.options),
            "max_depth": self.max_depth,
            "statistics": self.statistics,
        }
        write_archive(
            path,
            header,
            {"patches": self.patches, "values": self.values, "corners": self.local_corners, "center": self.center},
        )

    @staticmethod
    def load(path: str | os.PathLike[str], scene: Scene | None = None) -> RadiositySolution:
        """Read a saved solution; with `scene`, refuse one that was solved for another. Raises EclatError."""
        name = os.fspath(path)
        header, arrays = read_archive(path, "a radiosity solution", ("patches", "values", "corners", "center"))
        patches, values, corners, center = arrays.values()
        if header.get("radiosity") != FORMAT_VERSION:
            raise EclatError(f"{name}: a radiosity solution of another version of Éclat: solve the scene again")
        count = len(patches) if patches.ndim else 0
        expected = {
            "patches": (patches, (count, 4), np.uint32), "values": (values, (count, 12), np.float32),
            "corners": (corners, (count, 3, 3), np.float32),
        }  # fmt: skip
        for label, (array, shape, kind) in expected.items():
            if array.shape != shape or array.dtype != kind or not np.isfinite(array).all():
                raise EclatError(f"{name}: the array {label!r} is damaged")
        try:
            solution = RadiositySolution(
                Radiosity(**header["options"]), str(header["fingerprint"]), patches, values, corners, center,
                dict(header["statistics"]), int(header["max_depth"]),
            )  # fmt: skip
        except (KeyError, TypeError, ValueError) as error:
            raise EclatError(f"{name}: its header is damaged ({error})") from error
        if scene is not None:
            solution.check(scene, solution.max_depth)
        return solution


def load_solved(path: str | os.PathLike[str], scene: Scene) -> Solution | RadiositySolution:
    """What `eclat solve` wrote, of either kind. Raises EclatError."""
    try:
        with np.load(path, allow_pickle=False) as data:
            is_radiosity = "radiosity" in json.loads(str(data["header"]))
    except (OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile, EOFError, NotImplementedError):
        is_radiosity = False  # a Solution's reader says what is wrong
    return RadiositySolution.load(path, scene) if is_radiosity else Solution.load(path, scene)


def solve_radiosity(
    scene: Scene,
    options: Radiosity,
    *,
    max_depth: int = -1,
    seed: int = 0,
    threads: int = 0,
    progress: ProgressReport | None = None,
) -> RadiositySolution:
    """Radiosity of the whole scene. Warns of materials that are not diffuse, naming what is done with them.

    Raises EclatError where the options ask for more than five million patches.
    """
    started, counted, prepared = clock.perf_counter(), _core.Progress(), compiled(scene)
    _tell_of_gloss(scene)
    # A final gather adds an edge of its own before it meets a patch.
    bounces = -1 if max_depth < 0 else max(0, max_depth - (2 if options.gather else 1))
    try:
        patches, values, corners, numbers = run(
            "radiosity",
            lambda p: _core.solve_radiosity(
                prepared.core, p, options.patch_size or 0.0, options.patches, options.refinements, options.tolerance,
                SOLVERS.index(options.solver), bounces, seed, threads,
            ),
            progress,
            counted,
        )  # fmt: skip
    except ValueError as error:
        raise EclatError(str(error)) from error
    named = zip(("links", "sweeps", "residual", "closure_error", "tolerance"), map(float, numbers), strict=True)
    statistics = {"patches": float(len(patches)), **dict(named)}
    statistics |= {"rays": float(counted.rays), "seconds": clock.perf_counter() - started}
    return RadiositySolution(
        options, fingerprint(scene), patches, values, corners, prepared.center, statistics, max_depth
    )


def _tell_of_gloss(scene: Scene) -> None:
    """Warn of what radiosity knows only as diffuse, or not at all."""
    reflecting, transmitting = set(), set()
    for mesh in scene.meshes:
        for material in _parts(mesh.material):
            if material.kind in ("dielectric", "thin_dielectric") or (
                material.kind == "metallic_roughness" and "transmission" in material.parameters
            ):
                transmitting.add(material.name or material.kind)
            elif material.kind not in ("diffuse", "blend"):
                reflecting.add(material.name or material.kind)
    if reflecting:
        warn(
            f"radiosity is diffuse: what {_listed(reflecting)} would reflect is passed on as by diffuse surfaces; "
            "what the camera sees of their gloss is traced"
        )
    if transmitting:
        warn(f"radiosity is diffuse: no light passes through {_listed(transmitting)} to other surfaces")


def _parts(material: Material) -> Iterator[Material]:
    yield material
    for part in (*material.children, *([] if material.back is None else [material.back])):
        yield from _parts(part)


def _listed(names: set[str]) -> str:
    shown = sorted(names)[:5]
    more = len(names) - len(shown)
    return ", ".join(shown) + (f" and {more} more" if more else "")
