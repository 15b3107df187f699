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

/// Light along rays, a result for each. It is called on many threads at once and counts rays in `progress`.
using Estimator = std::function<void(std::span<const PathRay> rays, std::span<PathResult> results, Progress& progress)>;

struct PointIrradiance {
    std::vector<Color> values;  // W m⁻²
    /// Counts for a cache that was read: points whose indirect light it knew, and the others, which were gathered.
    struct Served {
        size_t served = 0, gathered = 0;
    };
    std::optional<Served> served;
};

/// Irradiance at points on the side of their normals, a value for each.
using PointEstimator = std::function<PointIrradiance(std::span<const PointNormal> points,
                                                     const PointIrradianceOptions& options, Progress& progress)>;

/// What paths find without a cache: `trace_paths` for rays of a camera.
Estimator path_estimator(const World& world, PathOptions options);
/// Light samples and paths of at most `max_depth` edges, whatever the options say: `path_irradiance`.
PointEstimator path_point_estimator(const World& world, int max_depth);

}  // namespace eclat
