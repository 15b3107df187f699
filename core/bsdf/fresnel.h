// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Fresnel reflectance of smooth interfaces, unpolarised light.
//
// References   [BornWolf99] dielectrics and conductors, [Schlick94], [Duntley42] diffuse light

#pragma once

#include "base/color.h"
#include "base/vec.h"

namespace eclat {

struct Refraction {
    float reflectance = 1;
    float cos_t = 0;  ///< cosine of the refracted direction, 0 at total reflection
};

/// Dielectric interface hit at `cos_i` ≥ 0 from the side of wo; `eta` is the index beyond over the index before.
inline Refraction fresnel_dielectric(float cos_i, float eta) {
    if (eta == 1) return {0, cos_i};
    const float sin2_t = (1 - cos_i * cos_i) / (eta * eta);
    if (sin2_t >= 1) return {1, 0};
    const float cos_t = safe_sqrt(1 - sin2_t);
    const float r_s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    const float r_p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    return {0.5f * (r_s * r_s + r_p * r_p), cos_t};
}

/// Unit vector into which `wo` refracts at a facet with normal `m`, dot(wo, m) = cos_i > 0.
inline Vec3 refracted(Vec3 wo, Vec3 m, float cos_i, float cos_t, float eta) {
    return m * (cos_i / eta - cos_t) - wo * (1 / eta);
}

/// Conductor with the complex index eta + i·k, relative to the outside [BornWolf99 sec. 14.2].
inline float fresnel_conductor(float cos_i, float eta, float k) {
    const float cos2 = cos_i * cos_i, sin2 = 1 - cos2;
    // (a + i·b)² = (eta + i·k)² − sin²θ
    const float re = eta * eta - k * k - sin2;
    const float norm = std::sqrt(re * re + 4 * eta * eta * k * k);  // a² + b²
    const float a2_cos = 2 * cos_i * safe_sqrt(0.5f * (norm + re));
    const float r_s = (norm + cos2 - a2_cos) / (norm + cos2 + a2_cos);
    const float even = cos2 * norm + sin2 * sin2, odd = a2_cos * sin2;
    const float r_p = r_s * (even - odd) / (even + odd);
    return 0.5f * (r_s + r_p);
}

inline Color fresnel_conductor(float cos_i, Color eta, Color k) {
    return {fresnel_conductor(cos_i, eta.r, k.r), fresnel_conductor(cos_i, eta.g, k.g),
            fresnel_conductor(cos_i, eta.b, k.b)};
}

/// (1 − cosθ)⁵, the weight of the reflectance at grazing angles [Schlick94].
inline float schlick_weight(float cos_i) {
    const float c = clamp(1 - cos_i, 0, 1);
    return sqr(sqr(c)) * c;
}

inline Color fresnel_schlick(float cos_i, Color f0, Color f90) {
    const float w = schlick_weight(cos_i);
    return f0 * (1 - w) + f90 * w;
}

/// Reflectance at normal incidence.
inline float fresnel_normal(float ior) { return sqr((ior - 1) / (ior + 1)); }

/// Reflectance of a dielectric interface under uniform diffuse light: 2 ∫ F(μ) μ dμ, for any `eta` > 0.
inline float diffuse_fresnel_reflectance(float eta) {
    // From the dense side, most of the integral is total reflection: take it from the other side [Duntley42].
    if (eta < 1) return 1 - (1 - diffuse_fresnel_reflectance(1 / eta)) * eta * eta;
    constexpr int n = 512;  // midpoint rule, error below 1e-6 for eta in [1, 3]
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        const double mu = (i + 0.5) / n;
        sum += double(fresnel_dielectric(float(mu), eta).reflectance) * 2 * mu / n;
    }
    return float(sum);
}

}  // namespace eclat
