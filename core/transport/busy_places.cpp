// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Walkers (surface_walk.h) gather where surfaces exchange light. Around the densest of them a ball is doubled until there are
// hardly more walkers within twice its radius; that is a place, and the others are searched for further places.
//
// Held to      tests/core/transport/test_busy_places.cpp

#include "transport/busy_places.h"

#include <algorithm>

#include "transport/surface_walk.h"

namespace eclat {

namespace {

constexpr uint32_t walkers = 256;  // about five times as many arrivals
constexpr size_t most_places = 8;
constexpr size_t asked = 32;            // walkers of which the densest is looked for
constexpr float few_more = 1.1f;        // ratio of numbers of walkers at which a ball is not doubled further
constexpr float least_part = 1 / 16.f;  // of all walkers, of which a place consists
// Walkers seldom come to the very corners.
constexpr float margin = 1.25f;
// If a place is at least this part of the scene, the scene is one place: discs as wide as the scene waste few photons then.
constexpr float wide = 0.25f;

size_t count_within(const std::vector<Vec3>& points, Vec3 center, float radius) {
    return static_cast<size_t>(
        std::ranges::count_if(points, [&](Vec3 p) { return length_squared(p - center) <= sqr(radius); }));
}

/// Returns the radius around a point that contains an eighth of the points.
float crowded_radius(const std::vector<Vec3>& points, Vec3 center) {
    std::vector<float> distances;
    for (const Vec3 p : points) distances.push_back(length(p - center));
    const auto eighth = distances.begin() + static_cast<ptrdiff_t>(points.size() / 8);
    std::nth_element(distances.begin(), eighth, distances.end());
    return *eighth;
}

Ball around(const std::vector<Vec3>& points, Vec3 center, float radius) {
    Vec3 low = center, high = center;
    for (const Vec3 p : points) {
        if (!(length_squared(p - center) <= sqr(radius))) continue;
        low = min(low, p);
        high = max(high, p);
    }
    return {(low + high) * 0.5f, margin * 0.5f * length(high - low)};
}

}  // namespace

std::vector<Ball> busy_places(const Geometry& geometry) {
    std::vector<Vec3> points;
    for (const WalkerArrival& arrival : walk_surfaces(geometry, side_areas(geometry), walkers, 0))
        points.push_back(arrival.position);
    const float whole = geometry.radius();
    const size_t least = std::max<size_t>(16, static_cast<size_t>(least_part * static_cast<float>(points.size())));
    std::vector<Ball> places;
    while (points.size() >= least && places.size() < most_places) {
        Vec3 center;
        float radius = infinity;
        for (size_t i = 0; i < asked; ++i) {
            const Vec3 p = points[i * points.size() / asked];
            const float r = crowded_radius(points, p);
            if (r < radius) radius = r, center = p;
        }
        radius = std::max(radius, 1e-6f * whole);
        while (static_cast<float>(count_within(points, center, 2 * radius)) >
               few_more * static_cast<float>(count_within(points, center, radius)))
            radius *= 2;
        const Ball ball = around(points, center, radius);
        if (!(ball.radius > 0) || ball.radius >= wide * whole) return {};
        places.push_back(ball);
        std::erase_if(points, [&](Vec3 p) { return length_squared(p - center) <= sqr(2 * radius); });
    }
    return places;
}

}  // namespace eclat
