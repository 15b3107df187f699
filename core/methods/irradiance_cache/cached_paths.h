// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The estimators of irradiance and radiance caching: paths that end at surfaces whose light is read from records.

#pragma once

#include "records/record_passes.h"
#include "transport/estimator.h"

namespace eclat {

/// Paths of a camera that read `caches`, and with `tables` their records of radiance. All that is given is borrowed.
Estimator cached_path_estimator(const World& world, const SolvedCaches& caches, const RadianceTables* tables,
                                int max_depth);

/// Irradiance at points from `caches`; what they do not serve is gathered by `cache_options`. Borrows the caches.
PointEstimator cached_point_estimator(const World& world, const SolvedCaches& caches,
                                      const IrradianceCacheOptions& cache_options);

}  // namespace eclat
