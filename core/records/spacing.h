// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The radius of a record, from the second derivatives of irradiance or from the distances of the surfaces that it sees.

#pragma once

#include <optional>

#include "hemisphere/irradiance_hessian.h"
#include "records/record.h"

namespace eclat {

/// The quantity that determines the radius of a record.
enum class Metric : uint8_t {
    occlusion,    // second derivatives of E, with occlusion [Schwarzhaupt12]
    radiometric,  // second derivatives without occlusion [Jarosz12]
    geometric,    // second derivatives for constant radiance
    minimum,      // least distance to the surfaces that the record sees [Tabellion04]
    harmonic,     // harmonic mean of the distances: the split-sphere model [Ward88]
};

/// Returns the kind of second derivatives that a metric needs, or nothing for metrics of distance.
std::optional<Curvature> curvature_of(Metric metric);

/// The error that is made equal for all records whose radius depends on second derivatives.
enum class Balanced : uint8_t {
    squared,   // squared error summed over the record's disc; gives the least total for a number of records
    absolute,  // absolute error summed over the record's disc [Schwarzhaupt12]
};

struct SpacingRule {
    Metric metric = Metric::occlusion;
    float spacing = 0.8f;  // radius divided by the record's length
    bool gradient_limit = true;
    Balanced balanced = Balanced::squared;
};

/// Returns the ratio R2 / R1 of the ellipse in which a record is valid, between 1 and 2 [Schwarzhaupt12].
float elongation(const PrincipalCurvatures& bends);

/// Sets the length of the record and its radius within the bounds. If the lower bound increases the radius, the
/// translation gradient is reduced by the same factor.
///
/// `obstacle` is the distance of the surfaces that the record sees, in m, as the metric defines it. The length is at most
/// this, and less if the radius would otherwise reach those surfaces. `footprint` is the width of a pixel there; with 0,
/// only the distance determines the length. `mean` is the mean luminance of the irradiance in the scene, or 0 while it is
/// unknown.
void space(IrradianceRecord& record, float obstacle, float footprint, float mean, const SpacingRule& rule);

}  // namespace eclat
