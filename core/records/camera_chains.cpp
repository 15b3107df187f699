// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Held to      tests/methods/test_irradiance_cache.py, tests/core/records/test_record_cache.cpp

#include "records/camera_chains.h"

#include <cmath>

namespace eclat {

namespace {

/// Returns the region of a position in the picture after a number of mirrors: a square of sixteen pixels. Regions are
/// squares of the picture, because the cells of a grid in space would change if the scene were scaled or rotated. The
/// region is 0 for positions of coarser passes, which say nothing about single pixels, and for positions between
/// pixels, which exist only if records smaller than a pixel were requested.
uint32_t region_of(Vec2 at, int edge) {
    constexpr uint32_t side = 16, most_columns = 1 << 14;
    const uint32_t x = static_cast<uint32_t>(at.x), y = static_cast<uint32_t>(at.y);
    const bool between = at.x != static_cast<float>(x) + 0.5f || at.y != static_cast<float>(y) + 0.5f;
    if (between || (x % 2 == 0 && y % 2 == 0)) return 0;
    return 1 + static_cast<uint32_t>(edge) + 4 * (x / side + most_columns * (y / side));
}

/// Returns the key of the random numbers for a position in the picture. The centre of a pixel has the key of the pixel.
uint32_t key_of(Vec2 at, int edge) {
    const auto part = [](float x) { return static_cast<uint32_t>(8 * (x - std::floor(x))) ^ 4u; };
    const uint32_t parts = part(at.x) | part(at.y) << 3;
    return hash(static_cast<uint32_t>(at.x), static_cast<uint32_t>(at.y), static_cast<uint32_t>(edge) | parts << 8);
}

}  // namespace

Candidate seen_candidate(const SurfacePoint& point, const Camera& camera, float length, Vec2 at, int edge) {
    Candidate out(point, camera.pixel_size_at(length), key_of(at, edge));
    out.seen = true;
    out.region = region_of(at, edge);
    return out;
}

}  // namespace eclat
