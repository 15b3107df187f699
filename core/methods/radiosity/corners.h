// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Triangles and their halves, across the middle of the longest edge.

#pragma once

#include <cstdint>

#include "scene/scene.h"

namespace eclat {

/// The corners of a triangle or of a part of one.
struct Corners {
    Vec3 v[3];

    /// Returns the corner at which the longest edge begins, the first one if edges are equally long.
    uint8_t longest() const {
        uint8_t best = 0;
        float length2 = -1;
        for (uint8_t k = 0; k < 3; ++k) {
            const float l2 = length_squared(v[(k + 1) % 3] - v[k]);
            if (l2 > length2) length2 = l2, best = k;
        }
        return best;
    }
    float longest_edge() const {
        const uint8_t k = longest();
        return length(v[(k + 1) % 3] - v[k]);
    }
    /// Returns the half that contains the corner at which edge k begins, or the other half.
    Corners half(uint8_t k, bool second) const {
        const Vec3 a = v[k], b = v[(k + 1) % 3], apex = v[(k + 2) % 3], middle = (a + b) * 0.5f;
        return second ? Corners{{middle, b, apex}} : Corners{{a, middle, apex}};
    }
    float area() const { return 0.5f * length(cross(v[1] - v[0], v[2] - v[0])); }
    /// Returns whether the halves are halves: far from the origin, corners are rounded to multiples of more than a small triangle.
    bool is_divisible() const {
        const uint8_t k = longest();
        const float least = 0.25f * area();
        return half(k, false).area() > least && half(k, true).area() > least;
    }
};

inline Corners corners_of(const Geometry& g, uint32_t triangle) {
    return {{g.vertex(triangle, 0), g.vertex(triangle, 1), g.vertex(triangle, 2)}};
}

}  // namespace eclat
