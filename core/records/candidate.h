// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A candidate: a point at which a record may be needed.

#pragma once

#include <cstdint>
#include <vector>

#include "sampling/rng.h"
#include "scene/surface_point.h"

namespace eclat {

/// Where a record could be wanted.
struct Candidate {
    Vec3 position;
    Vec3 normal;  // geometric, on the side that is shaded
    Vec3 shading_normal;
    float offset = 0;     // how far rays must start from the surface
    float footprint = 0;  // width of a pixel there; 0 without a camera, where the gather finds what stands for it
    uint32_t key = 0;     // of its random numbers: what was traced to find it, never coordinates
    bool seen = false;    // by a camera, or in its mirrors
    uint32_t region = 0;  // of the picture, in which records are weighed against pixels; 0: none

    Candidate() = default;
    Candidate(const SurfacePoint& point, float footprint, uint32_t key)
        : position(point.position),
          normal(point.normal_towards_shading()),
          shading_normal(point.frame.n),
          offset(point.offset),
          footprint(footprint),
          key(key) {}

    /// The other side of the same sheet.
    Candidate other_side() const {
        Candidate out = *this;
        out.normal = -normal;
        out.shading_normal = -shading_normal;
        out.key = hash(key, 1);
        return out;
    }

    /// A ray that leaves into the hemisphere around `normal`.
    Ray ray(Vec3 direction) const { return {position + normal * offset, 0, direction}; }
};

/// Appends to `out` the sides of `point` whose irradiance its lobes scatter towards `wo` (in its frame): that of `seen`, the
/// candidate on the side of wo, the other, both or none.
inline void add_sides(const SurfacePoint& point, Vec3 wo, const Candidate& seen, std::vector<Candidate>& out) {
    if (!is_black(point.bsdf.diffuse_albedo(wo))) out.push_back(seen);
    if (!is_black(point.bsdf.translucent_albedo(wo))) out.push_back(seen.other_side());
}

}  // namespace eclat
