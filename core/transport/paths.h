// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Light paths from the eye, a batch at a time, bounce by bounce: the estimator that all integrators share.
//
// At each vertex: emission, next-event estimation, and one continued direction, combined by multiple importance
// sampling [Veach97]. Where a cache knows the indirect irradiance of a vertex, its diffuse lobes take ρ_d / π · E and
// end there; only the other lobes go on. Without a cache this is plain unbiased path tracing [Kajiya86].

#pragma once

#include <functional>
#include <optional>
#include <span>

#include "base/progress.h"
#include "sampling/sampler.h"
#include "transport/world.h"

namespace eclat {

/// Indirect irradiance at a point that a ray of length `distance` met, on the side of its shading frame; nothing where
/// the cache does not serve it.
using CachedIrradiance = std::function<std::optional<Color>(const SurfacePoint& point, float distance)>;

/// Indirect radiance that lobes which are not diffuse reflect towards `wo` (in the point's frame), for those that a cache of
/// radiance serves: it marks them in `point.bsdf`.
using CachedReflection = std::function<Color(SurfacePoint& point, Vec3 wo)>;

struct PathOptions {
    int max_depth = -1;  // edges of a path: 1 emission only, 2 direct light, −1 unlimited
    int roulette_depth = 5;
    int light_samples = 1;               // at the first vertex
    int miss_paths = 1;                  // that go on from a first vertex which the cache does not serve
    int gloss_paths = 1;                 // … from one which it does, along rough lobes
    LightSet light_set = LightSet::all;  // without the environment image, rays that escape collect it whole
    bool emission_at_first_hit = true;   // false: whoever sent the rays samples the lights itself
    Coherence coherence = Coherence::none;
    CachedIrradiance cache;
    CachedReflection reflection;
    CachedIrradiance far_cache;  // asked beyond the first vertex, where `cache` does not serve
};

struct PathRay {
    Ray ray;
    Sampler sampler;
};

/// What one path found.
struct PathResult {
    Color radiance;             // all of it
    Color direct;               // the part of paths with at most two edges
    Color albedo;               // of the first vertex
    Vec3 normal;                // of shading, at the first vertex
    float distance = infinity;  // to the first vertex
    bool behind = false;        // it lies on the back of a surface that has none
    bool cache_missed = false;  // a diffuse vertex was not served and was answered by going on
    bool gloss_cached = false;  // at the first vertex some lobe that is not diffuse was served by a cache
    bool gloss_traced = false;  // … some was not, and was traced
};

/// `out` gets one result for each ray. Counts rays in `progress`.
void trace_paths(const World& world, std::span<const PathRay> rays, const PathOptions& options,
                 std::span<PathResult> out, Progress& progress);

/// Radiance times cosine over density from one light sample at a point with normal `n`, before the shadow ray.
/// Returns the shadow ray, or nothing.
struct ShadowRay {
    Ray ray;
    Color contribution;
};
std::optional<ShadowRay> sample_irradiance(const World& world, const SurfacePoint& point, Vec3 n, LightSet set,
                                           Sampler& sampler);

}  // namespace eclat
