// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Pictures and irradiance from a radiosity solution.

#pragma once

#include <span>

#include "transport/point_irradiance.h"
#include "methods/radiosity/radiosity_field.h"
#include "transport/paths.h"

namespace eclat {

/// What `trace_paths` does, by the solution. With `gather_rays` = 0 surfaces that the camera sees show their patches, smoothly
/// reconstructed, and only what is not diffuse is traced. Else that many diffuse rays a camera ray end in them, and light
/// straight from lights is sampled where a path meets a surface. `out` gets one result for each ray.
void trace_to_patches(const World& world, const RadiosityField& field, int gather_rays, int max_depth,
                      std::span<const PathRay> rays, std::span<PathResult> out, Progress& progress);

/// Irradiance at points, whose gather rays end in the solution [W m⁻²].
std::vector<Color> radiosity_irradiance(const World& world, std::span<const PointNormal> points,
                                        const RadiosityField& field, const PointIrradianceOptions& options,
                                        Progress& progress);

}  // namespace eclat
