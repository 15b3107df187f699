# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
# Written by tools/make_stub.py from the compiled module: not edited by hand.

from collections.abc import Sequence
import enum
from typing import Annotated, overload

import numpy
from numpy.typing import NDArray

class MeasuredBrdf:
    def eval(
        self,
        wo: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
        wi: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    ) -> tuple[NDArray[numpy.float32], NDArray[numpy.float32]]:
        """
        Values (N, 3) without the cosine, and the densities (N,) of `directions`.
        """

    def directions(
        self,
        wo: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
        u: Annotated[NDArray[numpy.float32], dict(shape=(None, 2), order="C", device="cpu", writable=False)],
    ) -> NDArray[numpy.float32]:
        """Directions (N, 3) of light that random numbers (N, 2) choose."""

    def albedo(
        self, wo: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)]
    ) -> NDArray[numpy.float32]: ...
    @property
    def largest_albedo(self) -> float: ...

def merl_brdf(
    values: Annotated[
        NDArray[numpy.float32], dict(shape=(None, None, None, None), order="C", device="cpu", writable=False)
    ],
) -> MeasuredBrdf: ...
def rgl_brdf(
    *,
    phi: Sequence[float],
    theta: Sequence[float],
    normals: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order="C", device="cpu", writable=False)],
    projected: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order="C", device="cpu", writable=False)],
    visible: Annotated[
        NDArray[numpy.float32], dict(shape=(None, None, None, None), order="C", device="cpu", writable=False)
    ],
    luminance: Annotated[
        NDArray[numpy.float32], dict(shape=(None, None, None, None), order="C", device="cpu", writable=False)
    ],
    channels: Annotated[
        NDArray[numpy.float32], dict(shape=(None, None, None, None, None), order="C", device="cpu", writable=False)
    ],
    jacobian: bool,
) -> MeasuredBrdf: ...

class Wrap(enum.Enum):
    repeat = 0

    mirror = 1

    clamp = 2

class MaterialKind(enum.Enum):
    diffuse = 0

    phong = 1

    ward = 2

    conductor = 3

    dielectric = 4

    thin_dielectric = 5

    plastic = 6

    metallic_roughness = 7

    translucent = 8

    measured = 9

    blend = 10

def parameter_names(kind: MaterialKind) -> list[str]: ...

class Value:
    pass

class Material:
    def __init__(self) -> None: ...
    @property
    def kind(self) -> MaterialKind: ...
    @kind.setter
    def kind(self, arg: MaterialKind, /) -> None: ...
    def set(self, name: str, value: Value) -> None: ...
    @property
    def two_sided(self) -> bool: ...
    @two_sided.setter
    def two_sided(self, arg: bool, /) -> None: ...
    @property
    def back_culled(self) -> bool: ...
    @back_culled.setter
    def back_culled(self, arg: bool, /) -> None: ...
    @property
    def hidden_from_camera(self) -> bool: ...
    @hidden_from_camera.setter
    def hidden_from_camera(self, arg: bool, /) -> None: ...
    @property
    def back(self) -> int: ...
    @back.setter
    def back(self, arg: int, /) -> None: ...
    @property
    def children(self) -> list[int]: ...
    @children.setter
    def children(self, arg: Sequence[int], /) -> None: ...
    @property
    def table(self) -> MeasuredBrdf: ...
    @table.setter
    def table(self, arg: MeasuredBrdf, /) -> None: ...
    @property
    def beckmann(self) -> bool: ...
    @beckmann.setter
    def beckmann(self, arg: bool, /) -> None: ...
    @property
    def correlated(self) -> bool: ...
    @correlated.setter
    def correlated(self, arg: bool, /) -> None: ...
    @property
    def nonlinear(self) -> bool: ...
    @nonlinear.setter
    def nonlinear(self, arg: bool, /) -> None: ...
    @property
    def thin_walled(self) -> bool: ...
    @thin_walled.setter
    def thin_walled(self, arg: bool, /) -> None: ...
    @property
    def opacity(self) -> Value: ...
    @opacity.setter
    def opacity(self, arg: Value, /) -> None: ...
    @property
    def alpha_cutoff(self) -> float: ...
    @alpha_cutoff.setter
    def alpha_cutoff(self, arg: float, /) -> None: ...
    @property
    def vertex_colors(self) -> bool: ...
    @vertex_colors.setter
    def vertex_colors(self, arg: bool, /) -> None: ...
    @property
    def has_normal_map(self) -> bool: ...
    @has_normal_map.setter
    def has_normal_map(self, arg: bool, /) -> None: ...
    @property
    def bump(self) -> bool: ...
    @bump.setter
    def bump(self, arg: bool, /) -> None: ...
    @property
    def normal_map(self) -> Value: ...
    @normal_map.setter
    def normal_map(self, arg: Value, /) -> None: ...
    @property
    def normal_scale(self) -> float: ...
    @normal_scale.setter
    def normal_scale(self, arg: float, /) -> None: ...
    @property
    def emits(self) -> bool: ...
    @emits.setter
    def emits(self, arg: bool, /) -> None: ...
    @property
    def emission(self) -> Value: ...
    @emission.setter
    def emission(self, arg: Value, /) -> None: ...
    @property
    def emission_two_sided(self) -> bool: ...
    @emission_two_sided.setter
    def emission_two_sided(self, arg: bool, /) -> None: ...

class SceneBuilder:
    def __init__(self) -> None: ...
    @overload
    def add_texture(
        self,
        image: Annotated[NDArray[numpy.uint8], dict(shape=(None, None, None), order="C", device="cpu", writable=False)],
        *,
        srgb: bool,
        wrap_u: Wrap,
        wrap_v: Wrap,
        nearest: bool,
    ) -> int: ...
    @overload
    def add_texture(
        self,
        image: Annotated[
            NDArray[numpy.float32], dict(shape=(None, None, None), order="C", device="cpu", writable=False)
        ],
        *,
        srgb: bool,
        wrap_u: Wrap,
        wrap_v: Wrap,
        nearest: bool,
    ) -> int: ...
    def value(
        self,
        constant: Sequence[float],
        *,
        texture: int,
        channel: int,
        uv_set: int,
        uv_transform: Sequence[float],
        invert: bool,
        square: bool,
    ) -> Value: ...
    def add_material(self, arg: Material, /) -> int: ...
    def add_mesh(
        self,
        *,
        positions: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
        triangles: Annotated[NDArray[numpy.uint32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
        material: int,
        normals: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
        uvs: Annotated[NDArray[numpy.float32], dict(shape=(None, 2), order="C", device="cpu", writable=False)],
        uvs2: Annotated[NDArray[numpy.float32], dict(shape=(None, 2), order="C", device="cpu", writable=False)],
        colors: Annotated[NDArray[numpy.float32], dict(shape=(None, 4), order="C", device="cpu", writable=False)],
        tangents: Annotated[NDArray[numpy.float32], dict(shape=(None, 4), order="C", device="cpu", writable=False)],
    ) -> None: ...
    def add_point(self, arg0: Sequence[float], arg1: Sequence[float], /) -> None: ...
    def add_spot(
        self,
        *,
        position: Sequence[float],
        direction: Sequence[float],
        intensity: Sequence[float],
        inner_angle: float,
        outer_angle: float,
        smooth: bool,
    ) -> None: ...
    def add_profile(
        self,
        *,
        position: Sequence[float],
        axes: Sequence[Sequence[float]],
        intensity: Sequence[float],
        polar: Sequence[float],
        azimuth: Sequence[float],
        values: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order="C", device="cpu", writable=False)],
    ) -> None: ...
    def add_directional(self, arg0: Sequence[float], arg1: Sequence[float], arg2: float, /) -> None: ...
    def set_environment(
        self,
        arg0: Annotated[
            NDArray[numpy.float32], dict(shape=(None, None, None), order="C", device="cpu", writable=False)
        ],
        arg1: Sequence[float],
        /,
    ) -> None: ...
    def build(self) -> Scene: ...

class Scene:
    @property
    def triangle_count(self) -> int: ...
    @property
    def radius(self) -> float: ...
    def escapes(
        self,
        origins: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
        directions: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    ) -> int:
        """Number of rays that meet nothing."""

    def first_hits(
        self,
        origins: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
        directions: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
        threads: int,
        from_camera: bool = False,
    ) -> NDArray[numpy.int32]:
        """
        The triangle that each ray meets first, culled backs included, counted over all meshes, and -1 for none.
        """

def smooth_limit(
    image: Annotated[NDArray[numpy.float32], dict(shape=(None, None, None), order="C", device="cpu", writable=False)],
) -> float:
    """
    The luminance at which the smooth part of an environment is cut; infinite if nothing is sharp.
    """

class Progress:
    def __init__(self) -> None: ...
    def cancel(self) -> None: ...
    @property
    def done(self) -> int: ...
    @property
    def total(self) -> int: ...
    @property
    def rays(self) -> int: ...

class Cancelled(Exception):
    pass

class Camera:
    def __init__(
        self,
        *,
        axes: Sequence[Sequence[float]],
        position: Sequence[float],
        size: Sequence[int],
        half_extent: Sequence[float],
        shift: Sequence[float],
        lens: Sequence[float],
        orthographic: bool,
    ) -> None:
        """
        axes: what points right, up and backward; lens: radius of the aperture and distance of the focus.
        """

class Film:
    def __init__(self, width: int, height: int, x0: int = 0, y0: int = 0) -> None: ...
    def copy(self) -> Film: ...
    @property
    def radiance(self) -> NDArray[numpy.float32]: ...
    @property
    def direct(self) -> NDArray[numpy.float32]: ...
    @property
    def albedo(self) -> NDArray[numpy.float32]: ...
    @property
    def normal(self) -> NDArray[numpy.float32]: ...
    @property
    def rough_albedo(self) -> NDArray[numpy.float32]: ...
    @property
    def rough_normal(self) -> NDArray[numpy.float32]: ...
    def interleave(self, other: Film) -> None:
        """Adds the samples of another film; ours are the even ones from then on."""

    def sums(self) -> NDArray[numpy.float32]:
        """What has been added up, (height, width, numbers)."""

    def restore(
        self,
        sums: Annotated[NDArray[numpy.float32], dict(shape=(None, None, 24), order="C", device="cpu", writable=False)],
    ) -> None:
        """Goes on from what `sums` gave."""

    def sums_within(self, rectangle: Sequence[int]) -> NDArray[numpy.float32]:
        """The sums of (x0, y0, x1, y1)."""

    def restore_within(
        self,
        sums: Annotated[NDArray[numpy.float32], dict(shape=(None, None, 24), order="C", device="cpu", writable=False)],
        x0: int,
        y0: int,
    ) -> None:
        """Replaces those of a rectangle."""

    def add_bad(self, count: int, first: Sequence[tuple[int, int, int]]) -> None:
        """Counts samples of a part of the picture that were not finite."""

    @property
    def depth(self) -> NDArray[numpy.float32]: ...
    @property
    def gloss_cached(self) -> NDArray[numpy.float32]: ...
    @property
    def gloss_traced(self) -> NDArray[numpy.float32]: ...
    @property
    def cache_misses(self) -> int: ...
    @property
    def bad_count(self) -> int: ...
    @property
    def bad_samples(self) -> list[tuple[int, int, int]]: ...

class FinishedTiles:
    def __init__(self) -> None: ...
    def take(self) -> list[tuple[int, int, Film]]:
        """
        The column and row of the upper left pixel, and a copy of the film, of each tile since the last call.
        """

class Filter(enum.Enum):
    box = 0

    tent = 1

class RenderRange:
    def __init__(
        self,
        *,
        crop: Sequence[int],
        seed: int,
        threads: int,
        filter: Filter,
        tile_order: Sequence[int],
        finished: FinishedTiles | None = None,
    ) -> None: ...

def render(
    camera: Camera,
    film: Film,
    estimator: Estimator,
    range: RenderRange,
    first: Annotated[NDArray[numpy.uint32], dict(shape=(None,), order="C", device="cpu", writable=False)],
    end: Annotated[NDArray[numpy.uint32], dict(shape=(None,), order="C", device="cpu", writable=False)],
    progress: Progress,
) -> None:
    """Adds samples [first, end) of each pixel, or of all, to `film`."""

class Component(enum.Enum):
    total = 0

    direct = 1

    indirect = 2

class PointIrradianceOptions:
    def __init__(
        self, *, component: Component, samples: int, max_depth: int, seed: int, threads: int, first: int = 0
    ) -> None:
        """
        first: the index of the first point, if the points are a range of more.
        """

def irradiance(
    positions: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    normals: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    estimator: PointEstimator,
    options: PointIrradianceOptions,
    progress: Progress,
) -> tuple[NDArray[numpy.float32], tuple[int, int] | None, NDArray[numpy.float32]]:
    """
    Irradiance (points, 3), and how many points a cache served and did not, or None where there is none.
    """

class Estimator:
    pass

class PointEstimator:
    pass

def path_estimator(scene: Scene, *, max_depth: int, roulette_depth: int) -> Estimator: ...
def path_point_estimator(scene: Scene, *, max_depth: int) -> PointEstimator: ...
def cached_path_estimator(
    scene: Scene, caches: SolvedCaches, tables: RadianceTables | None, *, max_depth: int, guide: PathGuide | None = None
) -> Estimator: ...

class PathGuide:
    def __len__(self) -> int: ...

def learn_path_guide(
    scene: Scene, caches: SolvedCaches, max_depth: int, threads: int, progress: Progress
) -> PathGuide: ...
def cached_point_estimator(scene: Scene, caches: SolvedCaches, options: IrradianceCacheOptions) -> PointEstimator: ...
def called_estimator(scene: Scene, function: object) -> Estimator: ...
def called_point_estimator(function: object) -> PointEstimator: ...

class ProbeOptions:
    def __init__(self, *, component: Component, order: int, samples: int, seed: int, threads: int) -> None: ...

def probes(
    scene: Scene,
    positions: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    estimator: Estimator,
    options: ProbeOptions,
    progress: Progress,
) -> tuple[NDArray[numpy.float32], NDArray[numpy.float32], int]:
    """
    Coefficients of the incident radiance and half the differences of its halves, (probes, order², 3) each; number of dropped radiances.
    """

def surface_probes(
    scene: Scene,
    positions: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    normals: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    estimator: Estimator,
    options: ProbeOptions,
    progress: Progress,
) -> tuple[NDArray[numpy.float32], NDArray[numpy.float32], int]:
    """
    The same for the light that arrives at points of surfaces from the side of their normals.
    """

max_harmonic_order: int = 48

class Basis(enum.Enum):
    spherical = 0

    hemispherical = 1

class Window(enum.Enum):
    hanning = 0

    lanczos = 1

class Horizon(enum.Enum):
    continued = 0

    dark = 1

def evaluate_harmonics(
    basis: Basis,
    order: int,
    directions: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
) -> NDArray[numpy.float64]: ...
def project_harmonics(
    basis: Basis,
    order: int,
    directions: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    values: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order="C", device="cpu", writable=False)],
    weights: Annotated[NDArray[numpy.float64], dict(shape=(None,), order="C", device="cpu", writable=False)],
) -> NDArray[numpy.float64]: ...
def reconstruct_harmonics(
    basis: Basis,
    order: int,
    coefficients: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order="C", device="cpu", writable=False)],
    directions: Annotated[NDArray[numpy.float64], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
) -> NDArray[numpy.float64]: ...
def fit_hemisphere(
    order: int,
    tikhonov: float,
    inner_products: Annotated[
        NDArray[numpy.float64], dict(shape=(None, None), order="C", device="cpu", writable=False)
    ],
) -> NDArray[numpy.float64]: ...
def window_harmonics(
    window: Window,
    order: int,
    coefficients: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order="C", device="cpu", writable=False)],
) -> NDArray[numpy.float64]: ...
def rotate_spherical(
    order: int,
    rotation: Sequence[float],
    coefficients: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order="C", device="cpu", writable=False)],
) -> NDArray[numpy.float64]: ...
def rotate_by_tilt(
    order: int,
    rotation: Sequence[float],
    tolerance: float,
    coefficients: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order="C", device="cpu", writable=False)],
) -> NDArray[numpy.float64]: ...
def rotate_hemispherical(
    order: int,
    rotation: Sequence[float],
    horizon: Horizon,
    spherical_order: int,
    coefficients: Annotated[NDArray[numpy.float64], dict(shape=(None, None), order="C", device="cpu", writable=False)],
) -> NDArray[numpy.float64]: ...

max_table_order: int = 12

class TableLobeKind(enum.Enum):
    lambert = 0

    phong = 1

    ward = 2

    ggx = 3

    beckmann = 4

class TableLobe:
    def __init__(self, arg0: TableLobeKind, arg1: float, arg2: float, arg3: bool, /) -> None: ...

class BrdfTableOptions:
    def __init__(self, arg0: Basis, arg1: int, arg2: float, arg3: int, arg4: int, /) -> None: ...

class BrdfTable:
    @overload
    def __init__(self, lobes: Sequence[TableLobe], options: BrdfTableOptions, progress: Progress) -> None: ...
    @overload
    def __init__(
        self,
        arg0: Sequence[TableLobe],
        arg1: BrdfTableOptions,
        arg2: Annotated[NDArray[numpy.uint8], dict(shape=(None,), order="C", device="cpu", writable=False)],
        arg3: Annotated[NDArray[numpy.float32], dict(shape=(None,), order="C", device="cpu", writable=False)],
        arg4: Annotated[NDArray[numpy.float32], dict(shape=(None,), order="C", device="cpu", writable=False)],
        /,
    ) -> None: ...
    @property
    def terms(self) -> int: ...
    @property
    def orders(self) -> bytes: ...
    @property
    def errors(self) -> NDArray[numpy.float32]: ...
    @property
    def coefficients(self) -> NDArray[numpy.float32]: ...
    def lookup(
        self,
        directions: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
        alphas: Annotated[NDArray[numpy.float32], dict(shape=(None,), order="C", device="cpu", writable=False)],
    ) -> tuple[NDArray[numpy.float32], NDArray[numpy.float32], NDArray[numpy.float32]]: ...

def split_conductor(eta: Sequence[float], k: Sequence[float]) -> NDArray[numpy.float32]: ...
def split_dielectric(ior: float) -> NDArray[numpy.float32]: ...
def plastic_coat(
    ior: float,
    alpha: float,
    beckmann: bool,
    cosines: Annotated[NDArray[numpy.float32], dict(shape=(None,), order="C", device="cpu", writable=False)],
) -> tuple[NDArray[numpy.float32], float]: ...
def coupled_coat(
    alpha: float,
    f0: float,
    f90: float,
    cosines: Annotated[NDArray[numpy.float32], dict(shape=(None,), order="C", device="cpu", writable=False)],
) -> NDArray[numpy.float32]: ...

class Weight(enum.Enum):
    tabellion = 0

    ward = 1

    split_sphere = 2

class Balanced(enum.Enum):
    squared = 0

    absolute = 1

class Metric(enum.Enum):
    occlusion = 0

    radiometric = 1

    geometric = 2

    minimum = 3

    harmonic = 4

class IrradianceCacheOptions:
    def __init__(self) -> None: ...
    @property
    def spacing(self) -> float: ...
    @spacing.setter
    def spacing(self, arg: float, /) -> None: ...
    @property
    def metric(self) -> Metric: ...
    @metric.setter
    def metric(self, arg: Metric, /) -> None: ...
    @property
    def balanced(self) -> Balanced: ...
    @balanced.setter
    def balanced(self, arg: Balanced, /) -> None: ...
    @property
    def disagreement(self) -> float: ...
    @disagreement.setter
    def disagreement(self, arg: float, /) -> None: ...
    @property
    def gradient_limit(self) -> bool: ...
    @gradient_limit.setter
    def gradient_limit(self, arg: bool, /) -> None: ...
    @property
    def obstacle_limit(self) -> bool: ...
    @obstacle_limit.setter
    def obstacle_limit(self, arg: bool, /) -> None: ...
    @property
    def least_pixels(self) -> float: ...
    @least_pixels.setter
    def least_pixels(self, arg: float, /) -> None: ...
    @property
    def largest_pixels(self) -> float: ...
    @largest_pixels.setter
    def largest_pixels(self, arg: float, /) -> None: ...
    @property
    def rows(self) -> int: ...
    @rows.setter
    def rows(self, arg: int, /) -> None: ...
    @property
    def far_rows(self) -> int: ...
    @far_rows.setter
    def far_rows(self, arg: int, /) -> None: ...
    @property
    def far_spacing(self) -> float: ...
    @far_spacing.setter
    def far_spacing(self, arg: float, /) -> None: ...
    @property
    def far_records(self) -> int: ...
    @far_records.setter
    def far_records(self, arg: int, /) -> None: ...
    @property
    def far_photons(self) -> PhotonMaps: ...
    @far_photons.setter
    def far_photons(self, maps: PhotonMaps | None) -> None: ...
    @property
    def max_depth(self) -> int: ...
    @max_depth.setter
    def max_depth(self, arg: int, /) -> None: ...
    @property
    def seed(self) -> int: ...
    @seed.setter
    def seed(self, arg: int, /) -> None: ...
    @property
    def threads(self) -> int: ...
    @threads.setter
    def threads(self, arg: int, /) -> None: ...
    def share_work(self, share: object, tell: object) -> None:
        """
        Lets functions share the work with other processes. `share` gets the number of items of a step, about how many rays each takes, and a function that computes a range of them as bytes. In the process that asks it returns the bytes of ranges that are all items, in order, and `tell` gets the digest of the step. In processes that follow `share` returns this digest.
        """

    @property
    def weight(self) -> Weight: ...
    @weight.setter
    def weight(self, arg: Weight, /) -> None: ...
    @property
    def relaxation(self) -> float: ...
    @relaxation.setter
    def relaxation(self, arg: float, /) -> None: ...
    @property
    def rotation_gradient(self) -> bool: ...
    @rotation_gradient.setter
    def rotation_gradient(self, arg: bool, /) -> None: ...
    @property
    def translation_gradient(self) -> bool: ...
    @translation_gradient.setter
    def translation_gradient(self, arg: bool, /) -> None: ...
    @property
    def neighbor_clamping(self) -> bool: ...
    @neighbor_clamping.setter
    def neighbor_clamping(self, arg: bool, /) -> None: ...

class RadianceCacheOptions:
    def __init__(self) -> None: ...
    @property
    def irradiance(self) -> IrradianceCacheOptions: ...
    @irradiance.setter
    def irradiance(self, arg: IrradianceCacheOptions, /) -> None: ...
    @property
    def order(self) -> int: ...
    @order.setter
    def order(self, arg: int, /) -> None: ...
    @property
    def rows(self) -> int: ...
    @rows.setter
    def rows(self, arg: int, /) -> None: ...
    @property
    def spacing(self) -> float: ...
    @spacing.setter
    def spacing(self, arg: float, /) -> None: ...

class RadianceTables:
    def __init__(self, arg0: Scene, arg1: Sequence[BrdfTable], arg2: int, /) -> None: ...

def wanted_radiance_tables(scene: Scene) -> tuple[list[tuple[TableLobeKind, float, float, bool]], bool]: ...
def record_layout() -> list[tuple[str, int, int]]: ...
def lobes_at_records(
    scene: Scene,
    caches: SolvedCaches,
    tables: RadianceTables,
    directions: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
) -> tuple[NDArray[numpy.float32], NDArray[numpy.float32], NDArray[numpy.float32], NDArray[numpy.float32]]: ...

class SolvedCaches:
    @overload
    def __init__(
        self,
        arg0: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order="C", device="cpu", writable=False)],
        arg1: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order="C", device="cpu", writable=False)],
        arg2: IrradianceCacheOptions,
        /,
    ) -> None: ...
    @overload
    def __init__(self) -> None: ...
    def set_radiance(
        self,
        arg0: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order="C", device="cpu", writable=False)],
        arg1: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order="C", device="cpu", writable=False)],
        arg2: Annotated[NDArray[numpy.uint16], dict(shape=(None, None), order="C", device="cpu", writable=False)],
        arg3: RadianceCacheOptions,
        /,
    ) -> None: ...
    @property
    def radiance_records(self) -> NDArray[numpy.float32]: ...
    @property
    def radiance_values(self) -> NDArray[numpy.float32]: ...
    @property
    def radiance_gradients(self) -> NDArray[numpy.uint16]: ...
    @property
    def radiance_count(self) -> int: ...
    @property
    def near(self) -> NDArray[numpy.float32]: ...
    @property
    def far(self) -> NDArray[numpy.float32]: ...
    @property
    def near_shared_excess(self) -> NDArray[numpy.float32]: ...
    @property
    def radiance_shared_excess(self) -> NDArray[numpy.float32]: ...
    def read_near(
        self,
        positions: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
        normals: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    ) -> tuple[NDArray[numpy.float32], NDArray[numpy.float32]]:
        """
        The irradiance (points, 3) that near records give, and the sum of their weights (points,); 0 if none serves.
        """

    def estimated_errors(
        self,
        positions: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
        normals: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    ) -> NDArray[numpy.float32]:
        """
        The estimated error of what `read_near` gives, relative to it (points,); negative if no record serves.
        """

    @property
    def near_count(self) -> int: ...
    @property
    def left_to_paths(self) -> int: ...
    @property
    def far_count(self) -> int: ...

def solve_for_cameras(
    scene: Scene, cameras: Sequence[Camera], options: IrradianceCacheOptions, caches: SolvedCaches, progress: Progress
) -> None: ...
def solve_radiance_for_cameras(
    scene: Scene,
    cameras: Sequence[Camera],
    tables: RadianceTables,
    options: RadianceCacheOptions,
    caches: SolvedCaches,
    progress: Progress,
) -> None: ...
def solve_at_points(
    scene: Scene,
    positions: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    normals: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    options: IrradianceCacheOptions,
    caches: SolvedCaches,
    progress: Progress,
) -> None: ...
def solve_everywhere(
    scene: Scene, options: IrradianceCacheOptions, caches: SolvedCaches, progress: Progress
) -> None: ...
def solve_radiance_everywhere(
    scene: Scene, tables: RadianceTables, options: RadianceCacheOptions, caches: SolvedCaches, progress: Progress
) -> None: ...

class ErrorCheck:
    def __init__(self) -> None: ...
    @property
    def rays(self) -> int: ...
    @rays.setter
    def rays(self, arg: int, /) -> None: ...
    @property
    def wanted(self) -> float: ...
    @wanted.setter
    def wanted(self, arg: float, /) -> None: ...
    @property
    def max_depth(self) -> int: ...
    @max_depth.setter
    def max_depth(self, arg: int, /) -> None: ...
    @property
    def seed(self) -> int: ...
    @seed.setter
    def seed(self, arg: int, /) -> None: ...
    @property
    def threads(self) -> int: ...
    @threads.setter
    def threads(self, arg: int, /) -> None: ...
    def share_work(self, share: object, tell: object) -> None:
        """
        Lets functions share the work with other processes. `share` gets the number of items of a step, about how many rays each takes, and a function that computes a range of them as bytes. In the process that asks it returns the bytes of ranges that are all items, in order, and `tell` gets the digest of the step. In processes that follow `share` returns this digest.
        """

class ErrorEstimate:
    @property
    def squared(self) -> float: ...
    @property
    def deviation(self) -> float: ...
    @property
    def missed(self) -> float: ...
    @property
    def paths(self) -> int: ...
    @property
    def places(self) -> NDArray[numpy.float32]: ...

class FocusedLight:
    @property
    def by_chance(self) -> float: ...
    @property
    def unseen(self) -> float: ...
    @property
    def spread(self) -> float: ...

def focused_light(scene: Scene, max_depth: int, seed: int, threads: int, progress: Progress) -> FocusedLight: ...
def estimate_error_for_camera(
    scene: Scene,
    camera: Camera,
    caches: SolvedCaches,
    check: ErrorCheck,
    progress: Progress,
    tables: RadianceTables | None = None,
) -> ErrorEstimate: ...
def estimate_error_at_points(
    scene: Scene,
    positions: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    normals: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    caches: SolvedCaches,
    check: ErrorCheck,
    progress: Progress,
) -> ErrorEstimate: ...
def estimate_error_everywhere(
    scene: Scene, count: int, caches: SolvedCaches, check: ErrorCheck, progress: Progress
) -> ErrorEstimate: ...

class GrowingCache:
    @overload
    def __init__(self, scene: Scene, options: IrradianceCacheOptions, caches: SolvedCaches) -> None: ...
    @overload
    def __init__(
        self, scene: Scene, options: RadianceCacheOptions, tables: RadianceTables, caches: SolvedCaches
    ) -> None: ...
    def look(self, camera: Camera) -> None: ...
    def drop_view(self) -> None: ...
    def look_everywhere(self) -> None: ...
    @property
    def surfaces_left(self) -> bool: ...
    @property
    def passes_left(self) -> int: ...
    def step(self, progress: Progress) -> None: ...
    @property
    def caches(self) -> SolvedCaches: ...
    @property
    def bright(self) -> BrightPlaces: ...

class RecordKind(enum.Enum):
    near = 0

    far = 1

    radiance = 2

class BrightPlaces:
    def __init__(self) -> None: ...

class RenewalSettings:
    def __init__(self, bright: BrightPlaces, kind: RecordKind, mean: float) -> None: ...

def renew_records(
    scene: Scene,
    caches: SolvedCaches,
    settings: RenewalSettings,
    options: IrradianceCacheOptions,
    records: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order="C", device="cpu", writable=False)],
    shading_normals: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    keys: Annotated[NDArray[numpy.uint32], dict(shape=(None,), order="C", device="cpu", writable=False)],
    progress: Progress,
) -> tuple[NDArray[numpy.float32], NDArray[numpy.float32], NDArray[numpy.float32]]:
    """
    Gathers records anew: their rows, the number of cells of each grid, and the luminance that each cell saw.
    """

def renew_radiance(
    scene: Scene,
    caches: SolvedCaches,
    mean: float,
    options: RadianceCacheOptions,
    records: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order="C", device="cpu", writable=False)],
    shading_normals: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    keys: Annotated[NDArray[numpy.uint32], dict(shape=(None,), order="C", device="cpu", writable=False)],
    progress: Progress,
) -> tuple[NDArray[numpy.float32], NDArray[numpy.float32]]:
    """
    Gathers records of radiance anew: their rows, and their values and gradients (records, 9 order²).
    """

def records_in_use(
    scene: Scene,
    camera: Camera,
    records: Annotated[NDArray[numpy.float32], dict(shape=(None, None), order="C", device="cpu", writable=False)],
    options: IrradianceCacheOptions,
    progress: Progress,
) -> NDArray[numpy.float32]:
    """
    1 for each record (N,) that is read where the camera sees something, 0 for the others.
    """

def tangents_around(
    normals: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
) -> NDArray[numpy.float32]:
    """The first axis (N, 3) of the frame of records around each normal."""

class Kernel(enum.Enum):
    uniform = 0

    cone = 1

    epanechnikov = 2

class PhotonTracing:
    def __init__(self) -> None: ...
    @property
    def caustic(self) -> bool: ...
    @caustic.setter
    def caustic(self, arg: bool, /) -> None: ...
    @property
    def photons(self) -> int: ...
    @photons.setter
    def photons(self, arg: int, /) -> None: ...
    @property
    def most_paths(self) -> int: ...
    @most_paths.setter
    def most_paths(self, arg: int, /) -> None: ...
    @property
    def max_edges(self) -> int: ...
    @max_edges.setter
    def max_edges(self, arg: int, /) -> None: ...
    @property
    def guided(self) -> bool: ...
    @guided.setter
    def guided(self, arg: bool, /) -> None: ...
    @property
    def seed(self) -> int: ...
    @seed.setter
    def seed(self, arg: int, /) -> None: ...
    @property
    def threads(self) -> int: ...
    @threads.setter
    def threads(self, arg: int, /) -> None: ...
    def share_work(self, share: object, tell: object) -> None:
        """
        Lets functions share the work with other processes. `share` gets the number of items of a step, about how many rays each takes, and a function that computes a range of them as bytes. In the process that asks it returns the bytes of ranges that are all items, in order, and `tell` gets the digest of the step. In processes that follow `share` returns this digest.
        """

class PhotonMapReading:
    def __init__(self) -> None: ...
    @property
    def nearest(self) -> int: ...
    @nearest.setter
    def nearest(self, arg: int, /) -> None: ...
    @property
    def caustic_nearest(self) -> int: ...
    @caustic_nearest.setter
    def caustic_nearest(self, arg: int, /) -> None: ...
    @property
    def kernel(self) -> Kernel: ...
    @kernel.setter
    def kernel(self, arg: Kernel, /) -> None: ...
    @property
    def gather(self) -> bool: ...
    @gather.setter
    def gather(self, arg: bool, /) -> None: ...
    @property
    def guided(self) -> bool: ...
    @guided.setter
    def guided(self, arg: bool, /) -> None: ...
    @property
    def seed(self) -> int: ...
    @seed.setter
    def seed(self, arg: int, /) -> None: ...
    @property
    def threads(self) -> int: ...
    @threads.setter
    def threads(self, arg: int, /) -> None: ...

class ProgressiveOptions:
    def __init__(self) -> None: ...
    @property
    def paths(self) -> int: ...
    @paths.setter
    def paths(self, arg: int, /) -> None: ...
    @property
    def nearest(self) -> int: ...
    @nearest.setter
    def nearest(self, arg: int, /) -> None: ...
    @property
    def kernel(self) -> Kernel: ...
    @kernel.setter
    def kernel(self, arg: Kernel, /) -> None: ...
    @property
    def alpha(self) -> float: ...
    @alpha.setter
    def alpha(self, arg: float, /) -> None: ...
    @property
    def max_edges(self) -> int: ...
    @max_edges.setter
    def max_edges(self, arg: int, /) -> None: ...
    @property
    def seed(self) -> int: ...
    @seed.setter
    def seed(self, arg: int, /) -> None: ...
    @property
    def threads(self) -> int: ...
    @threads.setter
    def threads(self, arg: int, /) -> None: ...

class PhotonMaps:
    pass

def trace_photons(scene: Scene, tracing: PhotonTracing, progress: Progress) -> tuple[NDArray[numpy.float32], int]: ...
def photon_maps(
    scene: Scene,
    stored: tuple[
        Annotated[NDArray[numpy.float32], dict(shape=(None, 13), order="C", device="cpu", writable=False)], float
    ],
    caustic: tuple[
        Annotated[NDArray[numpy.float32], dict(shape=(None, 13), order="C", device="cpu", writable=False)], float
    ],
    options: PhotonMapReading,
    progress: Progress,
) -> PhotonMaps:
    """
    Maps from pairs of (photons, 13) arrays and the paths that were emitted for them.
    """

def progressive_maps(
    scene: Scene, number: int, first: PhotonMaps | None, options: ProgressiveOptions, progress: Progress
) -> PhotonMaps: ...
def photon_density(
    scene: Scene,
    positions: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    normals: Annotated[NDArray[numpy.float32], dict(shape=(None, 3), order="C", device="cpu", writable=False)],
    maps: PhotonMaps,
    caustic: bool,
    threads: int,
) -> NDArray[numpy.float32]: ...
def photon_estimator(scene: Scene, maps: PhotonMaps, *, gather_rays: int, max_depth: int) -> Estimator: ...
def photon_point_estimator(scene: Scene, maps: PhotonMaps) -> PointEstimator: ...

class RadiositySolver(enum.Enum):
    gathering = 0

    shooting = 1

class RadiosityOptions:
    def __init__(self) -> None: ...
    @property
    def patch_size(self) -> float: ...
    @patch_size.setter
    def patch_size(self, arg: float, /) -> None: ...
    @property
    def patches(self) -> int: ...
    @patches.setter
    def patches(self, arg: int, /) -> None: ...
    @property
    def refinements(self) -> int: ...
    @refinements.setter
    def refinements(self, arg: int, /) -> None: ...
    @property
    def tolerance(self) -> float: ...
    @tolerance.setter
    def tolerance(self, arg: float, /) -> None: ...
    @property
    def solver(self) -> RadiositySolver: ...
    @solver.setter
    def solver(self, arg: RadiositySolver, /) -> None: ...
    @property
    def bounces(self) -> int: ...
    @bounces.setter
    def bounces(self, arg: int, /) -> None: ...
    @property
    def seed(self) -> int: ...
    @seed.setter
    def seed(self, arg: int, /) -> None: ...
    @property
    def threads(self) -> int: ...
    @threads.setter
    def threads(self, arg: int, /) -> None: ...

class RadiosityField:
    def __init__(
        self,
        arg0: Scene,
        arg1: Annotated[NDArray[numpy.uint32], dict(shape=(None, 4), order="C", device="cpu", writable=False)],
        arg2: Annotated[NDArray[numpy.float32], dict(shape=(None, 15), order="C", device="cpu", writable=False)],
        arg3: int,
        /,
    ) -> None: ...

PATCH_IS_BACK: int = 1

PATCH_IS_UNKNOWN: int = 2

def solve_radiosity(
    scene: Scene, options: RadiosityOptions, progress: Progress
) -> tuple[NDArray[numpy.uint32], NDArray[numpy.float32], NDArray[numpy.float32], dict[str, float]]: ...
def radiosity_estimator(scene: Scene, field: RadiosityField, *, gather_rays: int, max_depth: int) -> Estimator: ...
def radiosity_point_estimator(scene: Scene, field: RadiosityField) -> PointEstimator: ...
def versions() -> dict[str, str]:
    """The versions of the libraries that run, by name."""

def instruction_set() -> str:
    """The name of the instruction set of this core."""

def built_for_one_machine() -> bool:
    """Whether this core was compiled for the machine that compiled it."""
