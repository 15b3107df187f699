# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""Radiosity: the method with its options, and its solution, the patches of a scene with the light on them."""

from __future__ import annotations

import dataclasses
import time as clock
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal

import numpy as np

from eclat import _core
from eclat.bridge.compiled import compiled, fingerprint
from eclat.bridge.running import run
from eclat.errors import EclatError, warn
from eclat.methods.method import Method, Solved
from eclat.methods.ranges import check_names, check_range, check_types, core_enum
from eclat.methods.saved import Common, DamagedArrayError
from eclat.methods.work import Care, Purpose, Work
from eclat.scene import FloatArray, Material, Scene, triangle_areas


@dataclass(frozen=True, eq=False, repr=False)
class RadiositySolution(Solved):
    """The patches of a scene and the light on them, which do not depend on the view.

    `patches` is (N, 4) uint32. Its columns are the index of the triangle; a set of bits (1: the patch is on the back,
    2: its light is unknown); and two words that encode the bisections by which the patch was divided from the triangle.
    `values` is (N, 15) float32: irradiance straight from lights, total irradiance, albedo, and emitted and transmitted
    radiosity, with three colour channels each. `local_corners` is (N, 3, 3) float32, in metres relative to `center`.
    The properties give these values by name. `max_depth` is the greatest number of edges of a path in the solution; −1
    means no limit. The light that passes straight through panes is not part of the values of their patches, which hold
    for the rest, as if a pane were an opaque surface that is there in part.
    """

    called: ClassVar[str] = "radiosity solution"
    consists_of: ClassVar[str] = "patches"
    format: ClassVar[int] = 3

    options: Radiosity
    fingerprint: str
    patches: np.ndarray
    values: np.ndarray
    local_corners: np.ndarray
    center: FloatArray
    statistics: dict[str, float] = dataclasses.field(default_factory=dict)
    max_depth: int = -1

    def __len__(self) -> int:
        """Return the number of patches."""
        return len(self.patches)

    @property
    def triangles(self) -> np.ndarray:
        """(N,) index of the triangle that contains each patch, counted over all meshes of the scene."""
        return self.patches[:, 0]

    @property
    def is_back(self) -> np.ndarray:
        """(N,) True for patches on the back of their triangle."""
        back: np.ndarray = (self.patches[:, 1] & _core.PATCH_IS_BACK) != 0
        return back

    @property
    def is_unknown(self) -> np.ndarray:
        """(N,) True for patches whose light is unknown, which take the light of their surroundings in pictures.

        These patches lie inside a solid, where no light arrives, or a wall divides them, so that only the light of
        their largest part is known.
        """
        unknown: np.ndarray = (self.patches[:, 1] & _core.PATCH_IS_UNKNOWN) != 0
        return unknown

    @property
    def corners(self) -> FloatArray:
        """(N, 3, 3) world positions of the patches' corners in metres, in the same orientation as the triangle."""
        return self.local_corners.astype(np.float64) + self.center

    @property
    def areas(self) -> FloatArray:
        """(N,) areas of the patches in m²."""
        return triangle_areas(self.local_corners)

    @property
    def normals(self) -> FloatArray:
        """(N, 3) unit normals, which point to the side of the triangle that the patch is on."""
        a, b, c = np.moveaxis(self.local_corners.astype(np.float64), 1, 0)
        normal = np.cross(b - a, c - a)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        turned: FloatArray = np.where(self.is_back[:, None], -normal, normal)
        return turned

    @property
    def direct(self) -> np.ndarray:
        """(N, 3) irradiance straight from lights in W·m⁻²."""
        return self.values[:, 0:3]

    @property
    def irradiance(self) -> np.ndarray:
        """(N, 3) total irradiance in W·m⁻²."""
        return self.values[:, 3:6]

    @property
    def albedo(self) -> np.ndarray:
        """(N, 3) mean albedo; glossy reflection counts as diffuse."""
        return self.values[:, 6:9]

    @property
    def emitted(self) -> np.ndarray:
        """(N, 3) radiosity of the light that the patches emit, in W·m⁻²: π times the emitted radiance."""
        return self.values[:, 9:12]

    @property
    def transmitted(self) -> np.ndarray:
        """(N, 3) radiosity of the light that the patches let through from their other side, in W·m⁻²."""
        return self.values[:, 12:15]

    @property
    def radiosity(self) -> np.ndarray:
        """(N, 3) radiosity of all light that leaves the patches, in W·m⁻²; divided by π it is their radiance."""
        leaving: np.ndarray = self.emitted + self.albedo * self.irradiance + self.transmitted
        return leaving

    def field(self, scene: Scene, *, threads: int = 0) -> _core.RadiosityField:
        """Convert the solution to the compiled core.

        Raises EclatError if the patches do not belong to the scene.
        """
        patches, values = np.ascontiguousarray(self.patches), np.ascontiguousarray(self.values)
        try:
            return _core.RadiosityField(compiled(scene).core, patches, values, threads)
        except ValueError as error:
            raise EclatError(f"radiosity solution: {error}") from error

    def radiance_estimator(self, scene: Scene, work: Work) -> _core.Estimator:
        field = self.field(scene, threads=work.threads)
        core, gather = compiled(scene).core, self.options.gather
        return _core.radiosity_estimator(core, field, gather_rays=gather, max_depth=work.max_depth)

    def point_estimator(self, scene: Scene, work: Work) -> _core.PointEstimator:
        return _core.radiosity_point_estimator(compiled(scene).core, self.field(scene, threads=work.threads))

    def remarks(self) -> list[str]:
        return [f"{self.statistics['links']:,.0f} links"] if "links" in self.statistics else []

    def arrays(self) -> dict[str, np.ndarray]:
        return {"patches": self.patches, "values": self.values, "corners": self.local_corners, "center": self.center}

    @classmethod
    def from_parts(
        cls, common: Common, header: Mapping[str, Any], arrays: Mapping[str, np.ndarray]
    ) -> RadiositySolution:
        patches, values, corners = (arrays.get(name, np.zeros(0)) for name in ("patches", "values", "corners"))
        count = len(patches) if patches.ndim else 0
        expected = {
            "patches": (patches, (count, 4), np.uint32), "values": (values, (count, 15), np.float32),
            "corners": (corners, (count, 3, 3), np.float32),
        }  # fmt: skip
        for label, (array, shape, kind) in expected.items():
            if array.shape != shape or array.dtype != kind or not np.isfinite(array).all():
                raise DamagedArrayError(label)
        return cls(
            common.options, common.fingerprint, patches, values, corners, arrays["center"], common.statistics,
            common.max_depth,
        )  # fmt: skip


def solve_radiosity(scene: Scene, options: Radiosity, work: Work) -> RadiositySolution:
    """Compute the radiosity of the whole scene.

    Warns which materials are not diffuse and how radiosity treats them.

    Raises EclatError if the options ask for more than five million patches.
    """
    started, counted, prepared = clock.perf_counter(), _core.Progress(), compiled(scene)
    _tell_of_gloss(scene)
    core_options = _core.RadiosityOptions()
    core_options.patch_size = options.patch_size or 0.0
    core_options.patches, core_options.refinements = options.patches, options.refinements
    core_options.tolerance, core_options.solver = options.tolerance, core_enum(_core.RadiositySolver, options.solver)
    # A final gather adds one edge to each path before the path reaches a patch.
    core_options.bounces = -1 if work.max_depth < 0 else max(0, work.max_depth - (2 if options.gather else 1))
    core_options.seed, core_options.threads = work.seed, work.threads
    try:
        patches, values, corners, numbers = run(
            "radiosity", lambda p: _core.solve_radiosity(prepared.core, core_options, p), work.progress, counted
        )
    except ValueError as error:
        raise EclatError(str(error)) from error
    statistics = {"patches": float(len(patches)), **numbers}
    statistics |= {"rays": float(counted.rays), "seconds": clock.perf_counter() - started}
    return RadiositySolution(
        options, fingerprint(scene), patches, values, corners, prepared.center, statistics, work.max_depth
    )


def _tell_of_gloss(scene: Scene) -> None:
    """Warn about the materials that radiosity treats as diffuse and about solid glass, which it treats as opaque."""
    reflecting, transmitting = set(), set()
    for mesh in scene.meshes:
        for material in _parts(mesh.material):
            if material.kind == "dielectric" or (
                material.kind == "metallic_roughness"
                and "transmission" in material.parameters
                and not material.thin_walled
            ):
                transmitting.add(material.name or material.kind)
            elif material.kind not in ("diffuse", "translucent", "blend"):
                reflecting.add(material.name or material.kind)
    if reflecting:
        warn(
            f"radiosity treats all surfaces as diffuse: {_listed(reflecting)} will light other surfaces as diffuse "
            "surfaces do; gloss that the camera sees directly is traced"
        )
    if transmitting:
        warn(
            f"radiosity treats all surfaces as diffuse: no light will pass through {_listed(transmitting)} to other "
            "surfaces, because it bends light; thin panes let it through"
        )


def _parts(material: Material) -> Iterator[Material]:
    yield material
    for part in (*material.children, *([] if material.back is None else [material.back])):
        yield from _parts(part)


def _listed(names: set[str]) -> str:
    shown = sorted(names)[:5]
    more = len(names) - len(shown)
    return ", ".join(shown) + (f" and {more} more" if more else "")


@dataclass(frozen=True)
class Radiosity(Method):
    """Radiosity: surfaces are divided into patches that exchange diffuse light, solved once for all views."""

    name: ClassVar[str] = "radiosity"
    cannot: ClassVar[str] = (
        "Radiosity treats every reflection from one surface to another as diffuse, so there are no caustics, and no light "
        "passes through solid glass, only through thin panes. If the patches are shown directly (`gather=0`), shadows are "
        "blurred over the size of a patch. In scenes of many small triangles, light that reaches corners through gaps is "
        "inaccurate."
    )
    solved: ClassVar[type[Solved] | None] = RadiositySolution

    patches: int = 20_000
    """Approximate number of patches that subdivision adds to the initial patches, of which each side of a triangle has
    one."""
    patch_size: float | None = None
    """Longest edge of a patch in metres, instead of a number of patches. Where the light changes quickly, patches are
    smaller."""
    refinements: int = 2
    """How many times patches are subdivided further where the light of neighbouring patches differs, such as at the
    edges of shadows and in corners."""
    tolerance: float = 0.003
    """Irradiance above which a link between two patches is refined, relative to the mean radiosity, 0.0001..1. If there
    would be too many links, the value is raised; `statistics["tolerance"]` of the solution is the value that was
    used."""
    solver: Literal["gathering", "shooting"] = "gathering"
    """Order of the light exchange. With `gathering`, all patches collect light from all others at once; with
    `shooting`, the brightest patches send their light first (progressive refinement)."""
    gather: int = 4
    """Number of rays of the final gather per sample of a pixel. With 0, the patches are shown directly and interpolated
    smoothly."""

    def __post_init__(self) -> None:
        check_types(self)
        check_range(self, "patches", 1, 10**8)
        check_range(self, "patch_size", 1e-9, 1e9)
        check_range(self, "refinements", 0, 8)
        check_range(self, "tolerance", 0.0001, 1)
        check_range(self, "gather", 0, 10**4)
        check_names(self, "solver")

    def solve(self, scene: Scene, purpose: Purpose, work: Work, care: Care | None = None) -> RadiositySolution:
        return solve_radiosity(scene, self, work)

    def at_effort(self, share: float, max_error: float) -> Radiosity:
        return replace(self, patches=max(1, int(self.patches * share)))
