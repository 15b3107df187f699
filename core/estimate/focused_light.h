// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Light from small lamps that arrives by way of mirrors, metals or glass. Rays from the lit surfaces find it only by chance or
// never, and so do error probes, which are such rays. Photons always find it.

#pragma once

#include <cstdint>

#include "base/progress.h"
#include "transport/world.h"

namespace eclat {

/// Power that arrives at surfaces with diffuse lobes, in relation to all that arrives there straight from lights or by lobes
/// that are not diffuse.
struct FocusedLight {
    double by_chance = 0;  // by narrow lobes from what looks so small that few rays of a gather meet it, or none
    double unseen =
        0;  // the part of it that no ray from the eye ever finds: of points and the like, by perfect mirrors
};

/// From some ten thousand photons: a share of a hundredth is known to a tenth of itself.
FocusedLight focused_light(const World& world, int max_depth, uint32_t seed, int threads, Progress& progress);

}  // namespace eclat
