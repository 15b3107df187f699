// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Irradiance at points given by the user, which need not lie on a surface.

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "transport/paths.h"

namespace eclat {

/// A point, and the unit normal on whose side light is asked for.
struct PointNormal {
    Vec3 position, normal;
};

/// As a surface without a material: rays start as far from it as the scene's float coordinates resolve.
SurfacePoint bare_point(const World& world, const PointNormal& at);

/// Light straight from lights (environment and suns included), all other light, or both.
enum class Component : uint8_t { total, direct, indirect };

struct PointIrradianceOptions {
    Component component = Component::total;
    int samples = 1024;  // of the lights, and paths where there is no cache, per point
    int max_depth = -1;  // as for pictures: 2 is direct light
    uint32_t seed = 0;
    int threads = 0;
    /// Gets a standard error for each point's light straight from lights, W m⁻² of luminance, where it is not empty; filled
    /// with 0 by the caller.
    std::span<float> direct_errors{};
};

/// Light straight from the lights of `set` at the point with that index, by light samples [W m⁻²].
Color direct_irradiance(const World& world, const SurfacePoint& point, uint32_t index, LightSet set,
                        const PointIrradianceOptions& options, Progress& progress);

/// Samples of the lights, and cosine-distributed paths for the rest, which end where `far` is known [W m⁻²]. Unbiased
/// without it.
std::vector<Color> path_irradiance(const World& world, std::span<const PointNormal> points,
                                   const PointIrradianceOptions& options, Progress& progress,
                                   const CachedIrradiance& far = {});

}  // namespace eclat
