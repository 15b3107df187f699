// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Walkers go from surface to surface as diffuse light does, whatever the surfaces reflect. Walkers that see nothing start anew
// where others have arrived. In a closed room they spread evenly over the area; on a ground that reaches far beyond it
// they are rare, even if most of them started there.
//
// Symbol   name here    meaning                                                          unit
//   a      arrived      walkers that arrived at a side, 1 added since none is never sure  1
//   D      density      a over the side's area                                           m⁻²
//   D_r    usual        mean of D, as walkers see it: Σ (a − 1) D / Σ a                  m⁻²
//   s      scales       how much longer patches of a side may be: √(¼ D_r / D), at least 1  1
//
// The number of patches of a side then goes with the light that it exchanges, not with its area. One part in four is what a
// side in a corner of a room may be visited less.
//
// Held to      tests/core/methods/radiosity/test_patch_importance.cpp

#include "methods/radiosity/patch_importance.h"

#include <algorithm>
#include <cmath>

#include "base/frame.h"
#include "base/streams.h"
#include "sampling/discrete.h"
#include "sampling/sampler.h"
#include "sampling/warp.h"

namespace eclat {

namespace {

constexpr uint32_t walkers = 8192;
constexpr uint32_t steps = 8;
constexpr uint32_t first_counted = 3;   // step after which walkers have mostly forgotten where they started
constexpr float least_density = 0.25f;  // in units of the usual one, at which patches are of the usual size
// If the sides that exchange hardly any light have less than so many times the area of the others, all keep their patches: lamps
// may light them, as the walls of a house from outside and the yard around it. Set between a yard, which has a few times the area
// of its house, and a ground to the horizon, which has ten thousand times; it is not tuned further.
constexpr double much_area = 100;

struct Walker {
    uint32_t side = 0;
    Vec3 position;
};

class Walk {
  public:
    Walk(const Geometry& geometry, uint32_t seed)
        : geometry_(geometry),
          seed_(stream_seed(seed, Stream::patch_importance)),
          arrived_(2 * geometry.triangle_count(), 0) {}

    /// Walkers that arrived at each side.
    std::vector<uint32_t> run(std::span<const double> areas) {
        start(areas);
        for (uint32_t step = 0; step < steps && !walkers_.empty(); ++step) go(step);
        return std::move(arrived_);
    }

  private:
    /// One half by area, the other evenly over the sides, so that small sides beside huge ones have some.
    void start(std::span<const double> areas) {
        std::vector<uint32_t> sides;
        std::vector<double> weights;
        for (uint32_t side = 0; side < areas.size(); ++side)
            if (areas[side] > 0) sides.push_back(side), weights.push_back(areas[side]);
        if (sides.empty()) return;
        double sum = 0;
        for (const double w : weights) sum += w;
        double before = 0;
        size_t at = 0;
        for (uint32_t i = 0; i < walkers; ++i) {
            Sampler sampler(seed_, 0, i);
            size_t chosen = size_t(i) * sides.size() / walkers;
            if (i % 2 == 0) {
                const double wanted = sum * i / walkers;
                while (at + 1 < sides.size() && before + weights[at] <= wanted) before += weights[at++];
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
        std::vector<Walker> arrived;
        for (size_t i = 0; i < hits.size(); ++i) {
            if (hits[i].missed()) continue;
            const uint32_t triangle = hits[i].triangle;
            const bool back = dot(geometry_.geometric_normal(triangle), rays[i].direction) > 0;
            if (back && geometry_.has_no_back(triangle)) continue;
            arrived.push_back({2 * triangle + back, rays[i].origin + rays[i].direction * hits[i].t});
            if (step >= first_counted) ++arrived_[arrived.back().side];
        }
        const size_t count = arrived.size();
        if (count > 0)
            for (size_t i = count; i < walkers; ++i) arrived.push_back(arrived[i % count]);
        walkers_ = std::move(arrived);
    }

    const Geometry& geometry_;
    uint32_t seed_;
    std::vector<Walker> walkers_;
    std::vector<uint32_t> arrived_;
};

}  // namespace

std::vector<float> patch_scales(const Geometry& geometry, uint32_t seed) {
    std::vector<double> areas(2 * geometry.triangle_count(), 0);
    for (uint32_t t = 0; t < geometry.triangle_count(); ++t) {
        const Vec3 a = geometry.vertex(t, 0);
        areas[2 * t] = 0.5 * static_cast<double>(length(cross(geometry.vertex(t, 1) - a, geometry.vertex(t, 2) - a)));
        if (!geometry.has_no_back(t)) areas[2 * t + 1] = areas[2 * t];
    }
    const std::vector<uint32_t> arrived = Walk(geometry, seed).run(areas);
    double all = 0, usual = 0;
    for (size_t side = 0; side < areas.size(); ++side) {
        if (!(areas[side] > 0)) continue;
        all += arrived[side];
        // The product of two different walkers: one alone says nothing of how dense they are on a tiny side.
        if (arrived[side] > 1) usual += arrived[side] * (arrived[side] - 1.0) / areas[side];
    }
    if (!(usual > 0)) return {};
    usual /= all;
    std::vector<float> scales(areas.size(), 1);
    double near = 0, far = 0;
    for (size_t side = 0; side < areas.size(); ++side) {
        if (!(areas[side] > 0)) continue;
        const double density = (arrived[side] + 1) / areas[side];
        if (density < least_density * usual)
            scales[side] = static_cast<float>(std::sqrt(least_density * usual / density));
        (scales[side] > 1 ? far : near) += areas[side];
    }
    return far > much_area * near ? scales : std::vector<float>{};
}

}  // namespace eclat
