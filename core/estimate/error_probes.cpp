// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "estimate/error_probes.h"

#include "transport/path_loop.h"

namespace eclat {

namespace {

/// This stream keys the random numbers of guesses, and `stream` those of the other computations.
constexpr auto guess_round = static_cast<uint32_t>(Stream::probe_guesses);

/// Returns the options of the paths of a gather, which collect all light for which the near cache is read. The paths
/// are traced to their ends unless `end` is given.
PathOptions gather_options(int max_depth, const CachedIrradiance& end) {
    PathOptions options;
    options.cache = end;
    options.max_depth = max_depth;
    options.roulette_depth = roulette_after::gather_edges;
    options.light_set = LightSet::without_smooth_environment;
    options.emission_at_first_hit = false;
    return options;
}

/// Returns the far records in which paths may end, if these contain all further light.
CachedIrradiance end_in(const RecordCache& far, int max_depth) {
    return max_depth < 0 && !far.records().empty() ? read_beyond_radius(far) : nullptr;
}

/// Returns the sum of throughput times radiance over the paths.
Color traced(const World& world, std::span<const PathRay> rays, std::span<const Color> weights, int max_depth,
             const CachedIrradiance& end, Progress& progress) {
    std::vector<PathResult> results(rays.size());
    trace_paths(world, rays, gather_options(max_depth, end), results, progress);
    Color sum;
    for (size_t i = 0; i < rays.size(); ++i) sum += weights[i] * results[i].radiance;
    return sum;
}

}  // namespace

/// A vertex at which a cache is read for some of the lobes.
struct PixelProbes::Served {
    Vertex vertex;
    LobeSet lobes;
    Color throughput;  // throughput of the path up to this vertex
    Color read;        // radiance that the cache adds there
    int edges;
};

Ray PixelProbes::ray(Vec2 u, Sampler& sampler) const {
    const Vec2 within = sampler.next_2d();
    const float x =
        std::min(std::floor(u.x * static_cast<float>(camera_.width)), static_cast<float>(camera_.width - 1));
    const float y =
        std::min(std::floor(u.y * static_cast<float>(camera_.height)), static_cast<float>(camera_.height - 1));
    return camera_.ray(x + within.x, y + within.y, sampler.next_2d());
}

Color PixelProbes::shown(Vec2 u, uint32_t stream, uint32_t place, uint32_t samples, Progress& progress) const {
    std::vector<PathRay> rays;
    for (uint32_t s = 0; s < samples; ++s) {
        Sampler sampler(stream_seed(seed_, Stream::probe_shown, stream), place, s);
        const Ray first = ray(u, sampler);
        rays.push_back({first, sampler});
    }
    PathOptions options;
    options.coherence = Coherence::camera;
    options.max_depth = max_depth_;
    options.light_set = LightSet::without_smooth_environment;
    options.cache = read_near(caches_);
    options.reflection = reflection_;
    options.light_samples = 4;  // noise of probes widens the confidence interval, and shadow rays are cheap
    std::vector<PathResult> results(samples);
    trace_paths(world_, rays, options, results, progress);
    Color sum;
    for (const PathResult& r : results) sum += r.radiance;
    return sum / static_cast<float>(samples);
}

// The functions of transport/vertex.h make the same decisions as for `trace_paths`: at served vertices, the path
// continues only by the other lobes. No light is collected here; the served vertices are the result.
std::vector<PixelProbes::Served> PixelProbes::served_vertices(const Ray& first, const Sampler& sampler,
                                                              Progress& progress) const {
    constexpr int longest = 64;  // greatest number of edges; roulette ends almost all paths long before
    const CachedIrradiance cache = read_near(caches_);
    std::vector<Served> out;
    Paths<PathState> paths;
    if (max_depth_ < 0 || max_depth_ > 2) paths.push({.sampler = sampler, .from = first.origin}, first);
    follow_paths(
        world_, std::move(paths), Coherence::camera, Span::batch, progress,
        [&](int edges, std::span<PathState> states, std::span<Vertex> vertices, Paths<PathState>& next) {
            Vertex& v = vertices[0];
            PathState& path = states[0];
            if (v.missed()) return;
            Bsdf& bsdf = v.point.bsdf;
            if (reflection_ && bsdf.has(LobeSet::glossy)) {
                const Color reflected = reflection_(v.point, v.wo_local);
                if (bsdf.has(LobeSet::cached)) out.push_back({v, LobeSet::cached, path.throughput, reflected, edges});
            }
            for (const LobeSet lobes : {LobeSet::diffuse, LobeSet::translucent}) {
                if (!bsdf.has(lobes)) continue;
                const auto E = cache(lobes == LobeSet::diffuse ? v.point : v.point.other_side(), v.hit.t);
                if (!E) continue;
                const Color read = bsdf.albedo(v.wo_local, lobes) * *E * inv_pi;
                out.push_back({v, lobes, path.throughput, read, edges});
                bsdf.set_cached(lobes);
            }
            if (edges + 1 >= longest || (max_depth_ >= 0 && edges + 2 >= max_depth_)) return;
            Ray ray;
            if (go_on(v, LobeSet::uncached, roulette_from(roulette_after::probe_edges, edges), path, ray))
                next.push(path, ray);
        },
        [](Paths<PathState>&) {});
    return out;
}

Probe PixelProbes::error(Vec2 u, uint32_t stream, uint32_t place, uint32_t looks, uint32_t paths,
                         Progress& progress) const {
    return compared(u, stream, place, looks, paths, nullptr, progress);
}

Probe PixelProbes::guess(Vec2 u, uint32_t place, uint32_t paths, Progress& progress) const {
    return compared(u, guess_round, place, 1, paths, end_in(caches_.far, max_depth_), progress);
}

Probe PixelProbes::compared(Vec2 u, uint32_t stream, uint32_t place, uint32_t looks, uint32_t paths,
                            const CachedIrradiance& end, Progress& progress) const {
    Probe out;
    for (uint32_t look = 0; look < looks; ++look) {
        Sampler at(stream_seed(seed_, Stream::probe_cameras, stream), place, look);
        const Ray first = ray(u, at);
        const auto found =
            served_vertices(first, Sampler(stream_seed(seed_, Stream::probe_chains, stream), place, look), progress);
        for (size_t v = 0; v < found.size(); ++v) {
            const auto& [vertex, lobes, throughput, read, edges] = found[v];
            if (!out.served) out.position = vertex.point.position;
            out.served = true;
            std::vector<PathRay> rays;
            std::vector<Color> weights;
            for (uint32_t j = 0; j < paths; ++j) {
                // The camera rays of a probe share one sequence, because most of them hit the same surface.
                Sampler sampler(stream_seed(seed_, Stream::probe_gathers, stream, static_cast<uint32_t>(v)), place,
                                look * paths + j);
                const auto next = scatter(vertex.point, vertex.wo_local, sampler, lobes);
                if (!next) continue;
                rays.push_back({vertex.point.ray(next->direction), sampler});
                weights.push_back(next->sample.weight);
            }
            const int depth = max_depth_ < 0 ? -1 : max_depth_ - edges;
            const Color truth = traced(world_, rays, weights, depth, end, progress) / static_cast<float>(paths);
            out.value += throughput * (read - truth);
        }
    }
    out.value = out.value / static_cast<float>(looks);
    return out;
}

const PointNormal& PointProbes::at(Vec2 u) const {
    const auto i = static_cast<size_t>(static_cast<double>(u.x) * static_cast<double>(points_.size()));
    return points_[std::min(i, points_.size() - 1)];
}

std::optional<Color> PointProbes::read(const PointNormal& point) const {
    return caches_.near.interpolate(point.position, point.normal, point.normal);
}

Color PointProbes::shown(Vec2 u, uint32_t stream, uint32_t place, uint32_t samples, Progress& progress) const {
    const PointNormal& point = at(u);
    const SurfacePoint surface = bare_point(world_, point);
    Shadows shadows;
    for (uint32_t s = 0; s < samples; ++s) {
        Sampler sampler(stream_seed(seed_, Stream::probe_shown, stream), place, s);
        if (const auto shadow =
                sample_irradiance(world_, surface, point.normal, LightSet::without_smooth_environment, sampler))
            shadows.push(shadow->ray, shadow->contribution, 0, true);
    }
    Color sum;
    shadows.resolve(world_, progress, [&](uint32_t, Color contribution, bool) { sum += contribution; });
    return sum / static_cast<float>(samples) + read(point).value_or(Color());
}

Probe PointProbes::error(Vec2 u, uint32_t stream, uint32_t place, uint32_t looks, uint32_t paths,
                         Progress& progress) const {
    return compared(u, stream, place, looks * paths, nullptr, progress);
}

Probe PointProbes::guess(Vec2 u, uint32_t place, uint32_t paths, Progress& progress) const {
    return compared(u, guess_round, place, paths, end_in(caches_.far, max_depth_), progress);
}

Probe PointProbes::compared(Vec2 u, uint32_t stream, uint32_t place, uint32_t paths, const CachedIrradiance& end,
                            Progress& progress) const {
    const PointNormal& point = at(u);
    Probe out;
    out.position = point.position;
    const auto E = read(point);
    if (!E) return out;
    const SurfacePoint surface = bare_point(world_, point);
    std::vector<PathRay> rays;
    for (uint32_t s = 0; s < paths; ++s) {
        Sampler sampler(stream_seed(seed_, Stream::probe_gathers, stream), place, s);
        const Vec3 w = square_to_cosine_hemisphere(sampler.next_2d());
        rays.push_back({surface.ray(surface.frame.to_world(w)), sampler});
    }
    const std::vector<Color> weights(rays.size(), Color(pi / static_cast<float>(paths)));
    out.served = true;
    out.value = *E - traced(world_, rays, weights, max_depth_ < 0 ? -1 : max_depth_ - 1, end, progress);
    return out;
}

}  // namespace eclat
