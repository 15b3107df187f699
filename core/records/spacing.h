// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The radius of a record, from the second derivatives of irradiance or from the distances of the surfaces that it sees.

#pragma once

#include <optional>

#include "hemisphere/irradiance_hessian.h"
#include "records/record.h"

namespace eclat {

/// What the radius of a record follows.
enum class Metric : uint8_t {
    occlusion,    // how E bends, with what hides and appears [Schwarzhaupt12]
    radiometric,  // the same without that [Jarosz12]
    geometric,    // that, for even radiance
    minimum,      // the least distance to what the record sees [Tabellion04]
    harmonic,     // the harmonic mean of all distances: the split sphere [Ward88]
};

/// Which second derivatives a metric needs; none for distances.
std::optional<Curvature> curvature_of(Metric metric);

/// Which error is held the same for every record that follows curvature.
enum class Balanced : uint8_t {
    squared,   // summed squares over the record's disc: least for a number of records
    absolute,  // summed absolute errors [Schwarzhaupt12]
};

struct SpacingRule {
    Metric metric = Metric::occlusion;
    float spacing = 0.8f;  // radius in units of the record's length
    bool gradient_limit = true;
    Balanced balanced = Balanced::squared;
};

/// R2 / R1 of the ellipse in which a record is valid, between 1 and 2 [Schwarzhaupt12].
float elongation(const PrincipalCurvatures& bends);

/// Sets the length that the record's radius follows and the radius within its bounds, and shrinks the translation gradient by
/// as much as the lower bound raised it.
///
/// `obstacle`: distance to what the record sees, by its metric, m; the length is no greater.
/// `footprint`: width of a pixel there, 0 where there are none and only the distance counts. `mean`: luminance of the
/// irradiance in the scene, 0 while unknown.
void space(IrradianceRecord& record, float obstacle, float footprint, float mean, const SpacingRule& rule);

}  // namespace eclat
