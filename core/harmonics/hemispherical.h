// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Hemispherical harmonics: spherical harmonics of a hemisphere that is stretched over the whole sphere.
//
// References   [Gautron04]
//
// Symbol       name here    meaning
//   H_l^m      –            K̃ P_l^|m|(2 cosθ − 1) × {1, √2 cos mφ, √2 sin |m|φ}, with 2π in K̃ where K has 4π
//
// t = 2 cosθ − 1 maps the hemisphere onto the sphere, azimuths kept, and doubles all solid angles: H(w) = √2 Y(w′) with
// w′ = (k x, k y, t) and k = √(1 − t²) / sinθ = 2 √(cosθ / (1 + cosθ)). Orthonormality is that of Y.
// Every H with m ≠ 0 vanishes at the horizon, which w′ sees as one point: lobes along the surface converge slowly.

#pragma once

#include "harmonics/spherical.h"

namespace eclat {

/// Where the stretched hemisphere's direction `w`, w.z ≥ 0, lies on the sphere.
inline Direction stretched_to_sphere(Direction w) {
    const double k = 2 * std::sqrt(w.z / (1 + w.z));
    return {k * w.x, k * w.y, 2 * w.z - 1};
}

/// All H_l^m of `order` in direction `w`; 0 below the horizon.
inline void hemispherical_harmonics(int order, Direction w, double* out) {
    if (!(w.z >= 0)) {
        for (int i = 0; i < coefficient_count(order); ++i) out[i] = 0;
        return;
    }
    spherical_harmonics(order, stretched_to_sphere(w), out);
    for (int i = 0; i < coefficient_count(order); ++i) out[i] *= std::sqrt(2.0);
}

/// `legendre` for H_l^m: factors of cos mφ and sin mφ at the height z = cosθ.
inline void hemispherical_legendre(int order, double z, double* P) {
    const double t = 2 * z - 1;
    legendre(order, t, std::sqrt(std::fmax(0, 1 - t * t)), P);
    for (int i = 0; i < polar_count(order); ++i) P[i] *= std::sqrt(2.0);
}

}  // namespace eclat
