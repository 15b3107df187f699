// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Points that are distributed evenly over all surfaces: the candidates of records without a camera.

#pragma once

#include <functional>
#include <vector>

#include "transport/world.h"

namespace eclat {

class SurfacePoints {
  public:
    struct Place {
        Hit hit;
        uint32_t key;  // of its random numbers
    };

    explicit SurfacePoints(const World& world);

    bool empty() const { return cumulative_.empty() || !(cumulative_.back() > 0); }

    /// `count` points over the area of all triangles. Point i lies at i / count of the area and, within its triangle, at the
    /// radical inverse of i: Hammersley's points, turned by random numbers of `pass`.
    std::vector<Place> spread(size_t count, uint32_t pass, uint32_t seed) const;

    /// `f(point, wo)` for each side of a place that could reflect, seen along its normal; wo in the point's frame.
    template <class F>
    void for_each_side(const Hit& hit, F&& f) const {
        const Vec3 front = world_.geometry.geometric_normal(hit.triangle);
        for (const Vec3 wo : {front, -front}) {
            const SurfacePoint point = world_.geometry.surface_point(hit, wo);
            const Vec3 local = point.frame.to_local(wo);
            if (local.z > 0) f(point, local);
        }
    }

  private:
    const World& world_;
    std::vector<double> cumulative_;  // area up to and with each triangle
};

/// Calls of `double_places`, at most: up to half a million places in all.
constexpr uint32_t most_place_passes = 13;
/// What a pass tried, and how much of it no record served.
struct PassCounts {
    size_t tried, unserved;
};
/// `pass(number, count)` with twice as many new places each time, until almost all that it tries is served.
void double_places(const std::function<PassCounts(uint32_t number, size_t count)>& pass);

}  // namespace eclat
