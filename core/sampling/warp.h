// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Maps from the unit square to other domains, each beside its density. All are continuous, so stratification of the
// square survives.

#pragma once

#include "base/vec.h"

namespace eclat {

/// The largest float below 1: what a remapped random number is clamped to.
constexpr float below_one = 0x1.fffffep-1f;

// --- an eighth of a turn --------------------------------------------------------------------------------------------

struct SineCosine {
    float sine, cosine;
};

/// Sine and cosine of |x| ≤ π/4 by their Taylor series: the error is at most 6e-8, without branches or a call.
inline SineCosine sine_and_cosine(float x) {
    const float y = x * x;
    return {x * (1 + y * (-1.0f / 6 + y * (1.0f / 120 + y * (-1.0f / 5040 + y * (1.0f / 362880))))),
            1 + y * (-0.5f + y * (1.0f / 24 + y * (-1.0f / 720 + y * (1.0f / 40320))))};
}

// --- unit disc ------------------------------------------------------------------------------------------------------

/// Uniform on the unit disc; squares around the centre become circles [ShirleyChiu97].
inline Vec2 square_to_concentric_disk(Vec2 u) {
    const float a = 2 * u.x - 1, b = 2 * u.y - 1;
    if (a == 0 && b == 0) return {0, 0};
    const bool x_leads = std::abs(a) > std::abs(b);
    const float radius = x_leads ? a : b;
    // The angle never leaves ±π/4: the other two quarters are reached by swapping sine and cosine.
    const float angle = (pi / 4) * (x_leads ? b / a : a / b);
    const SineCosine at = sine_and_cosine(angle);
    const float leading = radius * at.cosine, other = radius * at.sine;
    return x_leads ? Vec2{leading, other} : Vec2{other, leading};
}

inline float concentric_disk_pdf_area() { return inv_pi; }

// --- directions around +z -------------------------------------------------------------------------------------------

/// Density cos θ / π: a uniform disc lifted onto the hemisphere [PBRT4 §A.5.3].
inline Vec3 square_to_cosine_hemisphere(Vec2 u) {
    const Vec2 d = square_to_concentric_disk(u);
    return {d.x, d.y, safe_sqrt(1 - d.x * d.x - d.y * d.y)};
}

inline float cosine_hemisphere_pdf_solid_angle(Vec3 w) { return std::max(0.0f, w.z) * inv_pi; }

/// Uniform on the cap of directions with 1 − cos θ ≤ `one_minus_cos`. Taking the difference and not the cosine keeps
/// the half-degree cone of the sun exact.
inline Vec3 square_to_uniform_cone(Vec2 u, float one_minus_cos) {
    const Vec2 d = square_to_concentric_disk(u);
    const float r2 = d.x * d.x + d.y * d.y;
    // Archimedes: equal areas of disc and cap where 1 − cos θ = r² (1 − cos θ_max); then sin θ / r is free of r.
    const float drop = r2 * one_minus_cos;
    const float stretch = safe_sqrt(one_minus_cos * (2 - drop));
    return {d.x * stretch, d.y * stretch, 1 - drop};
}

inline float uniform_cone_pdf_solid_angle(float one_minus_cos) { return 1 / (2 * pi * one_minus_cos); }

inline Vec3 square_to_uniform_hemisphere(Vec2 u) { return square_to_uniform_cone(u, 1); }

inline float uniform_hemisphere_pdf_solid_angle(Vec3 w) { return w.z >= 0 ? 1 / (2 * pi) : 0; }

inline Vec3 square_to_uniform_sphere(Vec2 u) { return square_to_uniform_cone(u, 2); }

inline float uniform_sphere_pdf_solid_angle() { return 1 / (4 * pi); }

// --- triangle -------------------------------------------------------------------------------------------------------

/// Barycentric weights of the second and third vertex, uniform in area; folds the square along its diagonal with
/// little distortion [Heitz19].
inline Vec2 square_to_triangle(Vec2 u) {
    if (u.y > u.x) return {u.x * 0.5f, u.y - u.x * 0.5f};
    return {u.x - u.y * 0.5f, u.y * 0.5f};
}

inline float triangle_pdf_area(float area) { return 1 / area; }

// --- linear density on [0, 1] ---------------------------------------------------------------------------------------

/// x with density proportional to lerp(a, b, x), for a, b ≥ 0 [PBRT4 §2.3.2].
inline float unit_to_linear(float u, float a, float b) {
    const float sum = a + b;
    if (!(sum > 0) || u == 0) return u;
    // Shares instead of the values themselves: their squares cannot overflow.
    const float p = a / sum, q = b / sum;
    return std::min(u / (p + std::sqrt(lerp(p * p, q * q, u))), below_one);
}

inline float linear_pdf(float x, float a, float b) { return 2 * lerp(a, b, x) / (a + b); }

}  // namespace eclat
