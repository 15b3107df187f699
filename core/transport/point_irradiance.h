// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Irradiance at points given by the user, which need not lie on a surface.

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "transport/paths.h"

namespace eclat {

/// A point, and the unit normal of the side on which the light arrives.
struct PointNormal {
    Vec3 position, normal;
};

/// Makes a surface point without a material. Rays start at an offset that the float coordinates of the scene resolve.
SurfacePoint bare_point(const World& world, const PointNormal& at);

/// Light straight from lights (environment and suns included), all other light, or both.
enum class Component : uint8_t { total, direct, indirect };

struct PointIrradianceOptions {
    Component component = Component::total;
    int samples = 1024;  // number of light samples, and of paths without a cache, per point
    int max_depth = -1;  // greatest number of edges as for pictures: 2 is direct light
    uint32_t seed = 0;
    int threads = 0;
    uint32_t first =
        0;  // index of the first point, if the points are a range of more; random numbers depend on indices
    /// If this is not empty, it gets the standard error of the luminance of direct light at each point, in W m⁻². The
    /// caller fills it with 0.
    std::span<float> direct_errors{};
};

/// Computes the direct light of the lights of `set` at the point with that index in the range, from light samples, in W m⁻².
Color direct_irradiance(const World& world, const SurfacePoint& point, uint32_t index, LightSet set,
                        const PointIrradianceOptions& options, Progress& progress);

/// Computes the irradiance in W m⁻² from light samples and cosine-distributed paths, which end at points for which
/// `far` gives the light. Without `far` it is unbiased.
std::vector<Color> path_irradiance(const World& world, std::span<const PointNormal> points,
                                   const PointIrradianceOptions& options, Progress& progress,
                                   const CachedIrradiance& far = {});

}  // namespace eclat
