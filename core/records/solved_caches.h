// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The result of a solve with records, and the data that are needed only during the solve.

#pragma once

#include "records/bright_places.h"
#include "records/direct_regions.h"
#include "records/radiance_record_cache.h"
#include "records/record_cache.h"
#include "records/record_options.h"

namespace eclat {

struct SolvedCaches {
    RecordCache near, far;
    RadianceCache radiance;    // empty under irradiance caching
    size_t left_to_paths = 0;  // candidates that got no record, since none pays there
};

/// Empty caches, each with how it is read.
SolvedCaches empty_caches(const IrradianceCacheOptions& options);
/// How far records are read from where gather rays end: coarsely, and without turning, since only averages matter.
CacheOptions far_reading(const CacheOptions& near);

/// A solve under way.
struct RecordSolve {
    SolvedCaches& caches;                     // that it fills
    const RadianceTables* tables = nullptr;   // of lobes, under radiance caching
    BrightPlaces bright{};                    // at which its gathers aim
    DirectRegions direct{}, glossy_direct{};  // where records do not pay
};

}  // namespace eclat
