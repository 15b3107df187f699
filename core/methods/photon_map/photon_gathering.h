// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Photon mapping: indirect light from photons that were traced from the lights.

#pragma once

#include <span>

#include "transport/point_irradiance.h"
#include "methods/photon_map/photon_maps.h"
#include "transport/paths.h"

namespace eclat {

struct PhotonMapOptions {
    int gather_rays = 4;  // number of final gather rays per camera ray; with 0, photons are read directly
    int max_depth = -1;
};

/// Traces paths like `trace_paths`, with diffuse indirect light from the maps. `out` gets one result for each ray.
void trace_to_photons(const World& world, const PhotonMaps& maps, const PhotonMapOptions& options,
                      std::span<const PathRay> rays, std::span<PathResult> out, Progress& progress);

/// Computes the irradiance at points in W m⁻², with gather rays that end in the maps.
std::vector<Color> photon_irradiance(const World& world, std::span<const PointNormal> points, const PhotonMaps& maps,
                                     const PointIrradianceOptions& options, Progress& progress);

}  // namespace eclat
