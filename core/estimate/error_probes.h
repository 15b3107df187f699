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

/// The result of one probe.
struct Probe {
    Color value;
    Vec3 position;        // position of the first vertex that the cache served
    bool served = false;  // whether the cache served any vertex
};

/// A place is chosen by a point u of the unit square; `stream` and `place` key the random numbers.
class PixelProbes {
  public:
    /// `tables` are those of radiance caching, or null.
    PixelProbes(const World& world, const Camera& camera, const SolvedCaches& caches, const RadianceTables* tables,
                int max_depth, uint32_t seed)
        : world_(world), camera_(camera), caches_(caches), max_depth_(max_depth), seed_(seed) {
        if (tables) reflection_ = read_radiance(caches.radiance, *tables);
    }

    /// Returns the number of columns of a grid of about `count` cells.
    uint32_t columns(uint32_t count) const {
        const auto wide = std::sqrt(static_cast<float>(count) * static_cast<float>(camera_.width) /
                                    static_cast<float>(camera_.height));
        return std::clamp(static_cast<uint32_t>(wide), 1u, count);
    }
    /// Returns the radiance of the pixel, from `samples` paths that read the cache.
    Color shown(Vec2 u, uint32_t stream, uint32_t place, uint32_t samples, Progress& progress) const;
    /// Returns an unbiased estimate of the error of the radiance that the cache adds to the pixel, from `looks` camera
    /// rays with `paths` paths each.
    Probe error(Vec2 u, uint32_t stream, uint32_t place, uint32_t looks, uint32_t paths, Progress& progress) const;
    /// Returns a cheap estimate of the same error, whose paths end in the far cache.
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

/// Probes for irradiance at points, in W·m⁻².
class PointProbes {
  public:
    PointProbes(const World& world, std::span<const PointNormal> points, const SolvedCaches& caches, int max_depth,
                uint32_t seed)
        : world_(world), points_(points), caches_(caches), max_depth_(max_depth), seed_(seed) {}

    /// The order of points need not follow their positions, so only the first coordinate selects a point.
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
