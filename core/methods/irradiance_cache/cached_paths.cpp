// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/irradiance_cache/cached_paths.h"

#include <utility>

#include "methods/irradiance_cache/cached_irradiance.h"
#include "methods/irradiance_cache/irradiance_cache.h"

namespace eclat {

Estimator cached_path_estimator(const World& world, const SolvedCaches& caches, const RadianceTables* tables,
                                int max_depth) {
    PathOptions options;
    options.max_depth = max_depth;
    options.light_set = LightSet::without_smooth_environment;
    options.cache = read_near(caches);
    // Far records contain light of all path lengths.
    if (max_depth < 0 && !caches.far.records().empty()) options.far_cache = read_beyond_radius(caches.far);
    options.miss_paths = cached_miss_paths;
    if (tables) options.reflection = read_radiance(caches.radiance, *tables);
    return path_estimator(world, std::move(options));
}

PointEstimator cached_point_estimator(const World& world, const SolvedCaches& caches,
                                      const IrradianceCacheOptions& cache_options) {
    return [world, &caches, cache_options](std::span<const PointNormal> points, const PointIrradianceOptions& options,
                                           Progress& progress) {
        CachedPoints found = cached_irradiance(world, points, caches, cache_options, options, progress);
        return PointIrradiance{std::move(found.irradiance), {{found.served, found.gathered}}};
    };
}

}  // namespace eclat
