// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Irradiance caching: indirect light on diffuse surfaces, computed at few points, interpolated between them.

#pragma once

#include <cstdint>
#include <span>

#include "cache/irradiance_cache.h"
#include "scene/camera.h"
#include "transport/paths.h"

namespace eclat {

enum class Spacing : uint8_t { minimum, harmonic };

struct IrradianceCacheOptions {
    float spacing = 0.4f;            // radius of a record in units of its distance R
    Spacing distance = Spacing::minimum;
    float least_pixels = 2.5f;       // bounds of a record's radius, in pixels
    float largest_pixels = 40;
    int rows = 18;                   // M of a gather; N = π M
    int far_rows = 9;
    int far_records = 2000;          // candidates of the coarse cache that answers at the far end of gather rays
    bool gradient_limit = true;
    CacheOptions cache;
    int max_depth = -1;
    uint32_t seed = 0;
    int threads = 0;
};

struct SolvedCaches {
    RecordCache near, far;
};

/// Where a record could be wanted.
struct Candidate {
    Vec3 position;
    Vec3 normal;          // geometric, on the side that is shaded
    Vec3 shading_normal;
    float offset = 0;     // how far rays must start from the surface
    float footprint = 0;  // width of a pixel there

    Candidate() = default;
    Candidate(const SurfacePoint& point, float footprint)
        : position(point.position), normal(point.normal_towards_shading()), shading_normal(point.frame.n),
          offset(point.offset), footprint(footprint) {}

    /// A ray that leaves into the hemisphere around `normal`.
    Ray ray(Vec3 direction) const { return {position + normal * offset, 0, direction}; }
};

/// Fills both caches for what `camera` sees. `progress` counts passes.
SolvedCaches solve_irradiance_cache(const World& world, const Camera& camera, const IrradianceCacheOptions& options,
                                    Progress& progress);

/// How paths read the cache: `near` at vertices seen from the camera.
CachedIrradiance read_near(const SolvedCaches& caches);

/// Gathers indirect irradiance at points, ending gather rays in the far cache.
std::vector<IrradianceRecord> gather_records(const World& world, std::span<const Candidate> candidates,
                                             const RecordCache& far, const IrradianceCacheOptions& options,
                                             uint32_t stream, int rows, Progress& progress);

/// Diffuse points that pixels see, at pixel centres (x, y), after mirrors and glossy bounces where there are any.
std::vector<Candidate> camera_candidates(const World& world, const Camera& camera, std::span<const Vec2> pixels,
                                         const IrradianceCacheOptions& options, Progress& progress);

}  // namespace eclat
