// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The Beckmann distribution of facet normals, anisotropic, with Smith's masking.
//
// References   [Walter07] density and the rational fit of G1, [Jakob14] sampling of visible normals, [Giles12]
// Departures   Values use Walter's fit of G1 (relative error below 0.4 %), like most renderers; the density of visible
//              normals uses the exact one, so sample weights leave 1 by that much.

#pragma once

#include "sampling/warp.h"

namespace eclat {

/// D(m) for m.z > 0.
inline float beckmann_density(Vec3 m, float alpha_u, float alpha_v) {
    const float cos2 = m.z * m.z;
    const float e = (sqr(m.x / alpha_u) + sqr(m.y / alpha_v)) / cos2;
    // exp underflows beyond; cos² may have done so already.
    if (!(e < 80)) return 0;
    return std::exp(-e) / (pi * alpha_u * alpha_v * cos2 * cos2);
}

/// cosθ / G1(w) by the rational fit [Walter07 eq. 27].
inline float beckmann_fitted_area(Vec3 w, float alpha_u, float alpha_v) {
    const float s = std::sqrt(sqr(alpha_u * w.x) + sqr(alpha_v * w.y));
    if (w.z >= 1.6f * s) return w.z;
    const float a = w.z / s;
    return s * (1 + 2.276f * a + 2.577f * a * a) / (3.535f + 2.181f * a);
}

/// Projected area of the facets with slope below `x` in the plane of incidence, unit roughness [Jakob14].
inline float beckmann_area_below(float x, float cos_theta, float sin_theta) {
    constexpr float half_inv_sqrt_pi = 0.28209479177f;  // 1 / (2 √π)
    return 0.5f * cos_theta * (1 + std::erf(x)) + sin_theta * half_inv_sqrt_pi * std::exp(-x * x);
}

/// Beyond this slope, in units of the roughness, erf is 1 in single precision.
constexpr float beckmann_steepest = 4;

inline float beckmann_steepest_visible(float cos_theta, float sin_theta) {
    return cos_theta >= beckmann_steepest * sin_theta ? beckmann_steepest : cos_theta / sin_theta;
}

/// cosθ / G1(w), exact: the area over all visible slopes.
inline float beckmann_visible_area(Vec3 w, float alpha_u, float alpha_v) {
    const float sin_theta = std::sqrt(sqr(alpha_u * w.x) + sqr(alpha_v * w.y));
    return beckmann_area_below(beckmann_steepest_visible(w.z, sin_theta), w.z, sin_theta);
}

/// Inverse of erf [Giles12], relative error below 4e-7.
inline float inverse_erf(float x) {
    float w = -std::log((1 - x) * (1 + x));
    if (w < 5) {
        w -= 2.5f;
        float p = 2.81022636e-08f;
        for (const float c : {3.43273939e-07f, -3.5233877e-06f, -4.39150654e-06f, 0.00021858087f, -0.00125372503f,
                              -0.00417768164f, 0.246640727f, 1.50140941f})
            p = c + p * w;
        return p * x;
    }
    w = std::sqrt(w) - 3;
    float p = -0.000200214257f;
    for (const float c : {0.000100950558f, 0.00134934322f, -0.00367342844f, 0.00573950773f, -0.0076224613f,
                          0.00943887047f, 1.00167406f, 2.83297682f})
        p = c + p * w;
    return p * x;
}

/// Returns the slope x in the plane of incidence below which the fraction `u` of the visible area lies, for unit
/// roughness.
inline float sample_beckmann_slope(float u, float cos_theta, float sin_theta) {
    constexpr float half_inv_sqrt_pi = 0.28209479177f;
    float low = -beckmann_steepest, high = beckmann_steepest_visible(cos_theta, sin_theta);
    const float target = u * beckmann_area_below(high, cos_theta, sin_theta);
    // Newton's method from the solution at normal incidence, replaced by bisection where it leaves the bracket; 1e-6 is
    // the rounding error of the area.
    float x = clamp(inverse_erf(2 * u - 1), low, lerp(low, high, 0.9f));
    for (int i = 0; i < 20; ++i) {
        const float error = beckmann_area_below(x, cos_theta, sin_theta) - target;
        if (std::abs(error) <= 1e-6f * target) break;
        (error > 0 ? high : low) = x;
        const float slope = 2 * half_inv_sqrt_pi * (cos_theta - x * sin_theta) * std::exp(-x * x);
        const float next = x - error / slope;
        x = next > low && next < high ? next : 0.5f * (low + high);
    }
    return x;
}

/// Normal with density D(m) · max(0, dot(wo, m)) / σ(wo), wo.z > 0.
inline Vec3 sample_beckmann_visible_normal(Vec3 wo, Vec2 u, float alpha_u, float alpha_v) {
    // The configuration is stretched to unit roughness, and the plane of incidence is rotated to +x.
    const Vec3 w = normalize(Vec3{alpha_u * wo.x, alpha_v * wo.y, wo.z});
    const float sin_theta = std::sqrt(w.x * w.x + w.y * w.y);
    const float cos_phi = sin_theta > 0 ? w.x / sin_theta : 1, sin_phi = sin_theta > 0 ? w.y / sin_theta : 0;

    // Slopes perpendicular to the plane of incidence are normally distributed.
    const float across = inverse_erf(clamp(2 * u.y - 1, -0.9999999f, 0.9999999f));
    const float along = sample_beckmann_slope(clamp(u.x, 1e-7f, below_one), w.z, sin_theta);

    const float slope_x = cos_phi * along - sin_phi * across, slope_y = sin_phi * along + cos_phi * across;
    return normalize(Vec3{-alpha_u * slope_x, -alpha_v * slope_y, 1});
}

}  // namespace eclat
