// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/radiosity/patch_sizes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "methods/radiosity/corners.h"

namespace eclat {

namespace {

constexpr int deepest_count = 40;  // bisections, which give a million parts along a side

/// Counts the leaves of the triangle `corners`, up to `most`.
size_t count_parts(const Corners& corners, float size, size_t most, int depth) {
    if (most == 0) return 0;
    if (depth == 0 || !(corners.longest_edge() > size) || !corners.is_divisible()) return 1;
    const uint8_t k = corners.longest();
    const size_t first = count_parts(corners.half(k, false), size, most, depth - 1);
    return first >= most ? first : first + count_parts(corners.half(k, true), size, most - first, depth - 1);
}

}  // namespace

size_t count_patches(const Geometry& g, float size, size_t most, std::span<const float> scales) {
    size_t count = 0;
    for (uint32_t t = 0; t < g.triangle_count() && count < most; ++t) {
        const Corners corners = corners_of(g, t);
        if (corners.area() > 0)
            for (size_t side = 2 * size_t(t); side < 2 * size_t(t) + (g.has_no_back(t) ? 1 : 2); ++side)
                count +=
                    count_parts(corners, size * scale_of(scales, side), most - std::min(most, count), deepest_count);
    }
    return count;
}

size_t count_sides(const Geometry& geometry) {
    return count_patches(geometry, infinity, std::numeric_limits<size_t>::max());
}

double total_area(const Geometry& geometry, std::span<const float> scales) {
    double area = 0;  // in double precision, since there may be millions of triangles
    for (uint32_t t = 0; t < geometry.triangle_count(); ++t)
        for (size_t side = 2 * size_t(t); side < 2 * size_t(t) + (geometry.has_no_back(t) ? 1 : 2); ++side)
            area +=
                static_cast<double>(corners_of(geometry, t).area()) / sqr(static_cast<double>(scale_of(scales, side)));
    return area;
}

float patch_size_for(const Geometry& geometry, size_t count, std::span<const float> scales) {
    constexpr int steps = 24;
    const double area = total_area(geometry, scales);
    if (!(area > 0) || count_patches(geometry, infinity, count) >= count) return infinity;
    // Halves of a square of side s have the area s² / 2 and the longest edge √2 s. Slender triangles need more.
    float high = static_cast<float>(8 * std::sqrt(area / static_cast<double>(count)));
    float low = high / 64;
    while (count_patches(geometry, high, count, scales) >= count) high *= 2;
    for (int i = 0; i < steps; ++i) {
        const float middle = std::sqrt(low * high);
        (count_patches(geometry, middle, count, scales) >= count ? low : high) = middle;
    }
    return high;
}

}  // namespace eclat
