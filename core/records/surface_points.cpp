// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Held to      tests/methods/test_solve_points.py

#include "records/surface_points.h"

#include <algorithm>
#include <cmath>

#include "sampling/sampler.h"

namespace eclat {

namespace {}  // namespace

SurfacePoints::SurfacePoints(const World& world) : world_(world) {
    const Geometry& g = world.geometry;
    double sum = 0;  // in double precision, since there may be millions of triangles
    for (uint32_t t = 0; t < g.triangle_count(); ++t) {
        const Vec3 a = g.vertex(t, 0);
        sum += 0.5 * length(cross(g.vertex(t, 1) - a, g.vertex(t, 2) - a));
        cumulative_.push_back(sum);
    }
}

std::vector<SurfacePoints::Place> SurfacePoints::spread(const PlacesPart& part, uint32_t seed) const {
    const uint32_t key = hash(stream_seed(seed, Stream::surface_points), part.pass);
    const double shift = to_unit_float(hash(key, 0));
    std::vector<Place> out;
    for (size_t i = part.first; i < part.end; ++i) {
        const double at = (static_cast<double>(i) + shift) / static_cast<double>(part.count) * cumulative_.back();
        const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, at);
        const auto triangle = static_cast<uint32_t>(found - cumulative_.begin());
        const double below = triangle == 0 ? 0 : cumulative_[triangle - 1];
        const double area = *found - below;  // 0 only if rounding selects a last triangle without area
        const auto within = area > 0 ? static_cast<float>(clamp((at - below) / area, 0.0, 1.0)) : 0.0f;
        const float across = to_unit_float(reverse_bits(static_cast<uint32_t>(i)) ^ hash(key, 1));
        const float s = std::sqrt(within);
        out.push_back({{triangle, 0, s * (1 - across), s * across}, hash(key, static_cast<uint32_t>(i))});
    }
    return out;
}

size_t places_of_pass(uint32_t number) {
    constexpr size_t first_pass = 64;
    return first_pass << number;
}

bool places_suffice(uint32_t number, PassCounts found) {
    constexpr uint32_t least_passes = 7;    // 4096 points: fewer would not be representative
    constexpr double unserved_part = 2e-3;  // share of a pass; paths take fewer rays than records for so few points
    const double few = unserved_part * static_cast<double>(found.tried);
    return number + 1 >= least_passes && static_cast<double>(found.unserved) < few;
}

void double_places(const std::function<PassCounts(uint32_t number, size_t count)>& pass) {
    for (uint32_t number = 0; number < most_place_passes; ++number)
        if (places_suffice(number, pass(number, places_of_pass(number)))) break;
}

}  // namespace eclat
