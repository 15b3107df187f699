// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Points that are distributed evenly over all surfaces: the candidates of records without a camera.

#pragma once

#include <functional>
#include <vector>

#include "transport/world.h"

namespace eclat {

/// The points [first, end) of the `count` points of a pass.
struct PlacesPart {
    uint32_t pass;
    size_t count, first, end;
};

class SurfacePoints {
  public:
    struct Place {
        Hit hit;
        uint32_t key;  // key of the random numbers
    };

    explicit SurfacePoints(const World& world);

    bool empty() const { return cumulative_.empty() || !(cumulative_.back() > 0); }

    /// Returns `count` points, evenly distributed over the area of all triangles. Point i is at the fraction i / count
    /// of the cumulative area and, within its triangle, at the radical inverse of i. These are Hammersley points,
    /// shifted by random numbers of `pass`.
    std::vector<Place> spread(size_t count, uint32_t pass, uint32_t seed) const {
        return spread({pass, count, 0, count}, seed);
    }
    /// Returns the points [first, end) of these.
    std::vector<Place> spread(const PlacesPart& part, uint32_t seed) const;

    /// Calls `f(point, wo)` for each side of a surface point that may reflect, as seen along its normal. `wo` is in the
    /// frame of the point.
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
    std::vector<double> cumulative_;  // sum of the areas up to and including each triangle
};

/// The greatest number of passes of `double_places`, which have half a million points in all.
constexpr uint32_t most_place_passes = 13;
/// The number of points that a pass tried, and the number of those that no record served.
struct PassCounts {
    size_t tried, unserved;
};
/// Returns the number of points of a pass.
size_t places_of_pass(uint32_t number);
/// Returns whether a pass found so few unserved points that no further pass is needed.
bool places_suffice(uint32_t number, PassCounts found);
/// Calls `pass(number, count)` with twice as many new points each time, until almost all points that it tries are
/// served.
void double_places(const std::function<PassCounts(uint32_t number, size_t count)>& pass);

}  // namespace eclat
