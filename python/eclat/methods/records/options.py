# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The options of records, which irradiance caching and radiance caching share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from eclat.bridge.arguments import MAX_ERROR_RANGE
from eclat.methods.method import Method
from eclat.methods.ranges import check_names, check_range, check_types


@dataclass(frozen=True)
class RecordOptions(Method):
    """Options of records of irradiance.

    `max_error` determines how close the near and far records are to each other, and how many rays they take. A field
    that is None is computed from `max_error` (`laws.core_options`).
    """

    for_whole_scene: ClassVar[bool] = False
    has_records: ClassVar[bool] = True

    max_error: float = 0.01
    """Wanted relative error of the indirect light, 0.0005..0.5."""
    weight: Literal["tabellion", "ward", "split-sphere"] = "tabellion"
    """Formula for the weight of a record. `tabellion` is that of Tabellion and Lamorlette (2004), and `ward` is Ward's
    sum of errors; both use the same tests against light leaks. `split-sphere` is the split-sphere model as Ward
    published it in 1988, without these tests, for comparisons."""
    metric: Literal["occlusion", "radiometric", "geometric", "minimum", "harmonic"] = "occlusion"
    """Length to which the radius of a record is proportional. Three choices are based on the second derivatives of
    irradiance: `occlusion` accounts for surfaces that come into view or disappear (Schwarzhaupt et al. 2012),
    `radiometric` ignores them, and `geometric` also assumes constant radiance (Jarosz et al. 2012). `minimum` is the
    smallest distance to the surfaces seen, and `harmonic` the harmonic mean of these distances (Ward 1988)."""
    balanced: Literal["squared", "absolute"] = "squared"
    """Measure of error that is made equal for all records whose radius is based on second derivatives. `squared` sums
    squared errors over pixels, which gives the least total error for a given number of records; `absolute` sums
    absolute errors, as in Schwarzhaupt et al. (2012)."""
    spacing: float | None = None
    """Radius of a record divided by the length that `metric` chooses."""
    rows: int | None = None
    """Number M of rows of a gather, which then takes about π·M² rays."""
    least_pixels: float | None = None
    """Lower bound of a record's radius, in pixels. Details that records of this width cannot show are left to paths."""
    largest_pixels: float = 40.0
    """Upper bound of a record's radius, in pixels."""
    relaxation: float = 2.0
    """Distance up to which a record is read, divided by the distance within which no other record is placed (1 to
    4)."""
    rotation_gradient: bool = True
    """Whether interpolation uses the derivative of the irradiance with respect to the surface normal."""
    translation_gradient: bool = True
    """Whether interpolation uses the derivative of the irradiance with respect to the position."""
    neighbor_clamping: bool = True
    """Whether to reduce radii so that those of two records differ by no more than their distance (Křivánek et al.
    2006)."""
    shrink_disagreeing: bool = True
    """Whether to reduce the radius of the worse of two overlapping records whose irradiance differs by more than twice
    `max_error` and by more than their noise explains; the next pass fills the gap (Křivánek et al. 2006). Records of
    radiance are compared by the light that they reflect."""
    gradient_limit: bool = True
    """Whether to bound a radius by the distance over which, according to the gradient, the irradiance changes by its
    own amount."""
    obstacle_limit: bool = True
    """Whether to bound radii that are based on second derivatives by the smallest distance to an object that is
    separate from the surface."""
    far_records: int | None = None
    """Number of candidate positions for far records, the coarse records in which gather rays end. With 0, every path is
    traced to its end."""
    far_rows: int | None = None
    """Number of rows of the gathers of far records."""
    far_spacing: float = 0.3
    """Radius of a far record, divided by the harmonic mean distance of the surfaces that it sees."""
    far_photons: int = 0
    """Number of photons from which the irradiance at the ends of gather rays is estimated, instead of from far records;
    0 uses far records. Photons cannot be used with an environment image."""

    def __post_init__(self) -> None:
        check_types(self)
        check_range(self, "max_error", *MAX_ERROR_RANGE)
        check_range(self, "spacing", 0.01, 8)
        check_range(self, "rows", 2, 256)
        check_range(self, "far_spacing", 0.01, 2)
        check_range(self, "far_rows", 2, 256)
        check_range(self, "far_records", 0, 10**7)
        check_range(self, "far_photons", 0, 10**8)
        check_range(self, "least_pixels", 0.25, 1000)
        check_range(self, "largest_pixels", self.least_pixels or 0.25, 10**5)
        check_range(self, "relaxation", 1, 4)
        check_names(self, "weight", "metric", "balanced")


@dataclass(frozen=True)
class RadianceOptions(RecordOptions):
    """Options of records of irradiance and of records of radiance."""

    order: int = 8
    """Number of bands of the spherical harmonics that represent light and lobes, 2..12. A record has order²
    coefficients per colour channel."""
    gloss_error: float = 0.4
    """Largest relative L2 error with which the harmonics may represent a lobe, 0.001..1. Lobes with a larger error are
    traced instead of cached."""
    gloss_spacing: float | None = None
    """Spacing of records of radiance, in the same measure as `spacing`, for lobes as wide as a diffuse lobe; for
    narrower lobes radii are smaller."""
    gloss_rows: int | None = None
    """Number of rows of a gather of radiance."""

    def __post_init__(self) -> None:
        super().__post_init__()
        check_range(self, "order", 2, 12)
        check_range(self, "gloss_error", 0.001, 1)
        check_range(self, "gloss_spacing", 0.01, 2)
        check_range(self, "gloss_rows", 2, 256)
