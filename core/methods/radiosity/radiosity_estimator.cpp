// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/radiosity/radiosity_estimator.h"

namespace eclat {

Estimator radiosity_estimator(const World& world, const RadiosityField& field, int gather_rays, int max_depth) {
    return [world, &field, gather_rays, max_depth](std::span<const PathRay> rays, std::span<PathResult> results,
                                                   Progress& progress) {
        trace_to_patches(world, field, gather_rays, max_depth, rays, results, progress);
    };
}

PointEstimator radiosity_point_estimator(const World& world, const RadiosityField& field) {
    return [world, &field](std::span<const PointNormal> points, const PointIrradianceOptions& options,
                           Progress& progress) {
        return PointIrradiance{radiosity_irradiance(world, points, field, options, progress), {}};
    };
}

}  // namespace eclat
