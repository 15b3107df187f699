// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Radiance caching: indirect light on glossy surfaces from records of the radiance from all directions, together with irradiance
// caching for diffuse surfaces. Lobes that are too narrow are traced to the first vertex that a cache serves.

#pragma once

#include "tables/radiance_tables.h"
#include "methods/irradiance_cache/irradiance_cache.h"
#include "methods/irradiance_cache/solve_points.h"

namespace eclat {

struct RadianceCacheOptions {
    IrradianceCacheOptions irradiance;
    int order = 8;
    int rows = 16;         // of a gather for a radiance record
    float spacing = 0.8f;  // as that of irradiance records, for a lobe as wide as a Lambertian one
};

/// As `solve_irradiance_cache`, and the radiance records for what `camera` sees: on glossy surfaces, and on those that mirrors
/// and narrow lobes lead to.
void solve_radiance_cache(const World& world, const Camera& camera, const RadianceTables& tables,
                          const RadianceCacheOptions& options, SolvedCaches& caches, Progress& progress);

/// As `solve_everywhere`, and radiance records on all glossy surfaces, for views from any side.
void solve_radiance_everywhere(const World& world, const RadianceTables& tables, const RadianceCacheOptions& options,
                               SolvedCaches& caches, Progress& progress);

}  // namespace eclat
