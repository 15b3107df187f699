// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "estimate/error_probes.h"

namespace eclat {

namespace {

constexpr uint32_t camera_stream = 41, chain_stream = 42, gather_stream = 43, shown_stream = 44, guess_stream = 45;

/// What a gather's paths collect: everything that the near cache answers for. They go to their end unless `end` is given.
PathOptions gather_options(int max_depth, const CachedIrradiance& end) {
    PathOptions options;
    options.cache = end;
    options.max_depth = max_depth;
    options.roulette_depth = 2;
    options.light_set = LightSet::without_environment_image;
    options.emission_at_first_hit = false;
    return options;
}

/// Where far records answer for all further light, paths may end in them.
CachedIrradiance end_in(const RecordCache& far, int max_depth) {
    return max_depth < 0 && !far.records().empty() ? read_far(far) : nullptr;
}

/// Sum of throughput times radiance of the paths.
Color traced(const World& world, std::span<const PathRay> rays, std::span<const Color> weights, int max_depth,
             const CachedIrradiance& end, Progress& progress) {
    std::vector<PathResult> results(rays.size());
    trace_paths(world, rays, gather_options(max_depth, end), results, progress);
    Color sum;
    for (size_t i = 0; i < rays.size(); ++i) sum += weights[i] * results[i].radiance;
    return sum;
}

}  // namespace

/// A vertex some of whose lobes a cache answers for.
struct PixelProbes::Vertex {
    SurfacePoint point;
    LobeSet lobes;
    Vec3 wo;           // local
    Color throughput;  // of the path up to here
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
        Sampler sampler(seed_ ^ hash(shown_stream, stream), place, s);
        const Ray first = ray(u, sampler);
        rays.push_back({first, sampler});
    }
    PathOptions options;
    options.max_depth = max_depth_;
    options.light_set = LightSet::without_environment_image;
    options.cache = read_near(caches_);
    options.reflection = reflection_;
    options.light_samples = cached_light_samples;
    std::vector<PathResult> results(samples);
    trace_paths(world_, rays, options, results, progress);
    Color sum;
    for (const PathResult& r : results) sum += r.radiance;
    return sum / static_cast<float>(samples);
}

// The path that `trace_paths` follows, with the same decisions: served vertices go on by their other lobes only.
std::vector<PixelProbes::Vertex> PixelProbes::vertices(const Ray& first, Sampler sampler, Progress& progress) const {
    constexpr int longest = 64;  // edges; roulette ends almost all paths long before
    constexpr int roulette_depth = 3;
    const CachedIrradiance cache = read_near(caches_);
    std::vector<Vertex> out;
    Ray ray = first;
    Color throughput(1);
    for (int edges = 1; edges < longest && (max_depth_ < 0 || edges + 1 < max_depth_); ++edges) {
        Hit hit;
        world_.geometry.rays().intersect({&ray, 1}, {&hit, 1}, Coherence::none);
        progress.count_rays(1);
        if (hit.missed()) break;
        SurfacePoint point = world_.geometry.surface_point(hit, -ray.direction);
        const Vec3 wo = point.frame.to_local(-ray.direction);
        if (reflection_ && point.bsdf.has(LobeSet::glossy)) {
            const Color reflected = reflection_(point, wo);
            if (point.bsdf.has(LobeSet::cached))
                out.push_back({point, LobeSet::cached, wo, throughput, reflected, edges});
        }
        if (point.bsdf.has(LobeSet::diffuse))
            if (const auto E = cache(point, hit.t)) {
                const Color read = point.bsdf.diffuse_albedo(wo) * *E * inv_pi;
                out.push_back({point, LobeSet::diffuse, wo, throughput, read, edges});
                point.bsdf.set_cached(LobeSet::diffuse);
            }
        const float u_lobe = sampler.next_1d();
        const auto sample = point.bsdf.sample(wo, u_lobe, sampler.next_2d(), LobeSet::uncached);
        if (!sample) break;
        const Vec3 wi = point.frame.to_world(sample->wi);
        if (dot(wi, point.normal) * sample->wi.z <= 0) break;
        throughput *= sample->weight;
        const float u_roulette = sampler.next_1d();
        if (edges >= roulette_depth) {
            const float survival = std::min(0.95f, max_component(throughput));
            if (u_roulette >= survival) break;
            throughput *= 1 / survival;
        }
        if (!(max_component(throughput) > 0)) break;
        ray = point.ray(wi);
    }
    return out;
}

Probe PixelProbes::error(Vec2 u, uint32_t stream, uint32_t place, uint32_t looks, uint32_t paths,
                         Progress& progress) const {
    return compared(u, stream, place, looks, paths, nullptr, progress);
}

Probe PixelProbes::guess(Vec2 u, uint32_t place, uint32_t paths, Progress& progress) const {
    return compared(u, guess_stream, place, 1, paths, end_in(caches_.far, max_depth_), progress);
}

Probe PixelProbes::compared(Vec2 u, uint32_t stream, uint32_t place, uint32_t looks, uint32_t paths,
                            const CachedIrradiance& end, Progress& progress) const {
    Probe out;
    for (uint32_t look = 0; look < looks; ++look) {
        Sampler at(seed_ ^ hash(camera_stream, stream), place, look);
        const Ray first = ray(u, at);
        const auto found = vertices(first, Sampler(seed_ ^ hash(chain_stream, stream), place, look), progress);
        for (size_t v = 0; v < found.size(); ++v) {
            const Vertex& vertex = found[v];
            if (!out.served) out.position = vertex.point.position;
            out.served = true;
            std::vector<PathRay> rays;
            std::vector<Color> weights;
            for (uint32_t j = 0; j < paths; ++j) {
                // The looks of a probe share one sequence: most see the same surface.
                Sampler sampler(seed_ ^ hash(gather_stream, stream, static_cast<uint32_t>(v)), place, look * paths + j);
                const float u_lobe = sampler.next_1d();
                const auto sample = vertex.point.bsdf.sample(vertex.wo, u_lobe, sampler.next_2d(), vertex.lobes);
                if (!sample) continue;
                const Vec3 wi = vertex.point.frame.to_world(sample->wi);
                if (dot(wi, vertex.point.normal) * sample->wi.z <= 0) continue;
                rays.push_back({vertex.point.ray(wi), sampler});
                weights.push_back(sample->weight);
            }
            const int depth = max_depth_ < 0 ? -1 : max_depth_ - vertex.edges;
            const Color truth = traced(world_, rays, weights, depth, end, progress) / static_cast<float>(paths);
            out.value += vertex.throughput * (vertex.read - truth);
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
    std::vector<Ray> rays;
    std::vector<Color> contributions;
    for (uint32_t s = 0; s < samples; ++s) {
        Sampler sampler(seed_ ^ hash(shown_stream, stream), place, s);
        if (const auto shadow =
                sample_irradiance(world_, surface, point.normal, LightSet::without_environment_image, sampler)) {
            rays.push_back(shadow->ray);
            contributions.push_back(shadow->contribution);
        }
    }
    std::vector<uint8_t> occluded(rays.size());
    world_.geometry.rays().occluded(rays, occluded);
    progress.count_rays(rays.size());
    Color sum;
    for (size_t i = 0; i < rays.size(); ++i)
        if (!occluded[i]) sum += contributions[i];
    return sum / static_cast<float>(samples) + read(point).value_or(Color());
}

Probe PointProbes::error(Vec2 u, uint32_t stream, uint32_t place, uint32_t looks, uint32_t paths,
                         Progress& progress) const {
    return compared(u, stream, place, looks * paths, nullptr, progress);
}

Probe PointProbes::guess(Vec2 u, uint32_t place, uint32_t paths, Progress& progress) const {
    return compared(u, guess_stream, place, paths, end_in(caches_.far, max_depth_), progress);
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
        Sampler sampler(seed_ ^ hash(gather_stream, stream), place, s);
        const Vec3 w = square_to_cosine_hemisphere(sampler.next_2d());
        rays.push_back({surface.ray(surface.frame.to_world(w)), sampler});
    }
    const std::vector<Color> weights(rays.size(), Color(pi / static_cast<float>(paths)));
    out.served = true;
    out.value = *E - traced(world_, rays, weights, max_depth_ < 0 ? -1 : max_depth_ - 1, end, progress);
    return out;
}

}  // namespace eclat
