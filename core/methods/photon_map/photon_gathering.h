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
    int gather_rays = 4;  // of a final gather, per camera ray; 0 looks at the photons directly
    int max_depth = -1;
};

/// What `trace_paths` does, with diffuse indirect light from the maps. `out` gets one result for each ray.
void trace_to_photons(const World& world, const PhotonMaps& maps, const PhotonMapOptions& options,
                      std::span<const PathRay> rays, std::span<PathResult> out, Progress& progress);

/// Irradiance at points, whose gather rays end in the maps [W m⁻²].
std::vector<Color> photon_irradiance(const World& world, std::span<const PointNormal> points, const PhotonMaps& maps,
                                     const PointIrradianceOptions& options, Progress& progress);

}  // namespace eclat
