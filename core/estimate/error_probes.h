// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The points at which the error of a cache can be measured, of pixels or given by the user. A probe computes the light that is
// shown at a point, and its error.

#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "transport/point_irradiance.h"
#include "methods/radiance_cache/radiance_cache.h"

namespace eclat {

/// What one probe found.
struct Probe {
    Color value;
    Vec3 position;        // of the first vertex that the cache served
    bool served = false;  // any
};

/// A place is chosen by a point u of the unit square; `stream` and `place` key the random numbers.
class PixelProbes {
  public:
    /// `tables`: of radiance caching, else null.
    PixelProbes(const World& world, const Camera& camera, const SolvedCaches& caches, const RadianceTables* tables,
                int max_depth, uint32_t seed)
        : world_(world), camera_(camera), caches_(caches), max_depth_(max_depth), seed_(seed) {
        if (tables) reflection_ = read_radiance(caches.radiance, *tables);
    }

    /// Columns of a grid of about `count` cells.
    uint32_t columns(uint32_t count) const {
        const auto wide = std::sqrt(static_cast<float>(count) * static_cast<float>(camera_.width) /
                                    static_cast<float>(camera_.height));
        return std::clamp(static_cast<uint32_t>(wide), 1u, count);
    }
    /// Radiance of the pixel, by `samples` paths that read the cache.
    Color shown(Vec2 u, uint32_t stream, uint32_t place, uint32_t samples, Progress& progress) const;
    /// Unbiased estimate of the radiance that the cache adds to the pixel, less what is true, from `looks` camera rays
    /// with `paths` paths each.
    Probe error(Vec2 u, uint32_t stream, uint32_t place, uint32_t looks, uint32_t paths, Progress& progress) const;
    /// Cheap guess of the same, whose paths end in the far cache.
    Probe guess(Vec2 u, uint32_t place, uint32_t paths, Progress& progress) const;

  private:
    struct Served;
    Probe compared(Vec2 u, uint32_t stream, uint32_t place, uint32_t looks, uint32_t paths, const CachedIrradiance& end,
                   Progress& progress) const;
    Ray ray(Vec2 u, Sampler& sampler) const;
    std::vector<Served> served_vertices(const Ray& first, const Sampler& sampler, Progress& progress) const;

    const World& world_;
    const Camera& camera_;
    const SolvedCaches& caches_;
    CachedReflection reflection_;
    int max_depth_;
    uint32_t seed_;
};

/// The same for irradiance at points, W·m⁻².
class PointProbes {
  public:
    PointProbes(const World& world, std::span<const PointNormal> points, const SolvedCaches& caches, int max_depth,
                uint32_t seed)
        : world_(world), points_(points), caches_(caches), max_depth_(max_depth), seed_(seed) {}

    /// Points have no order in space that could be relied upon: the first coordinate alone names one.
    uint32_t columns(uint32_t count) const { return count; }
    Color shown(Vec2 u, uint32_t stream, uint32_t place, uint32_t samples, Progress& progress) const;
    Probe error(Vec2 u, uint32_t stream, uint32_t place, uint32_t looks, uint32_t paths, Progress& progress) const;
    Probe guess(Vec2 u, uint32_t place, uint32_t paths, Progress& progress) const;

  private:
    Probe compared(Vec2 u, uint32_t stream, uint32_t place, uint32_t paths, const CachedIrradiance& end,
                   Progress& progress) const;
    const PointNormal& at(Vec2 u) const;
    std::optional<Color> read(const PointNormal& point) const;

    const World& world_;
    std::span<const PointNormal> points_;
    const SolvedCaches& caches_;
    int max_depth_;
    uint32_t seed_;
};

}  // namespace eclat
