// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The interface of methods: estimators of radiance along camera rays and of irradiance at points. The loops over pixels and over
// points use methods only through these two types.

#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "transport/paths.h"
#include "transport/point_irradiance.h"

namespace eclat {

/// Computes the light along rays, with one result for each ray. It is called on many threads at once and counts rays in
/// `progress`.
using Estimator = std::function<void(std::span<const PathRay> rays, std::span<PathResult> results, Progress& progress)>;

struct PointIrradiance {
    std::vector<Color> values;  // W m⁻²
    /// If a cache was read: the number of points that it served, and the number of the others, which were gathered.
    struct Served {
        size_t served = 0, gathered = 0;
    };
    std::optional<Served> served;
};

/// Computes the irradiance at points on the side of their normals, with one value for each point.
using PointEstimator = std::function<PointIrradiance(std::span<const PointNormal> points,
                                                     const PointIrradianceOptions& options, Progress& progress)>;

/// Makes the estimator of path tracing without a cache, `trace_paths`, for camera rays.
Estimator path_estimator(const World& world, PathOptions options);
/// Makes the estimator of `path_irradiance` with light samples and paths of at most `max_depth` edges, whatever the
/// options are.
PointEstimator path_point_estimator(const World& world, int max_depth);

}  // namespace eclat
