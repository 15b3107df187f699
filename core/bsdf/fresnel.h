// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// How much a smooth interface reflects.

#pragma once

#include "base/color.h"

namespace eclat {

struct DielectricFresnel {
    float reflectance;
    float cos_t;  // of the refracted direction, signed opposite to cos_i; 0 at total reflection
    float eta_i_over_t;
};

/// Unpolarised reflectance of a dielectric; `ior` = inside / outside, `cos_i` < 0 is inside [Walter07 eq. 22].
inline DielectricFresnel fresnel_dielectric(float cos_i, float ior) {
    const bool outside = cos_i >= 0;
    const float eta = outside ? ior : 1 / ior;
    const float c = std::fabs(cos_i);
    const float cos2_t = 1 - (1 - c * c) / (eta * eta);
    if (cos2_t <= 0) return {1, 0, 1 / eta};
    const float t = std::sqrt(cos2_t);
    const float rs = (c - eta * t) / (c + eta * t), rp = (t - eta * c) / (t + eta * c);
    return {0.5f * (rs * rs + rp * rp), outside ? -t : t, 1 / eta};
}

/// Unpolarised reflectance of a conductor with complex index eta − ik, one channel [BornWolf99 sec. 14.2].
inline float fresnel_conductor(float cos_i, float eta, float k) {
    const float c2 = cos_i * cos_i, s2 = 1 - c2;
    const float t0 = eta * eta - k * k - s2;
    const float a2b2 = safe_sqrt(t0 * t0 + 4 * eta * eta * k * k);
    const float t1 = a2b2 + c2, a = safe_sqrt(0.5f * (a2b2 + t0)), t2 = 2 * a * cos_i;
    const float rs = (t1 - t2) / (t1 + t2);
    const float t3 = a2b2 * c2 + s2 * s2, t4 = t2 * s2;
    return 0.5f * (rs + rs * (t3 - t4) / (t3 + t4));
}

inline Color fresnel_conductor(float cos_i, Color eta, Color k) {
    return {fresnel_conductor(cos_i, eta.r, k.r), fresnel_conductor(cos_i, eta.g, k.g),
            fresnel_conductor(cos_i, eta.b, k.b)};
}

/// [Schlick94 eq. 15]
inline Color fresnel_schlick(float cos_i, Color f0, Color f90) {
    const float m = clamp(1 - cos_i, 0, 1);
    return f0 + (f90 - f0) * (m * m * m * m * m);
}

/// Diffuse reflectance of a dielectric for light arriving from outside, uniformly over the hemisphere:
/// 2 ∫ F(μ) μ dμ by the midpoint rule (256 points: error below 10⁻⁵).
inline float fresnel_diffuse_reflectance(float ior) {
    double sum = 0;
    for (int i = 0; i < 256; ++i) {
        const float mu = (static_cast<float>(i) + 0.5f) / 256;
        sum += 2.0 * mu * fresnel_dielectric(mu, ior).reflectance / 256;
    }
    return static_cast<float>(sum);
}

}  // namespace eclat
