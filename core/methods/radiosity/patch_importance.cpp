// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Walkers (transport/surface_walk.h) tell how much light each side exchanges with others.
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

#include "transport/surface_walk.h"

namespace eclat {

namespace {

constexpr uint32_t walkers = 8192;
constexpr float least_density = 0.25f;  // in units of the usual one, at which patches are of the usual size
// If the sides that exchange hardly any light have less than so many times the area of the others, all keep their patches: lamps
// may light them, as the walls of a house from outside and the yard around it. Set between a yard, which has a few times the area
// of its house, and a ground to the horizon, which has ten thousand times; it is not tuned further.
constexpr double much_area = 100;

}  // namespace

std::vector<float> patch_scales(const Geometry& geometry, uint32_t seed) {
    const std::vector<double> areas = side_areas(geometry);
    std::vector<uint32_t> arrived(areas.size(), 0);
    for (const WalkerArrival& arrival : walk_surfaces(geometry, areas, walkers, seed)) ++arrived[arrival.side];
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
