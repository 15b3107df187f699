# SPDX-FileCopyrightText: the Éclat authors
# SPDX-License-Identifier: Apache-2.0
"""What can be set on records of light, under irradiance caching and radiance caching."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal

from eclat.bridge.arguments import MAX_ERROR_RANGE
from eclat.methods.method import Method
from eclat.methods.ranges import check_names, check_range, check_types


@dataclass(frozen=True)
class RecordOptions(Method):
    """Settings of records of irradiance.

    `max_error` steers the spacing and the rays of records, near and far; the other fields are None for "what max_error asks
    for" (`laws.core_options`).
    """

    for_whole_scene: ClassVar[bool] = False
    has_records: ClassVar[bool] = True

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
    shrink_disagreeing: bool = True
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
    """The same, and settings of records of incident radiance."""

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
        check_range(self, "order", 2, 12)
        check_range(self, "gloss_error", 0.001, 1)
        check_range(self, "gloss_spacing", 0.01, 2)
        check_range(self, "gloss_rows", 2, 256)
