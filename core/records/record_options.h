// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The options with which records are computed and read.

#pragma once

#include <cstdint>
#include <memory>

#include "hemisphere/hemisphere.h"
#include "methods/photon_map/photon_maps.h"
#include "records/record_cache.h"
#include "records/spacing.h"

namespace eclat {

class WorkExchange;

constexpr float usual_far_spacing = 0.3f;

struct IrradianceCacheOptions {
    float spacing = 0.8f;  // radius of a record, divided by the length that the metric gives
    Metric metric = Metric::occlusion;
    float least_pixels = 1;  // lower and upper bound of a record's radius, in pixels
    float largest_pixels = 40;
    int rows = 14;  // number M of rows of a gather; it has N = π M columns
    int far_rows = 9;
    int far_records = 2000;  // number of candidates of the coarse cache that gather rays read where they end
    /// Radius of a far record in units of its distance R. Larger radii blur the light that gather rays see: a value of
    /// one half darkens rooms that are lit through a gap by two per cent.
    float far_spacing = usual_far_spacing;
    /// Relative difference of records, beyond their noise, above which the worse one shrinks; infinity means never.
    float disagreement = 0.02f;
    std::shared_ptr<const PhotonMaps> far_photons;  // photons that gather rays read instead of the far cache
    bool gradient_limit = true;
    Balanced balanced = Balanced::squared;
    bool obstacle_limit = true;  // whether the least distance to separate objects limits the radius from curvature
    CacheOptions cache;
    int max_depth = -1;
    uint32_t seed = 0;
    int threads = 0;
    std::shared_ptr<const WorkExchange> exchange;  // shares the gathers of passes with other processes
};

}  // namespace eclat
