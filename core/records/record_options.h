// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The options by which records are made and read.

#pragma once

#include <cstdint>
#include <memory>

#include "hemisphere/hemisphere.h"
#include "methods/photon_map/photon_maps.h"
#include "records/record_cache.h"
#include "records/spacing.h"

namespace eclat {

constexpr float usual_far_spacing = 0.3f;

struct IrradianceCacheOptions {
    float spacing = 0.8f;  // radius of a record in units of the length that its metric gives
    Metric metric = Metric::occlusion;
    float least_pixels = 1;  // bounds of a record's radius, in pixels
    float largest_pixels = 40;
    int rows = 14;  // M of a gather; N = π M
    int far_rows = 9;
    int far_records = 2000;  // candidates of the coarse cache that answers at the far end of gather rays
    /// Radius of a far record in units of its distance R. Coarser ones blur what gather rays see: half darkened rooms that
    /// are lit through a gap by two per cent.
    float far_spacing = usual_far_spacing;
    float disagreement =
        0.02f;  // of records, relative, beyond their noise, that shrinks the worse; infinity: none does
    std::shared_ptr<const PhotonMaps> far_photons;  // in whose irradiance gather rays end, and in no far cache then
    bool gradient_limit = true;
    Balanced balanced = Balanced::squared;
    bool obstacle_limit = true;  // of curvature's radius by the least distance to what stands apart
    CacheOptions cache;
    int max_depth = -1;
    uint32_t seed = 0;
    int threads = 0;
};

}  // namespace eclat
