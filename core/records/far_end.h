// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The light that gather rays read where they hit a surface, instead of continuing.

#pragma once

#include "records/far_cells.h"
#include "records/solved_caches.h"
#include "transport/paths.h"

namespace eclat {

/// The source of the light that gather rays read where they end.
struct FarEnd {
    CachedIrradiance irradiance;
    CachedReflection reflection;
    bool wants_samples = false;  // whether gathers keep what paths find where nothing was read
};

/// Makes the reader by which gather rays, and paths of a final gather, read records where they end. It returns nothing for rays
/// that are shorter than the radius of the records, because the error of the records would be visible in corners.
CachedIrradiance read_beyond_radius(const RecordCache& records);
/// Makes the reader by which paths read records of radiance.
CachedReflection read_radiance(const RadianceCache& cache, const RadianceTables& tables,
                               Reading reading = Reading::smooth);
/// Makes the far end from the current state of the caches: photons, or far records and, where none serves, `cells`, and where
/// these know nothing, near records; and, with `tables`, records of radiance. Without `cells` no near records are read: a little of
/// the light outside would reach points inside a solid. It is empty if the number of edges of paths is limited, because records contain
/// light of all path lengths.
FarEnd far_end(const World& world, const SolvedCaches& caches, const IrradianceCacheOptions& options,
               Progress& progress, const RadianceTables* tables = nullptr, const FarCells* cells = nullptr);

/// Makes the far end from photons. All arguments must outlive it.
CachedIrradiance read_far(const World& world, const PhotonMaps& photons, Progress& progress);

}  // namespace eclat
