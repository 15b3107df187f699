// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// How much of what leaves one patch would reach another if nothing stood between them.
//
//   F_ij   form factor: share of the radiosity of j that arrives at i as irradiance; A_i F_ij = A_j F_ji
//   A_i F_ij  exchange between i and j, m²

#pragma once

#include <array>
#include <span>

#include "radiosity/patches.h"

namespace eclat {

/// Form factor to the triangle from a point with unit normal `n`, exactly, what lies below its horizon cut off: the sum over
/// edges of the angle that each subtends times the cosine of its plane [Lambert1760]. Either winding.
float point_to_triangle(Vec3 x, Vec3 n, const Vec3 (&corner)[3]);

/// The same to a patch, of which only the front is seen. Patches that are small from there are taken for points.
float point_to_patch(Vec3 x, Vec3 n, const PatchNode& patch);

/// Exchange of two patches: the exact form factor to the larger one, integrated over the smaller. `near` (0 … 1) is how large
/// they are beside their distance: it chooses the quadrature.
float patch_exchange(const PatchNode& a, const PatchNode& b, float near);

/// Two points of surfaces that look at each other.
struct PointPair {
    Vec3 x, normal_x, y, normal_y;

    /// Exchange per area of both, cos θ cos θ′ / (π r²), m⁻²; 0 where one looks away.
    float kernel() const;
};

/// Points spread by area over what two nodes hold: sample `index` of `count`.
PointPair sample_pair(const PatchTree& tree, uint32_t a, uint32_t b, uint32_t seed, uint32_t index, uint32_t count);

/// Whether any point of `a` might see any point of `b`, by their planes and cones of normals alone.
bool may_see(const PatchNode& a, const PatchNode& b);

}  // namespace eclat
