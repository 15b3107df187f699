// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The light that gather rays read at their ends, instead of going on.

#pragma once

#include "records/solved_caches.h"
#include "transport/paths.h"

namespace eclat {

/// What gather rays read where they end, instead of going on.
struct FarEnd {
    CachedIrradiance irradiance;
    CachedReflection reflection;
};

/// How gather rays read far records where they end; nothing closer than a record's own radius, where its neighbours' error
/// would be seen from corners.
CachedIrradiance read_far(const RecordCache& far);
/// How paths read radiance records.
CachedReflection read_radiance(const RadianceCache& cache, const RadianceTables& tables,
                               Reading reading = Reading::smooth);
/// Photons or far records, and with `tables` radiance records, as the caches stand; nothing where paths have a greatest
/// length, since records know of none.
FarEnd far_end(const World& world, const SolvedCaches& caches, const IrradianceCacheOptions& options,
               Progress& progress, const RadianceTables* tables = nullptr);

/// The same from photons. Borrows all.
CachedIrradiance read_far(const World& world, const PhotonMaps& photons, Progress& progress);

}  // namespace eclat
