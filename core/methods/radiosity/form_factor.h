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

/// Computes the exact form factor from a point with unit normal `n` to the part of a triangle above its horizon: the
/// sum over edges of the angle that each subtends times the cosine of its plane [Lambert1760]. The winding does not
/// matter.
float point_to_triangle(Vec3 x, Vec3 n, const Vec3 (&corner)[3]);

/// Computes the form factor to a patch, which is visible only from the front. Patches that appear small are treated as
/// points.
float point_to_patch(Vec3 x, Vec3 n, const PatchNode& patch);

/// Computes the exchange of two patches: the exact form factor to the larger one, integrated over the smaller one.
/// `near` (0 … 1) is their size relative to their distance, which determines the quadrature.
float patch_exchange(const PatchNode& a, const PatchNode& b, float near);

/// Two points on surfaces that face each other, and the triangles or parts on which they lie.
struct PointPair {
    Vec3 x, normal_x, y, normal_y;
    const PatchNode *on_x, *on_y;

    /// Returns the exchange per area of both surfaces, cos θ cos θ′ / (π r²), in m⁻²; it is 0 if one faces away.
    float kernel() const;
    /// Returns a mean of this value without peaks for close points: it is integrated exactly over the larger part.
    float smooth_kernel() const;
};

/// The exposed parts of the patches of nodes.
class ExposedParts {
  public:
    /// `surfaces`, with one entry per node, tell which parts are exposed; if there are none, everything is. They must
    /// outlive this object.
    ExposedParts(const PatchTree& tree, std::span<const PatchSurface> surfaces);

    /// Returns sample `index` of `count` of pairs of points that are uniformly distributed over the exposed parts of
    /// two nodes.
    PointPair sample_pair(uint32_t a, uint32_t b, uint32_t seed, uint32_t index, uint32_t count) const;
    bool any(uint32_t node) const { return parts_[node].area > 0; }

  private:
    const PatchTree& tree_;
    std::span<const PatchSurface> surfaces_;
    struct Part {
        uint32_t child;  // no_node: a patch
        float area;
    };
    std::vector<Part> parts_;  // compact data of each node, because descents of the tree dominate the time
};

/// Returns whether any point of `a` may see any point of `b`, judging only by their planes and cones of normals.
bool may_see(const PatchNode& a, const PatchNode& b);

}  // namespace eclat
