// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Symbol    name here          meaning                                                           unit
//   λ1, λ2  larger, smaller    principal second derivatives of the irradiance's luminance        W m⁻⁴
//   E       E                  that luminance, with the floor that the measure of error has      W m⁻²
//   w       footprint          width of a pixel                                                  m
//   ℓ       record.distance    the length that the radius follows, radius R1 = spacing · ℓ       m
// The error of a first-order extrapolation is λ d² / 2 at the distance d. Its square, integrated over the disc of
// radius R, is π λ² R⁶ / 12, and there are 1 / (π R²) records per unit of area. For a fixed number of records, the sum
// over all records is least if λ² R⁶ is the same for each. For errors relative to E, areas in pixels and a free factor,
// this gives
//   R = spacing · (w E / λ)^{1/3} .
// [Schwarzhaupt12] makes the sum of absolute errors equal instead, R ∝ (E / λ)^{1/4}, with a threshold in m². With it,
// a model in millimetres gets 32 times as many records as the same model in metres, while the formula above does not
// depend on units. The option `absolute` balances the sum of absolute errors, with w² in place of the threshold.
//
// Held to     tests/core/records/test_spacing.cpp

#include "records/spacing.h"

#include <algorithm>
#include <cmath>

namespace eclat {

namespace {

// The root is computed from the mantissa, after a multiple of three has been taken out of the exponent. Libraries round
// differently on the two sides of 1, so scenes scaled by a power of two would otherwise not have the same bits.
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

// The least error would require (λ1 / λ2)^{1/2}, and [Schwarzhaupt12] uses the exponent 1/4; this exponent is between
// them.
float elongation(const PrincipalCurvatures& bends) {
    constexpr float largest = 2;
    if (!(bends.larger > 0)) return 1;
    if (bends.smaller * 8 <= bends.larger) return largest;
    return cube_root(bends.larger / bends.smaller);
}

void space(IrradianceRecord& record, float obstacle, float footprint, float mean, const SpacingRule& rule) {
    // The strip between a record and an obstacle, in which the obstacle's shadow deepens, gets records of its own only if the
    // record does not reach the obstacle. With wide spacings it did, and the rims of boards and beams had scallops. The factor
    // was chosen in a furnished room: with 0.55, a third more records gave no smaller error.
    constexpr float most_of_way = 0.8f;
    if (curvature_of(rule.metric)) obstacle *= std::min(1.0f, most_of_way / rule.spacing);
    const float E = luminance(record.irradiance);
    record.distance = obstacle;
    if (curvature_of(rule.metric) && footprint > 0 && record.curvature > 0) {
        // The lower bound in the error measure is 0.1 of the root mean square.
        const float judged = std::sqrt(E * E + sqr(0.1f * mean));
        const float allowed = rule.balanced == Balanced::squared
                                  ? cube_root(footprint * judged / record.curvature)
                                  : std::sqrt(std::sqrt(sqr(footprint) * judged / record.curvature));
        record.distance = std::min(record.distance, allowed);
    }
    const auto& g = record.translation.channel;
    const auto along = [&](int axis) { return luminance({g[0][axis], g[1][axis], g[2][axis]}); };
    const float steepness = length(Vec3{along(0), along(1), along(2)});
    // The radius is limited to the distance over which the gradient is reliable. If a lower bound makes it larger, the
    // gradient is reduced [Krivanek06].
    if (rule.gradient_limit && steepness > 0) record.distance = std::min(record.distance, E / steepness);
    record.radius = clamp(rule.spacing * record.distance, record.least_radius, record.largest_radius);
    // The distance of an obstacle limits the long axis like the short one, because the curvature only accounts for
    // obstacles that gather rays hit, and they hit objects close beside the point only by chance.
    record.elongation = clamp(rule.spacing * obstacle / record.radius, 1, record.elongation);
    const float raised = rule.spacing * record.distance / record.radius;
    if (raised < 1)
        for (Vec3& channel : record.translation.channel) channel = channel * raised;
}

}  // namespace eclat
