// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Paths from the camera, traced in batches, bounce by bounce: the estimator that all methods share.
//
// At each vertex: emission, next-event estimation, and one continued direction, combined by multiple importance
// sampling [Veach97]. Where a cache knows the indirect irradiance of a vertex, its diffuse lobes take ρ_d / π · E and
// end there; only the other lobes go on. Without a cache this is plain unbiased path tracing [Kajiya86].
//
// Symbol   name here           meaning
//   x_k      vertices[i]         the k-th vertex of path i, x_0 being where its ray begins
//   f_k      sample.weight       BSDF at x_k times cosine over the density p_k of the direction in which the path goes on
//   q_k      survival            chance to go on after x_k, 1 before roulette begins
//   n_k      paths_from          paths that go on from x_k, each with a share 1 / n_k
//   T_k      path.throughput     f_1 … f_{k−1} / (q_1 … q_{k−1} n_1 … n_{k−1}), T_1 = 1
//
// T_k estimates how much of the radiance that x_k sends back along the path reaches x_0: the sum over all paths of
// T_k · L(x_k → x_{k−1}) has the expectation ∫ … ∫ f_1 … f_{k−1} L(x_k → x_{k−1}) over all directions of k − 1 scatterings,
// which is the radiance at x_0 of light that left its source, or a cached vertex, at x_k. The result is the sum over k of
// T_k times what x_k emits (weighted against light sampling at x_{k−1}), times what it reflects of sampled lights, and times
// what caches know of its lobes.

#pragma once

#include <functional>
#include <optional>
#include <span>

#include "base/progress.h"
#include "sampling/sampler.h"
#include "transport/direct_light.h"
#include "transport/vertex.h"
#include "transport/world.h"

namespace eclat {

/// Indirect irradiance at a point that a ray of length `distance` met, on the side of its shading frame; nothing where
/// the cache does not serve it. For what comes through a sheet it is asked for the other side (`SurfacePoint::other_side`).
using CachedIrradiance = std::function<std::optional<Color>(const SurfacePoint& point, float distance)>;

/// Indirect radiance that lobes which are not diffuse reflect towards `wo` (in the point's frame), for those that a cache of
/// radiance serves: it marks them in `point.bsdf`.
using CachedReflection = std::function<Color(SurfacePoint& point, Vec3 wo)>;

struct PathOptions {
    int max_depth = -1;  // edges of a path: 1 emission only, 2 direct light, −1 unlimited
    int roulette_depth = roulette_after::picture_edges;
    int light_samples = 1;               // at the first vertex
    int miss_paths = 1;                  // that go on from a first vertex which the cache does not serve
    LightSet light_set = LightSet::all;  // without the environment image, rays that escape collect it whole
    bool emission_at_first_hit = true;   // false: whoever sent the rays samples the lights itself
    Coherence coherence = Coherence::none;
    CachedIrradiance cache;  // asked at every matte vertex: near records in pictures, far records in gathers
    CachedReflection reflection;
    CachedIrradiance far_cache;  // asked beyond the first vertex, where `cache` does not serve
};

struct PathRay {
    Ray ray;
    Sampler sampler;
};

/// What one path found.
struct PathResult {
    Color radiance;  // all of it
    Color direct;    // the part of paths with at most two edges
    Color albedo;    // of the first vertex
    Vec3 normal;     // of shading, at the first vertex
    // The same of the first vertex that is neither mirror nor clear glass, the albedo times what those before it let pass, at
    // most 1: what a denoiser takes for the surface that a pixel shows. Of the last vertex, where a path meets no other.
    Color rough_albedo;
    Vec3 rough_normal;
    float distance = infinity;  // to the first vertex
    bool behind = false;        // it lies on the back of a surface that has none
    bool cache_missed = false;  // a matte vertex was not served and was answered by going on
    bool gloss_cached = false;  // at the first vertex some lobe that is not diffuse was served by a cache
    bool gloss_traced = false;  // … some was not, and was traced
};

/// `out` gets one result for each ray. Counts rays in `progress`.
void trace_paths(const World& world, std::span<const PathRay> rays, const PathOptions& options,
                 std::span<PathResult> out, Progress& progress);

/// Tells the result of a path what its first vertex is, and then which rough surface comes first. `first`: whether `vertex`
/// is the first.
void describe(const World& world, const Vertex& vertex, bool first, PathState& path, PathResult& out);

/// Adds what was found at `vertex`, at the end of a path of so many `edges`, to the path's result.
inline void deposit(const Vertex& vertex, int edges, PathResult& out) {
    out.radiance += vertex.arriving;
    if (edges <= 2) out.direct += vertex.arriving;
    if (vertex.missed()) return;
    out.radiance += vertex.read_matte;
    out.radiance += vertex.read_glossy;
}

}  // namespace eclat
