// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Irradiance at points given by the user, from records.

#pragma once

#include <span>
#include <vector>

#include "records/record_passes.h"
#include "transport/point_irradiance.h"

namespace eclat {

struct CachedPoints {
    std::vector<Color> irradiance;
    size_t served = 0, gathered = 0;  // numbers of points that the near cache served, and of the others
};

/// Computes indirect light from the near cache or, at points that it does not serve, from a gather that ends in the far
/// cache.
CachedPoints cached_irradiance(const World& world, std::span<const PointNormal> points, const SolvedCaches& caches,
                               const IrradianceCacheOptions& cache_options, const PointIrradianceOptions& options,
                               Progress& progress);

}  // namespace eclat
