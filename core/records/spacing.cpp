// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Symbol    name here          meaning                                                           unit
//   λ1, λ2  larger, smaller    principal second derivatives of the irradiance's luminance        W m⁻⁴
//   E       E                  that luminance, with the floor that the measure of error has      W m⁻²
//   w       footprint          width of a pixel                                                  m
//   ℓ       record.distance    the length that the radius follows, radius R1 = spacing · ℓ       m
//
// A first-order extrapolation errs by λ d² / 2 at the distance d. Over the disc of radius R that makes a summed square
// π λ² R⁶ / 12, for one record of 1 / (π R²) a unit of area. For a fixed number of records the summed square over all is
// least where λ² R⁶ is the same for each; relative to E and counted in pixels, with a free factor,
//   R = spacing · (w E / λ)^{1/3} .
// [Schwarzhaupt12] holds the sum of absolute errors the same instead, R ∝ (E / λ)^{1/4}, with a threshold in m² that makes
// the records of a model in millimetres 32 times denser than those of the same in metres; this one has no unit. By option
// that sum is balanced, with w² in place of the threshold.
//
// Held to     tests/core/records/test_spacing.cpp

#include "records/spacing.h"

#include <algorithm>
#include <cmath>

namespace eclat {

namespace {

// The root is taken of the mantissa, after a multiple of three is taken out of the exponent: libraries round differently
// on both sides of 1, and scenes scaled by a power of two would not get the same bits.
float cube_root(float x) {
    int exponent = 0;
    std::frexp(x, &exponent);
    const int third = (exponent + 300) / 3 - 100;
    return std::ldexp(std::cbrt(std::ldexp(x, -3 * third)), third);
}

}  // namespace

std::optional<Curvature> curvature_of(Metric metric) {
    switch (metric) {
        case Metric::occlusion: return Curvature::occlusion;
        case Metric::radiometric: return Curvature::radiometric;
        case Metric::geometric: return Curvature::geometric;
        case Metric::minimum:
        case Metric::harmonic: break;
    }
    return std::nullopt;
}

// For the least error (λ1 / λ2)^{1/2} would be right, [Schwarzhaupt12] takes 1/4; this lies between them.
float elongation(const PrincipalCurvatures& bends) {
    constexpr float largest = 2;
    if (!(bends.larger > 0)) return 1;
    if (bends.smaller * 8 <= bends.larger) return largest;
    return cube_root(bends.larger / bends.smaller);
}

void space(IrradianceRecord& record, float obstacle, float footprint, float mean, const SpacingRule& rule) {
    const float E = luminance(record.irradiance);
    record.distance = obstacle;
    if (curvature_of(rule.metric) && footprint > 0 && record.curvature > 0) {
        // The measure's own floor is 0.1 of the root mean square.
        const float judged = std::sqrt(E * E + sqr(0.1f * mean));
        const float allowed = rule.balanced == Balanced::squared
                                  ? cube_root(footprint * judged / record.curvature)
                                  : std::sqrt(std::sqrt(sqr(footprint) * judged / record.curvature));
        record.distance = std::min(record.distance, allowed);
    }
    const auto& g = record.translation.channel;
    const auto along = [&](int axis) { return luminance({g[0][axis], g[1][axis], g[2][axis]}); };
    const float steepness = length(Vec3{along(0), along(1), along(2)});
    // Not farther than the gradient can be trusted, and where a lower bound goes farther, the gradient less [Krivanek06].
    if (rule.gradient_limit && steepness > 0) record.distance = std::min(record.distance, E / steepness);
    record.radius = clamp(rule.spacing * record.distance, record.least_radius, record.largest_radius);
    // The long axis too ends where the short one would before an obstacle: curvature knows of those that gather rays met,
    // and what hangs close beside is met by luck.
    record.elongation = clamp(rule.spacing * obstacle / record.radius, 1, record.elongation);
    const float raised = rule.spacing * record.distance / record.radius;
    if (raised < 1)
        for (Vec3& channel : record.translation.channel) channel = channel * raised;
}

}  // namespace eclat
