// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The error of the light of a cache at the points where it is read, measured by path-traced gathers that never end in it.

#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "base/work_exchange.h"
#include "records/record_passes.h"
#include "scene/camera.h"
#include "transport/point_irradiance.h"

namespace eclat {

struct ErrorCheck {
    uint64_t rays = 0;  // approximate number of rays to use; rounds are always completed
    double wanted = 0;  // relative error; rounds end as soon as the estimate is clearly below or above it
    int max_depth = -1;
    uint32_t seed = 0;
    int threads = 0;
    std::shared_ptr<const WorkExchange> exchange;  // shares the probes with other processes
};

/// A place that a round examined, and the result there.
struct ErrorPlace {
    Vec3 position;
    float squared = 0;  // relative squared error; it is unbiased, so noise can make it negative
};

struct ErrorEstimate {
    double squared = 0;    // mean relative squared error; it is unbiased, so noise can make it negative
    double deviation = 0;  // standard error of `squared`
    double missed = 0;     // share of the places at which no record is used or no diffuse surface is seen
    uint64_t paths = 0;    // number of paths of all gathers
    std::vector<ErrorPlace> places;
};

/// Estimates the error of the indirect light that `camera` sees, over all pixels. With the `tables` of radiance caching
/// it includes glossy reflections.
ErrorEstimate estimate_error(const World& world, const Camera& camera, const SolvedCaches& caches,
                             const RadianceTables* tables, const ErrorCheck& check, Progress& progress);
/// Estimates the error of indirect irradiance at points.
ErrorEstimate estimate_error(const World& world, std::span<const PointNormal> points, const SolvedCaches& caches,
                             const ErrorCheck& check, Progress& progress);

}  // namespace eclat
