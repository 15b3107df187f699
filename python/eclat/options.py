# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The methods and what can be set on each. Every field has a default that needs no touching."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import ClassVar, Literal

from eclat.errors import EclatError, did_you_mean


@dataclass(frozen=True)
class Direct:
    """Emission and light that arrives straight from lights: paths of at most two edges."""

    cannot: ClassVar[str] = (
        "All indirect light is missing: of every path that is longer than from a light to a surface to the camera."
    )
    """What a method leaves out or gets wrong, for people who compare; every method says so."""


@dataclass(frozen=True)
class Path:
    """Unbiased path tracing: the reference."""

    cannot: ClassVar[str] = (
        "Caustics of small lamps are met by chance; those of point, spot and directional lights never, so they are missing. "
        "Nothing else is wrong but noise."
    )

    roulette_depth: int = 5
    """Edges of a path before it may be ended at random (1 or more)."""

    def __post_init__(self) -> None:
        _check_range("Path", "roulette_depth", self.roulette_depth, 1, 10**6)


WEIGHTS = ("tabellion", "ward", "split-sphere")
"""How records can be weighted, in the core's order."""

BALANCED = ("squared", "absolute")
"""Which error of records can be held the same, in the core's order."""

METRICS = ("occlusion", "radiometric", "geometric", "minimum", "harmonic")
"""What the radius of a record can follow, in the core's order."""


@dataclass(frozen=True)
class IrradianceCache:
    """Irradiance caching: diffuse indirect light from records, the rest traced.

    `max_error` steers the spacing and the rays of records, near and far; the other fields are None for "what max_error asks for".
    """

    cannot: ClassVar[str] = (
        "Only indirect light on diffuse surfaces is cached; glossy reflections are traced, with noise. Indirect shadows "
        "narrower than a record's radius are blurred. Caustics of small lamps are met by chance, those of point, spot and "
        "directional lights are missing."
    )

    max_error: float = 0.01
    """Wanted relative error of the indirect light, 0.0005..0.5."""
    weight: Literal["tabellion", "ward", "split-sphere"] = "tabellion"
    """How records are weighted: Tabellion and Lamorlette 2004; Ward's sum of errors, with the same guards against leaks;
    or Ward's split sphere as published (1988), without them: for comparisons."""
    metric: Literal["occlusion", "radiometric", "geometric", "minimum", "harmonic"] = "occlusion"
    """What a record's radius follows: how irradiance bends, with what hides and appears (Schwarzhaupt et al. 2012),
    without it, or for even radiance (Jarosz et al. 2012); the least distance to what it sees; or the harmonic mean of
    all distances (Ward 1988)."""
    balanced: Literal["squared", "absolute"] = "squared"
    """Which error is held the same for all records that follow curvature: its squares, summed over pixels, which makes the
    least error for a number of records; or its absolute values, as Schwarzhaupt et al. (2012) do."""
    spacing: float | None = None
    """Radius of a record in units of that distance."""
    rows: int | None = None
    """Rows M of a gather; it has about π·M² rays."""
    least_pixels: float = 1.0
    """Lower bound of a record's radius, in pixels."""
    largest_pixels: float = 40.0
    """Upper bound of a record's radius, in pixels."""
    relaxation: float = 2.0
    """How much farther a record is read than it keeps others from being placed (1 or more)."""
    rotation_gradient: bool = True
    translation_gradient: bool = True
    neighbor_clamping: bool = True
    """Radii differ no more than places do (Křivánek et al. 2006)."""
    adaptive: bool = True
    """Where overlapping records disagree by more than twice `max_error`, beyond what their noise explains, the worse one's
    radius shrinks, and the next pass fills the gap (Křivánek et al. 2006). Records of radiance are compared by what they
    reflect."""
    gradient_limit: bool = True
    """A radius is no longer than the gradient would take to change the record's value by all of it."""
    obstacle_limit: bool = True
    """What curvature allows is bounded by the least distance to what stands apart from the surface."""
    far_records: int | None = None
    """Candidates for the coarse records in which gather rays end; 0 traces every path to its end."""
    far_rows: int | None = None
    """Rows of the gathers of far records."""
    far_spacing: float = 0.3
    """Radius of a far record in units of the distance to what it sees."""
    far_photons: int = 0
    """Photons in whose irradiance gather rays end, instead of far records; 0 for none. Not under an environment image."""

    def __post_init__(self) -> None:
        _check_range("IrradianceCache", "max_error", self.max_error, 0.0005, 0.5)
        if self.spacing is not None:
            _check_range("IrradianceCache", "spacing", self.spacing, 0.01, 8)
        if self.rows is not None:
            _check_range("IrradianceCache", "rows", self.rows, 2, 256)
        _check_range("IrradianceCache", "far_spacing", self.far_spacing, 0.01, 2)
        if self.far_rows is not None:
            _check_range("IrradianceCache", "far_rows", self.far_rows, 2, 256)
        if self.far_records is not None:
            _check_range("IrradianceCache", "far_records", self.far_records, 0, 10**7)
        _check_range("IrradianceCache", "far_photons", self.far_photons, 0, 10**8)
        _check_range("IrradianceCache", "least_pixels", self.least_pixels, 0.25, 1000)
        _check_range("IrradianceCache", "largest_pixels", self.largest_pixels, self.least_pixels, 10**5)
        _check_range("IrradianceCache", "relaxation", self.relaxation, 1, 4)
        for name, known in (("weight", WEIGHTS), ("metric", METRICS), ("balanced", BALANCED)):
            _check_known("IrradianceCache", name, getattr(self, name), known)


@dataclass(frozen=True)
class RadianceCache(IrradianceCache):
    """Radiance caching: irradiance caching for diffuse surfaces, and records of light by direction for glossy ones; what is
    too sharp is traced.

    Records of radiance are made for views and for all surfaces; for points, which have no lobes, only those of irradiance.
    """

    cannot: ClassVar[str] = (
        "Lobes sharper than the harmonics of its order are traced, with noise. Indirect shadows narrower than a record's "
        "radius, and reflections of what is smaller than a lobe, are blurred. Caustics of small lamps are met by chance, "
        "those of point, spot and directional lights are missing."
    )

    order: int = 8
    """Bands of the harmonics in which light and lobes are written, 2..12; order² numbers a colour."""
    gloss_error: float = 0.4
    """Relative L2 error of a lobe in that order up to which it is cached; what is worse is traced."""
    gloss_spacing: float | None = None
    """As spacing, for a lobe as wide as a diffuse one; narrower lobes reach less far."""
    gloss_rows: int | None = None
    """Rows of a gather of radiance."""

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_range("RadianceCache", "order", self.order, 2, 12)
        _check_range("RadianceCache", "gloss_error", self.gloss_error, 0.001, 1)
        if self.gloss_spacing is not None:
            _check_range("RadianceCache", "gloss_spacing", self.gloss_spacing, 0.01, 2)
        if self.gloss_rows is not None:
            _check_range("RadianceCache", "gloss_rows", self.gloss_rows, 2, 256)


KERNELS = ("uniform", "cone", "epanechnikov")
"""How photons can be weighted, in the core's order."""


@dataclass(frozen=True)
class PhotonMap:
    """Photon mapping: indirect light from photons that are traced from the lights; caustics too."""

    cannot: ClassVar[str] = (
        "Light is blurred over the disc of an estimate, and at edges and thin walls some is lost or leaks; only with "
        "`progressive` does that vanish. Glossy reflections are traced, with noise."
    )

    photons: int = 200_000
    """Photons to store of light that was scattered diffusely before it arrived."""
    caustic_photons: int = 200_000
    """Photons to store of light that met mirrors, glass and gloss only."""
    nearest: int = 100
    """Photons of one estimate: more are smoother and blur more."""
    caustic_nearest: int = 60
    """The same for caustics."""
    kernel: Literal["uniform", "cone", "epanechnikov"] = "epanechnikov"
    """How a photon's weight falls with its distance."""
    gather: int = 4
    """Rays of a final gather, per sample of a pixel; 0 shows the photons directly."""
    guided: bool = True
    """Learn where on lights and in which directions to emit, so that most photons are stored."""
    progressive: bool = False
    """Trace new photons for each sample of the pixels and show them directly, in discs that shrink from sample to sample:
    noise and blur both vanish. `photons` is then the number of paths emitted for a sample, of all kinds together."""
    alpha: float = 0.7
    """How slowly discs of `progressive` shrink, 0.1..0.95: larger is smoother and blurs longer."""

    def __post_init__(self) -> None:
        _check_range("PhotonMap", "photons", self.photons, 1000, 10**8)
        _check_range("PhotonMap", "caustic_photons", self.caustic_photons, 1000, 10**8)
        _check_range("PhotonMap", "nearest", self.nearest, 8, 10**5)
        _check_range("PhotonMap", "caustic_nearest", self.caustic_nearest, 8, 10**5)
        _check_range("PhotonMap", "gather", self.gather, 0, 10**4)
        _check_range("PhotonMap", "alpha", self.alpha, 0.1, 0.95)
        _check_known("PhotonMap", "kernel", self.kernel, KERNELS)


SOLVERS = ("gathering", "shooting")
"""How the equation of radiosity can be solved, in the core's order."""


@dataclass(frozen=True)
class Radiosity:
    """Radiosity: surfaces in patches that exchange light diffusely, solved once for all views."""

    cannot: ClassVar[str] = (
        "All reflection is taken for diffuse on its way from surface to surface: there are no caustics, and no light passes "
        "through glass. Straight from patches (`gather=0`) shadows are as sharp as these are small. In scenes of many small "
        "triangles light that reaches corners through gaps is coarse."
    )

    patches: int = 20_000
    """About how many patches there are in the end besides one for each side of a triangle (two where a surface has both)."""
    patch_size: float | None = None
    """Longest edge of a patch in metres, instead; where light changes fast patches are smaller."""
    refinements: int = 2
    """How often patches are divided where the light of neighbours differs: at the edges of shadows and in corners."""
    tolerance: float = 0.003
    """Irradiance that a link may carry without being refined, relative to the mean radiosity, 0.0001..1. More where that takes
    too many links: the solution's `statistics["tolerance"]` is the one that held."""
    solver: Literal["gathering", "shooting"] = "gathering"
    """All patches gather from all others at a time, or the brightest send first (progressive refinement)."""
    gather: int = 4
    """Rays of a final gather, per sample of a pixel; 0 shows the patches directly, smoothly reconstructed."""

    def __post_init__(self) -> None:
        _check_range("Radiosity", "patches", self.patches, 1, 10**8)
        if self.patch_size is not None:
            _check_range("Radiosity", "patch_size", self.patch_size, 1e-9, 1e9)
        _check_range("Radiosity", "refinements", self.refinements, 0, 8)
        _check_range("Radiosity", "tolerance", self.tolerance, 0.0001, 1)
        _check_range("Radiosity", "gather", self.gather, 0, 10**4)
        _check_known("Radiosity", "solver", self.solver, SOLVERS)


Options = Direct | Path | IrradianceCache | RadianceCache | PhotonMap | Radiosity

METHODS: dict[str, type[Options]] = {
    "direct": Direct,
    "path": Path,
    "irradiance-cache": IrradianceCache,
    "radiance-cache": RadianceCache,
    "photon-map": PhotonMap,
    "radiosity": Radiosity,
}
"""Name on the command line → options class."""


def method_name(options: Options) -> str:
    """The name in `METHODS` of an options object."""
    return next(name for name, cls in METHODS.items() if cls is type(options))


def make_options(method: str, **settings: object) -> Options:
    """Options of `method` with some fields set. Raises EclatError for an unknown method or field."""
    if method not in METHODS:
        raise EclatError(
            f"unknown method {method!r}, expected one of {', '.join(METHODS)}{did_you_mean(method, METHODS)}"
        )
    known = [f.name for f in fields(METHODS[method])]
    for key in settings:
        if key not in known:
            raise EclatError(f"unknown option {key} for {method}{did_you_mean(key, known)}")
    return METHODS[method](**settings)  # type: ignore[arg-type]


def _check_known(where: str, name: str, value: object, known: tuple[str, ...]) -> None:
    if value not in known:
        raise EclatError(
            f"{where}: {name} must be one of {', '.join(known)}, got {value!r}" + did_you_mean(str(value), known)
        )


def _check_range(where: str, name: str, value: float, low: float, high: float) -> None:
    if not isinstance(value, int | float) or math.isnan(value) or not low <= value <= high:
        raise EclatError(f"{where}: {name} must be between {low:g} and {high:g}, got {value!r}")
