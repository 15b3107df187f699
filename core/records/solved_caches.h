// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The result of a solve with records, and the data that are needed only during the solve.

#pragma once

#include "records/bright_places.h"
#include "records/direct_regions.h"
#include "records/far_cells.h"
#include "records/radiance_record_cache.h"
#include "records/record_cache.h"
#include "records/record_options.h"

namespace eclat {

struct SolvedCaches {
    RecordCache near, far;
    RadianceCache radiance;    // empty for irradiance caching
    size_t left_to_paths = 0;  // number of candidates without a record, because paths take fewer rays there
};

/// Makes empty caches with their settings for reading.
SolvedCaches empty_caches(const IrradianceCacheOptions& options);
/// Settings with which gather rays read far records: coarsely and without rotation gradients, because only averages
/// matter.
CacheOptions far_reading(const CacheOptions& near);

/// The data of a solve that is in progress.
struct RecordSolve {
    SolvedCaches& caches;                     // caches that the solve fills
    const RadianceTables* tables = nullptr;   // tables of lobes, for radiance caching
    BrightPlaces bright{};                    // places at which gathers aim rays
    FarCells cells{};                         // what paths of gathers found where no far record serves
    bool read_cells = false;                  // whether gathers end there, see records/far_cells.cpp
    DirectRegions direct{}, glossy_direct{};  // regions without records
    float usual_footprint = 0;                // of the first pass of near records, m, or 0 before it
};

}  // namespace eclat
