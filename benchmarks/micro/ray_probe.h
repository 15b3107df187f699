// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// What the core asks of Embree, seen from between the two: for how long, or which rays.

#pragma once

#include <cstdint>
#include <vector>

#include "micro/embree_calls.h"
#include "scene/ray.h"

namespace eclat {

/// Rays in the order in which each thread sent them, one thread after another.
struct RayRecording {
    RTCScene scene = nullptr;  // borrowed: it lives as long as the core's scene
    std::vector<Ray> nearest, shadow;
};

struct TimeInside {
    double seconds = 0;  // sum over threads
    uint64_t rays = 0;   // both kinds
};

/// From now on, until `stop_timing`, queries are timed. Costs two reads of the clock register a query.
void start_timing();
TimeInside stop_timing();

/// From now on, until `stop_recording`, rays are kept: 32 bytes each.
void start_recording();
RayRecording stop_recording();

}  // namespace eclat
