// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "transport/estimator.h"

#include <utility>

namespace eclat {

Estimator path_estimator(const World& world, PathOptions options) {
    options.coherence = Coherence::camera;
    return [world, options = std::move(options)](std::span<const PathRay> rays, std::span<PathResult> results,
                                                 Progress& progress) {
        trace_paths(world, rays, options, results, progress);
    };
}

PointEstimator path_point_estimator(const World& world, int max_depth) {
    return [world, max_depth](std::span<const PointNormal> points, const PointIrradianceOptions& asked,
                              Progress& progress) {
        PointIrradianceOptions options = asked;
        options.max_depth = max_depth;
        return PointIrradiance{path_irradiance(world, points, options, progress), {}};
    };
}

}  // namespace eclat
