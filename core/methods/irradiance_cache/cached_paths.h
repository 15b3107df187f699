// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The estimators of irradiance and radiance caching: paths that end at surfaces whose light is read from records.

#pragma once

#include "records/record_passes.h"
#include "transport/estimator.h"
#include "transport/path_guide.h"

namespace eclat {

/// Makes the estimator of camera paths that read `caches` and, with `tables`, their records of radiance. All arguments
/// must outlive it. With `guide`, paths read them only after they have gone on from a matte vertex, where it aims them, and at the
/// end of an edge that is longer than the radius of the records there.
Estimator cached_path_estimator(const World& world, const SolvedCaches& caches, const RadianceTables* tables,
                                int max_depth, const PathGuide* guide = nullptr);

/// Makes the guide of such paths from paths that begin at the near records. Its rays are counted in `progress`.
PathGuide learn_path_guide(const World& world, const SolvedCaches& caches, int max_depth, int threads,
                           Progress& progress);

/// Makes the estimator of irradiance at points from `caches`. Points that they do not serve are gathered with
/// `cache_options`. The caches must outlive it.
PointEstimator cached_point_estimator(const World& world, const SolvedCaches& caches,
                                      const IrradianceCacheOptions& cache_options);

}  // namespace eclat
