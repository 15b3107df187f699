// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Directions uniform in the solid angle of a triangle.

#pragma once

#include "base/vec.h"

namespace eclat {

/// A triangle on the unit sphere. The map is Arvo's [Arvo95]: a part of the area by a cut from b to the opposite arc,
/// then uniform height along the cut. It is evaluated without angles, from half-angle formulas as in [Peters21],
/// because Arvo's sums of dihedral angles cancel for small triangles.
struct SphericalTriangle {
    Vec3 a, b, c;
    float volume, sum_c, sum_ab;
    float solid_angle;  // NaN where a corner is not a direction

    /// From unit vectors, in either orientation. tan(Ω/2) = |a·(b×c)| / (1 + a·b + b·c + c·a) [VanOosterom83].
    static SphericalTriangle around(Vec3 a, Vec3 b, Vec3 c) {
        // Edges instead of corners in the product: the same volume, without cancellation.
        const float volume = std::abs(dot(a, cross(b - a, c - a)));
        const float sum_c = dot(c, a) + dot(c, b), sum_ab = 1 + dot(a, b);
        return {a, b, c, volume, sum_c, sum_ab, 2 * std::atan2(volume, sum_ab + sum_c)};
    }

    /// The direction for `u`; its density is 1 / solid_angle.
    Vec3 sample(Vec2 u) const {
        // Cut off the area u.x · Ω by an arc from b to d on the arc a–c. With m = (a + d) / |a + d| = x a + y c,
        // the formula for tan(Ω/2) of the triangle a, b, d is linear in x and y; d is a, reflected at m.
        const float half = 0.5f * u.x * solid_angle;
        const float sine = std::sin(half), cosine = std::cos(half);
        const Vec3 m = a * (volume * cosine - sum_c * sine) + c * (sum_ab * sine);
        const Vec3 d = m * (2 * dot(a, m) / length_squared(m)) - a;

        // Uniform in height over b along the cut; 1 − b·d from the chord, which does not cancel.
        const float drop = u.y * 0.5f * length_squared(d - b);
        const Vec3 tangent = d - b * dot(b, d);
        const float l2 = length_squared(tangent);
        if (!(l2 > 0)) return b;
        return normalize(b * (1 - drop) + tangent * (safe_sqrt(drop * (2 - drop)) / std::sqrt(l2)));
    }
};

}  // namespace eclat
