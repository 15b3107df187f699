// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The error of the light of a cache at the points where it is read, measured by path-traced gathers that never end in it.

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "records/record_passes.h"
#include "scene/camera.h"
#include "transport/point_irradiance.h"

namespace eclat {

struct ErrorCheck {
    uint64_t rays = 0;  // to spend, about: whole rounds are done until they are used up
    double wanted = 0;  // relative error: rounds end early once it is known to lie below, or surely above
    int max_depth = -1;
    uint32_t seed = 0;
    int threads = 0;
};

/// Where a round looked, and what it found there.
struct ErrorPlace {
    Vec3 position;
    float squared = 0;  // relative squared error, unbiased: below 0 by chance
};

struct ErrorEstimate {
    double squared = 0;    // mean relative squared error, unbiased: below 0 by chance where the error is small
    double deviation = 0;  // standard error of `squared`
    double missed = 0;     // part of the places where no record serves anything, or nothing diffuse is seen
    uint64_t paths = 0;    // of all gathers
    std::vector<ErrorPlace> places;
};

/// The error of the indirect light that `camera` sees, over all pixels; with the `tables` of radiance caching that of
/// gloss too.
ErrorEstimate estimate_error(const World& world, const Camera& camera, const SolvedCaches& caches,
                             const RadianceTables* tables, const ErrorCheck& check, Progress& progress);
/// The error of indirect irradiance at points.
ErrorEstimate estimate_error(const World& world, std::span<const PointNormal> points, const SolvedCaches& caches,
                             const ErrorCheck& check, Progress& progress);

}  // namespace eclat
