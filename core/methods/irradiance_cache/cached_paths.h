// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The estimators of irradiance and radiance caching: paths that end at surfaces whose light is read from records.

#pragma once

#include "records/record_passes.h"
#include "transport/estimator.h"

namespace eclat {

/// Makes the estimator of camera paths that read `caches` and, with `tables`, their records of radiance. All arguments
/// must outlive it. With `gather_first`, paths read them only after they have gone on from a matte vertex.
Estimator cached_path_estimator(const World& world, const SolvedCaches& caches, const RadianceTables* tables,
                                int max_depth, bool gather_first = false);

/// Makes the estimator of irradiance at points from `caches`. Points that they do not serve are gathered with
/// `cache_options`. The caches must outlive it.
PointEstimator cached_point_estimator(const World& world, const SolvedCaches& caches,
                                      const IrradianceCacheOptions& cache_options);

}  // namespace eclat
