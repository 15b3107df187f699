// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A place where a record could be wanted.

#pragma once

#include <cstdint>

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

    /// A ray that leaves into the hemisphere around `normal`.
    Ray ray(Vec3 direction) const { return {position + normal * offset, 0, direction}; }
};

}  // namespace eclat
