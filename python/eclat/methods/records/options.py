# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""The options of records of light, which irradiance caching and radiance caching share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from eclat.bridge.arguments import MAX_ERROR_RANGE
from eclat.methods.method import Method
from eclat.methods.ranges import check_names, check_range, check_types


@dataclass(frozen=True)
class RecordOptions(Method):
    """Settings of records of irradiance.

    `max_error` determines the spacing and the rays of near and far records. A field that is None takes the value that
    follows from `max_error` (`laws.core_options`).
    """

    for_whole_scene: ClassVar[bool] = False
    has_records: ClassVar[bool] = True

    max_error: float = 0.01
    """Wanted relative error of the indirect light, 0.0005..0.5."""
    weight: Literal["tabellion", "ward", "split-sphere"] = "tabellion"
    """How records are weighted. `tabellion` follows Tabellion and Lamorlette (2004), and `ward` uses Ward's sum of
    errors with the same guards against leaks. `split-sphere` is the split sphere as Ward published it in 1988, without
    these guards, for comparisons."""
    metric: Literal["occlusion", "radiometric", "geometric", "minimum", "harmonic"] = "occlusion"
    """The length that a record's radius is proportional to. Three choices follow the second derivatives of irradiance:
    `occlusion` counts surfaces that come into view or disappear (Schwarzhaupt et al. 2012), `radiometric` ignores them,
    `geometric` also takes radiance as constant (Jarosz et al. 2012). `minimum` is the least distance to the surfaces
    seen, and `harmonic` the harmonic mean of these distances (Ward 1988)."""
    balanced: Literal["squared", "absolute"] = "squared"
    """The measure of error that is made equal for all records whose radius follows second derivatives. `squared` sums
    squared errors over pixels, which gives the least total error for a number of records; `absolute` sums absolute
    errors, as in Schwarzhaupt et al. (2012)."""
    spacing: float | None = None
    """Radius of a record divided by the length that `metric` chooses."""
    rows: int | None = None
    """Rows M of a gather, which then takes about π·M² rays."""
    least_pixels: float = 1.0
    """Lower bound of a record's radius, in pixels."""
    largest_pixels: float = 40.0
    """Upper bound of a record's radius, in pixels."""
    relaxation: float = 2.0
    """The distance up to which a record is read, divided by the distance within which it keeps other records from being
    placed (1 or more)."""
    rotation_gradient: bool = True
    translation_gradient: bool = True
    neighbor_clamping: bool = True
    """Whether the radii of two records may differ by no more than their distance (Křivánek et al. 2006)."""
    shrink_disagreeing: bool = True
    """Whether to shrink the worse of two overlapping records that differ by more than twice `max_error` and more than
    their noise explains; the next pass fills the gap (Křivánek et al. 2006). Records of radiance are compared by the
    light that they reflect."""
    gradient_limit: bool = True
    """Whether to bound a radius by the distance over which the gradient changes the irradiance by as much as the
    irradiance itself."""
    obstacle_limit: bool = True
    """Whether to bound radii that follow second derivatives by the least distance to an object that stands apart from
    the surface."""
    far_records: int | None = None
    """Number of candidate places for the coarse records in which gather rays end; with 0 every path is traced to its
    end."""
    far_rows: int | None = None
    """Rows of the gathers of far records."""
    far_spacing: float = 0.3
    """Radius of a far record divided by the harmonic mean distance of the surfaces that it sees."""
    far_photons: int = 0
    """Number of photons from which the irradiance at the ends of gather rays is estimated, instead of far records; 0
    uses far records. It cannot be combined with an environment image."""

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
        check_range(self, "largest_pixels", self.least_pixels, 10**5)
        check_range(self, "relaxation", 1, 4)
        check_names(self, "weight", "metric", "balanced")


@dataclass(frozen=True)
class RadianceOptions(RecordOptions):
    """Settings of records of irradiance and of records of incident radiance."""

    order: int = 8
    """Number of bands of the harmonics that represent light and lobes, 2..12: order² coefficients per colour
    channel."""
    gloss_error: float = 0.4
    """A lobe is cached if harmonics of this order represent it with at most this relative L2 error; otherwise it is
    traced."""
    gloss_spacing: float | None = None
    """The same as `spacing`, for a lobe as wide as a diffuse one; radii for narrower lobes are smaller."""
    gloss_rows: int | None = None
    """Rows of a gather of radiance."""

    def __post_init__(self) -> None:
        super().__post_init__()
        check_range(self, "order", 2, 12)
        check_range(self, "gloss_error", 0.001, 1)
        check_range(self, "gloss_spacing", 0.01, 2)
        check_range(self, "gloss_rows", 2, 256)
