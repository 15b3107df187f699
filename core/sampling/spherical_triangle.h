// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Directions uniform in the solid angle of a triangle.

#pragma once

#include <algorithm>
#include <cmath>

#include "base/vec3d.h"

namespace eclat {

/// A triangle on the unit sphere. The map is Arvo's [Arvo95]: a part of the area by a cut from b to the opposite arc,
/// then uniform height along the cut. It is evaluated without angles, from half-angle formulas as in [Peters21],
/// because Arvo's sums of dihedral angles cancel for small triangles.
///
/// All is in double. A triangle that is seen from a height of h of its size fills nearly half of the sphere, and almost
/// all cuts end within h of −b: what tells them apart is a difference of order h, of which floats keep 10⁻⁷ / h.
struct SphericalTriangle {
    Vec3d a, b, c;
    double volume, sum_c, sum_ab;
    double solid_angle;  // NaN where a corner is not a direction

    /// From the vector to one corner and the two edges from there, in either orientation.
    /// tan(Ω/2) = |a·(b×c)| / (1 + a·b + b·c + c·a) for unit vectors [VanOosterom83].
    static SphericalTriangle seen(Vec3d corner, Vec3d edge1, Vec3d edge2) {
        const Vec3d second = corner + edge1, third = corner + edge2;
        const double la = length(corner), lb = length(second), lc = length(third);
        // Edges instead of corners in the product: the same volume, without cancellation.
        const double volume = std::abs(dot(corner, cross(edge1, edge2))) / (la * lb * lc);
        const Vec3d a = corner * (1 / la), b = second * (1 / lb), c = third * (1 / lc);
        const double sum_c = dot(c, a) + dot(c, b), sum_ab = 1 + dot(a, b);
        return {a, b, c, volume, sum_c, sum_ab, 2 * std::atan2(volume, sum_ab + sum_c)};
    }

    /// The direction for `u`; its density is 1 / solid_angle.
    Vec3d sample(Vec2 u) const {
        // Cut off the area u.x · Ω by an arc from b to d on the arc a–c. With m = (a + d) / |a + d| = x a + y c,
        // the formula for tan(Ω/2) of the triangle a, b, d is linear in x and y; d is a, reflected at m.
        const double half = 0.5 * u.x * solid_angle;
        const double sine = std::sin(half), cosine = std::cos(half);
        const Vec3d m = a * (volume * cosine - sum_c * sine) + c * (sum_ab * sine);
        const Vec3d d = m * (2 * dot(a, m) / length_squared(m)) - a;

        // Uniform in height over b along the cut; 1 − b·d from the chord, which does not cancel.
        const double drop = u.y * 0.5 * length_squared(d - b);
        const Vec3d tangent = d - b * dot(b, d);
        const double l2 = length_squared(tangent);
        if (!(l2 > 0)) return b;
        const Vec3d w = b * (1 - drop) + tangent * std::sqrt(std::max(0.0, drop * (2 - drop)) / l2);
        return w * (1 / length(w));
    }
};

}  // namespace eclat
