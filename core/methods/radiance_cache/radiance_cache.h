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
    int rows = 16;         // number of rows of a gather for a radiance record
    float spacing = 0.8f;  // spacing as for irradiance records, for a lobe as wide as a Lambertian one
};

/// Returns the options with which radiance records are gathered and spaced.
IrradianceCacheOptions radiance_gathering(const RadianceCacheOptions& options);

// These are the steps of the solves.

/// What all passes of radiance records share.
struct RadianceWork {
    const RadianceTables& tables;
    const RadianceCacheOptions& options;
    const RadianceProjection& projection;
};
/// Performs one pass over the pixels of `part`.
void add_radiance_of_lattice(const World& world, const Camera& camera, const LatticePart& part,
                             const RadianceWork& work, RecordSolve& solve, Progress& progress);
/// Makes radiance records at some points of a pass over all surfaces.
PassCounts add_radiance_at_places(const World& world, const SurfacePoints& surface, const PlacesPart& part,
                                  const RadianceWork& work, RecordSolve& solve, Progress& progress);
/// Marks the lobes that radiance records may serve: the surfaces that such a lobe reflects need no irradiance records.
MarkCached mark_lobes(const RadianceTables& tables);

/// Does the work of `solve_irradiance_cache`, and makes radiance records on the glossy surfaces that `cameras` see
/// directly or by way of mirrors and narrow lobes.
void solve_radiance_cache(const World& world, Cameras cameras, const RadianceTables& tables,
                          const RadianceCacheOptions& options, SolvedCaches& caches, Progress& progress);

/// Does the work of `solve_everywhere`, and makes radiance records on all glossy surfaces for all view directions.
void solve_radiance_everywhere(const World& world, const RadianceTables& tables, const RadianceCacheOptions& options,
                               SolvedCaches& caches, Progress& progress);

}  // namespace eclat
