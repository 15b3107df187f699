// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Paths from the camera, which are traced in batches, bounce by bounce. All methods use this estimator.
// At each vertex, emission, next-event estimation and one continued direction are combined by multiple importance
// sampling [Veach97]. If a cache gives the indirect irradiance E at a vertex, the diffuse lobes contribute ρ_d / π · E
// and are not continued; the path continues only by the other lobes. Without a cache this is plain unbiased path
// tracing [Kajiya86].
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

/// Returns the indirect irradiance at a point that a ray of length `distance` hit, on the side of its shading frame, or
/// nothing if the cache does not serve the point. For light that is transmitted through a surface, it is called with
/// the other side (`SurfacePoint::other_side`).
using CachedIrradiance = std::function<std::optional<Color>(const SurfacePoint& point, float distance)>;

/// Returns the indirect radiance that lobes which are not diffuse reflect towards `wo`, which is in the point's frame.
/// It covers the lobes that a cache of radiance serves, and marks them in `point.bsdf`.
using CachedReflection = std::function<Color(SurfacePoint& point, Vec3 wo)>;

/// Aims the directions that the diffuse lobes of points sample (`Bsdf::aim_diffuse`), those of each alone.
using Aim = std::function<void(std::span<SurfacePoint* const> points)>;

struct PathOptions {
    int max_depth = -1;  // edges of a path: 1 emission only, 2 direct light, −1 unlimited
    int roulette_depth = roulette_after::picture_edges;
    /// If positive, roulette may end the other lobes of a vertex whose matte ones are cached. The path then goes on with
    /// the probability of this number times its throughput over the albedo for which it has read the cache.
    float roulette_beside_cache = 0;
    int light_samples = 1;  // number of light samples at the first vertex
    int miss_paths = 1;     // number of paths that continue from a first vertex that the cache does not serve
    LightSet light_set = LightSet::all;  // if it excludes the environment, rays that escape count it fully
    bool emission_at_first_hit = true;   // false if the caller samples the lights itself
    Coherence coherence = Coherence::none;
    CachedIrradiance cache;  // read at every matte vertex: near records in pictures, far records in gathers
    CachedReflection reflection;
    CachedIrradiance far_cache;  // read beyond the first vertex, at points that `cache` does not serve
    /// Whether a path reads no cache before it has gone on from a matte vertex, as in a final gather [Reichert92]. What the
    /// caches get wrong is then spread over many pixels and reduced by the albedo.
    bool gather_first = false;
    Aim aim;  // called for those matte vertices
    /// Whether vertices at which no cache serves the matte lobes sample all lights, whatever `light_set` leaves out.
    bool all_lights_where_uncached = false;
    bool estimate_irradiance = false;  // whether results hold the irradiance that one path finds at the first vertex
};

struct PathRay {
    Ray ray;
    Sampler sampler;
    /// The density of the ray's direction, if a sample of all lights is taken where it begins. Light that the ray finds is then
    /// weighted against that sample. 0 if there is no such sample.
    float pdf = 0;
};

/// The result of one path.
struct PathResult {
    Color radiance;  // the whole radiance
    Color direct;    // the part of paths with at most two edges
    Color emitted;   // the part of paths with one edge: what a source sends along the ray, through panes too
    Color albedo;    // albedo of the first vertex
    Vec3 normal;     // shading normal at the first vertex
    // These are the albedo and the normal of the first vertex that is neither a mirror nor clear glass, which a
    // denoiser takes for the surface that a pixel shows. The albedo is multiplied by the throughput of the vertices
    // before it, and is at most 1. If there is no such vertex, they are those of the last vertex.
    Color rough_albedo;
    Vec3 rough_normal;
    float distance = infinity;  // distance to the first vertex
    bool behind = false;        // whether it lies on the back of a one-sided surface
    bool cache_missed = false;  // whether the cache did not serve a matte vertex, so that the path continued
    bool gloss_cached = false;  // whether a cache served a lobe of the first vertex that is not diffuse
    bool gloss_traced = false;  // whether such a lobe was traced
    /// If it was requested and no cache served the matte lobes of the first vertex: an unbiased estimate of the indirect
    /// irradiance there, on the side of the ray, from the path that continued. As in caches, light that light samples
    /// find is excluded.
    std::optional<Color> irradiance;
};

/// Traces paths; `out` gets one result for each ray. Counts rays in `progress`.
void trace_paths(const World& world, std::span<const PathRay> rays, const PathOptions& options,
                 std::span<PathResult> out, Progress& progress);

/// Stores in the result of a path the properties of its first vertex, and then those of its first rough surface.
/// `first` tells whether `vertex` is the first.
void describe(const World& world, const Vertex& vertex, bool first, PathState& path, PathResult& out);

/// Adds the light found at `vertex`, at the end of a path with that number of `edges`, to the path's result.
inline void deposit(const Vertex& vertex, int edges, PathResult& out) {
    out.radiance += vertex.arriving;
    if (edges <= 2) out.direct += vertex.arriving;
    if (edges <= 1) out.emitted += vertex.arriving;
    if (vertex.missed()) return;
    out.radiance += vertex.read_matte;
    out.radiance += vertex.read_glossy;
}

}  // namespace eclat
