// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Candidates for records.

#pragma once

#include <cstdint>
#include <vector>

#include "sampling/rng.h"
#include "scene/surface_point.h"

namespace eclat {

/// A point at which a record may be needed.
struct Candidate {
    Vec3 position;
    Vec3 normal;  // geometric normal on the side that is shaded
    Vec3 shading_normal;
    float offset = 0;     // distance from the surface at which rays must start, m
    float footprint = 0;  // width of a pixel there, m; 0 without a camera: the gather sets it
    uint32_t key = 0;     // key of the random numbers; depends on how it was found, not on coordinates
    bool seen = false;    // whether a camera sees it, perhaps in mirrors
    uint32_t region = 0;  // region of the picture (`DirectRegions`), or 0 for none

    Candidate() = default;
    Candidate(const SurfacePoint& point, float footprint, uint32_t key)
        : position(point.position),
          normal(point.normal_towards_shading()),
          shading_normal(point.frame.n),
          offset(point.offset),
          footprint(footprint),
          key(key) {}

    /// Returns the candidate on the other side of the surface.
    Candidate other_side() const {
        Candidate out = *this;
        out.normal = -normal;
        out.shading_normal = -shading_normal;
        out.key = hash(key, 1);
        return out;
    }

    /// Returns a ray from the candidate into the hemisphere around `normal`.
    Ray ray(Vec3 direction) const { return {position + normal * offset, 0, direction}; }
};

/// Appends to `out` a candidate for each side of `point` whose irradiance the lobes scatter towards `wo`, which is in
/// the frame of the point. `seen` is the candidate on the side of `wo`. None, either or both of the sides may be
/// appended.
inline void add_sides(const SurfacePoint& point, Vec3 wo, const Candidate& seen, std::vector<Candidate>& out) {
    if (!is_black(point.bsdf.diffuse_albedo(wo))) out.push_back(seen);
    if (!is_black(point.bsdf.translucent_albedo(wo))) out.push_back(seen.other_side());
}

}  // namespace eclat
