// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The GGX (Trowbridge–Reitz) distribution of facet normals, anisotropic, with Smith's masking.
//
// References   [Walter07], [Heitz14] anisotropy and masking, [Dupuy23] sampling of visible normals
//
// Symbol       name here        meaning
//   D          ggx_density      density of facet area over normals
//   G1         –                share of the facets that a direction sees; cosθ / G1 = ggx_visible_area
//   σ          visible area     projected area of the visible facets, per unit of surface

#pragma once

#include "base/vec.h"

namespace eclat {

/// D(m) for m.z > 0 [Heitz14 sec. 5].
inline float ggx_density(Vec3 m, float alpha_u, float alpha_v) {
    const float q = sqr(m.x / alpha_u) + sqr(m.y / alpha_v) + m.z * m.z;
    return 1 / (pi * alpha_u * alpha_v * q * q);
}

/// Length of `w` stretched by the roughness, the square root that all of Smith's terms share.
inline float ggx_stretch(Vec3 w, float alpha_u, float alpha_v) {
    return std::sqrt(w.z * w.z + sqr(alpha_u * w.x) + sqr(alpha_v * w.y));
}

/// σ(w) = cosθ / G1(w) [Heitz14 sec. 5]; not zero at grazing angles.
inline float ggx_visible_area(Vec3 w, float alpha_u, float alpha_v) {
    return 0.5f * (w.z + ggx_stretch(w, alpha_u, alpha_v));
}

/// Normal with density D(m) · max(0, dot(wo, m)) / σ(wo), wo.z > 0 [Dupuy23].
inline Vec3 sample_ggx_visible_normal(Vec3 wo, Vec2 u, float alpha_u, float alpha_v) {
    const Vec3 w = normalize(Vec3{alpha_u * wo.x, alpha_v * wo.y, wo.z});
    // A hemisphere seen from w reflects it into a spherical cap, uniformly.
    const float phi = 2 * pi * u.x;
    const float z = 1 - u.y * (1 + w.z);
    const float sin_theta = safe_sqrt((1 - z) * (1 + z));
    const Vec3 h = Vec3{sin_theta * std::cos(phi), sin_theta * std::sin(phi), z} + w;
    return normalize(Vec3{alpha_u * h.x, alpha_v * h.y, std::max(h.z, 1e-12f)});
}

}  // namespace eclat
