// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The share of the light leaving one patch that reaches another if nothing is between them.
//
//   F_ij   form factor: share of the radiosity of j that arrives at i as irradiance; A_i F_ij = A_j F_ji
//   A_i F_ij  exchange between i and j, m²

#pragma once

#include <array>
#include <span>
#include <vector>

#include "methods/radiosity/patch_surfaces.h"

namespace eclat {

/// Form factor to the triangle from a point with unit normal `n`, exactly, what lies below its horizon cut off: the sum over
/// edges of the angle that each subtends times the cosine of its plane [Lambert1760]. Either winding.
float point_to_triangle(Vec3 x, Vec3 n, const Vec3 (&corner)[3]);

/// The same to a patch, of which only the front is seen. Patches that are small from there are taken for points.
float point_to_patch(Vec3 x, Vec3 n, const PatchNode& patch);

/// Exchange of two patches: the exact form factor to the larger one, integrated over the smaller. `near` (0 … 1) is how large
/// they are beside their distance: it chooses the quadrature.
float patch_exchange(const PatchNode& a, const PatchNode& b, float near);

/// Two points of surfaces that look at each other, and the triangles or parts that they lie on.
struct PointPair {
    Vec3 x, normal_x, y, normal_y;
    const PatchNode *on_x, *on_y;

    /// Exchange per area of both, cos θ cos θ′ / (π r²), m⁻²; 0 where one looks away.
    float kernel() const;
    /// The same on average, without its peaks where two points are close: exact over the larger part.
    float smooth_kernel() const;
};

/// The exposed part of what nodes hold.
class ExposedParts {
  public:
    /// `surfaces` (one a node; borrowed) say what is exposed; all, where there are none.
    ExposedParts(const PatchTree& tree, std::span<const PatchSurface> surfaces);

    /// Points spread by area over the exposed parts of two nodes: sample `index` of `count`.
    PointPair sample_pair(uint32_t a, uint32_t b, uint32_t seed, uint32_t index, uint32_t count) const;
    bool any(uint32_t node) const { return parts_[node].area > 0; }

  private:
    const PatchTree& tree_;
    std::span<const PatchSurface> surfaces_;
    struct Part {
        uint32_t child;  // no_node: a patch
        float area;
    };
    std::vector<Part> parts_;  // by node, close together: walks down the tree are most of the work
};

/// Whether any point of `a` might see any point of `b`, by their planes and cones of normals alone.
bool may_see(const PatchNode& a, const PatchNode& b);

}  // namespace eclat
