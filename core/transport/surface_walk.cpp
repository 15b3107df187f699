// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Held to      tests/core/transport/test_busy_places.cpp, tests/core/methods/radiosity/test_patch_importance.cpp

#include "transport/surface_walk.h"

#include "base/frame.h"
#include "base/streams.h"
#include "sampling/sampler.h"
#include "sampling/warp.h"

namespace eclat {

namespace {

constexpr uint32_t steps = 8;
constexpr uint32_t first_counted = 3;  // step after which walkers have mostly forgotten where they started

class Walk {
  public:
    Walk(const Geometry& geometry, uint32_t walkers, uint32_t seed)
        : geometry_(geometry), count_(walkers), seed_(stream_seed(seed, Stream::patch_importance)) {}

    std::vector<WalkerArrival> run(std::span<const double> areas) {
        start(areas);
        for (uint32_t step = 0; step < steps && !walkers_.empty(); ++step) go(step);
        return std::move(arrived_);
    }

  private:
    /// One half by area, the other evenly over the sides, so that small sides beside huge ones have some.
    void start(std::span<const double> areas) {
        std::vector<uint32_t> sides;
        double sum = 0;
        for (uint32_t side = 0; side < areas.size(); ++side) {
            if (areas[side] > 0) sides.push_back(side);
            sum += areas[side];
        }
        if (sides.empty()) return;
        double before = 0;
        size_t at = 0;
        for (uint32_t i = 0; i < count_; ++i) {
            Sampler sampler(seed_, 0, i);
            size_t chosen = size_t(i) * sides.size() / count_;
            if (i % 2 == 0) {
                const double wanted = sum * i / count_;
                while (at + 1 < sides.size() && before + areas[sides[at]] <= wanted) before += areas[sides[at++]];
                chosen = at;
            }
            const Vec2 b = square_to_triangle(sampler.next_2d());
            const uint32_t triangle = sides[chosen] / 2;
            const Vec3 p0 = geometry_.vertex(triangle, 0);
            walkers_.push_back({sides[chosen], p0 + (geometry_.vertex(triangle, 1) - p0) * b.x +
                                                   (geometry_.vertex(triangle, 2) - p0) * b.y});
        }
    }

    void go(uint32_t step) {
        std::vector<Ray> rays;
        for (uint32_t i = 0; i < walkers_.size(); ++i) {
            Sampler sampler(seed_, step + 1, i);
            const auto& [side, position] = walkers_[i];
            const Vec3 front = geometry_.geometric_normal(side / 2), n = side % 2 == 0 ? front : -front;
            const float offset = geometry_.ray_offset(side / 2);
            rays.push_back(
                {position + n * offset, 0, Frame::around(n).to_world(square_to_cosine_hemisphere(sampler.next_2d()))});
        }
        std::vector<Hit> hits(rays.size());
        geometry_.rays().intersect(rays, hits);
        std::vector<WalkerArrival> arrived;
        for (size_t i = 0; i < hits.size(); ++i) {
            if (hits[i].missed()) continue;
            const uint32_t triangle = hits[i].triangle;
            const bool back = dot(geometry_.geometric_normal(triangle), rays[i].direction) > 0;
            if (back && geometry_.has_no_back(triangle)) continue;
            arrived.push_back({2 * triangle + back, rays[i].origin + rays[i].direction * hits[i].t});
        }
        if (step >= first_counted) arrived_.insert(arrived_.end(), arrived.begin(), arrived.end());
        const size_t count = arrived.size();
        if (count > 0)
            for (size_t i = count; i < count_; ++i) arrived.push_back(arrived[i % count]);
        walkers_ = std::move(arrived);
    }

    const Geometry& geometry_;
    uint32_t count_, seed_;
    std::vector<WalkerArrival> walkers_, arrived_;
};

}  // namespace

std::vector<double> side_areas(const Geometry& geometry) {
    std::vector<double> areas(2 * geometry.triangle_count(), 0);
    for (uint32_t t = 0; t < geometry.triangle_count(); ++t) {
        const Vec3 a = geometry.vertex(t, 0);
        areas[2 * t] = 0.5 * static_cast<double>(length(cross(geometry.vertex(t, 1) - a, geometry.vertex(t, 2) - a)));
        if (!geometry.has_no_back(t)) areas[2 * t + 1] = areas[2 * t];
    }
    return areas;
}

std::vector<WalkerArrival> walk_surfaces(const Geometry& geometry, std::span<const double> areas, uint32_t walkers,
                                         uint32_t seed) {
    return Walk(geometry, walkers, seed).run(areas);
}

}  // namespace eclat
