// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Pictures and irradiance from a radiosity solution.

#pragma once

#include <span>

#include "transport/point_irradiance.h"
#include "methods/radiosity/radiosity_field.h"
#include "transport/paths.h"

namespace eclat {

/// Traces paths like `trace_paths`, with light from the solution. With `gather_rays` = 0, visible surfaces show the
/// smoothly reconstructed light of their patches, and only lobes that are not diffuse are traced. Otherwise each camera
/// ray is continued by that number of diffuse rays, which end in patches, and direct light is sampled at the vertices.
/// `out` gets one result for each ray.
void trace_to_patches(const World& world, const RadiosityField& field, int gather_rays, int max_depth,
                      std::span<const PathRay> rays, std::span<PathResult> out, Progress& progress);

/// Computes the irradiance at points in W m⁻², with gather rays that end in the solution.
std::vector<Color> radiosity_irradiance(const World& world, std::span<const PointNormal> points,
                                        const RadiosityField& field, const PointIrradianceOptions& options,
                                        Progress& progress);

}  // namespace eclat
