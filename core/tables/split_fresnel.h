// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Fresnel reflectance as a sum of three functions of the angle whose factors are colours, so that one table of a rough
// interface's coefficients serves all colours: F(c) = F0 (1 − w) + F90 w − dip c (1 − c)⁶ with w = (1 − c)⁵.
//
// References   [Schlick94] the first two, exact for metallic-roughness; [LazanyiSzirmay05] the third, for metals
// Departures   The dip's factor is the least-squares one over c in [0, 1]. What is left: tests/core/tables/test_brdf_table.cpp.

#pragma once

#include <array>

#include "bsdf/reflection.h"

namespace eclat {

constexpr int fresnel_terms = 3;

/// 1 − w, w and −c (1 − c)⁶.
inline std::array<float, fresnel_terms> fresnel_term_values(float cos_i) {
    const float w = schlick_weight(cos_i), c = clamp(cos_i, 0, 1);
    return {1 - w, w, -c * (1 - c) * w};
}

/// The terms' factors.
using FresnelFactors = std::array<Color, fresnel_terms>;

inline FresnelFactors split_fresnel(const InterfaceReflectance& reflectance) {
    if (reflectance.kind == InterfaceReflectance::Kind::schlick) return {reflectance.a, reflectance.b, Color()};
    const Color f0 = reflectance(1);
    Color dip;
    float norm = 0;
    constexpr int n = 256;  // midpoint rule over a smooth function
    for (int i = 0; i < n; ++i) {
        const float c = (float(i) + 0.5f) / n;
        const std::array<float, fresnel_terms> t = fresnel_term_values(c);
        dip += (reflectance(c) - f0 * t[0] - Color(t[1])) * t[2];
        norm += t[2] * t[2];
    }
    return {f0, Color(1), dip / norm};
}

}  // namespace eclat
