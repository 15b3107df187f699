// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Walkers go from surface to surface as diffuse light does, whatever the surfaces reflect. Walkers that see nothing start anew
// where others have arrived. In a closed room they spread evenly over the area; on a ground that reaches far beyond it
// they are rare, even if most of them started there.

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scene/scene.h"

namespace eclat {

/// The arrival of a walker.
struct WalkerArrival {
    uint32_t side = 0;  // 2 · triangle + back
    Vec3 position;
};

/// Returns the area of each side, m²; 0 for backs that there are not.
std::vector<double> side_areas(const Geometry& geometry);

/// Returns where `walkers` walkers arrived in the steps in which they have mostly forgotten where they started. `areas` are
/// those of the sides.
std::vector<WalkerArrival> walk_surfaces(const Geometry& geometry, std::span<const double> areas, uint32_t walkers,
                                         uint32_t seed);

}  // namespace eclat
