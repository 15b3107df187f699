// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Light from small lamps that arrives by way of mirrors, metals or glass. Rays from the lit surfaces find it only by chance or
// never, and so do error probes, which are such rays. Photons always find it.

#pragma once

#include <cstdint>

#include "base/progress.h"
#include "transport/world.h"

namespace eclat {

/// Shares of the power that arrives at surfaces with diffuse lobes either straight from lights or by way of lobes that
/// are not diffuse.
struct FocusedLight {
    double by_chance = 0;  // share from objects so small, by narrow lobes, that few or no rays of a gather hit them
    double unseen = 0;  // the part of it that no camera path finds: from point lights and the like by perfect mirrors
    /// Root of the mean square error of records in what they find of the first share, relative to it: they miss most of
    /// it, an error of 1, or find it with a few rays and take it for more than it is.
    double spread = 0;
};

/// Measures the shares from some ten thousand photons, which give a share of 1 % with an error of a tenth of it.
FocusedLight focused_light(const World& world, int max_depth, uint32_t seed, int threads, Progress& progress);

}  // namespace eclat
