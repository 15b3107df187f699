// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "transport/vertex.h"

#include <algorithm>

namespace eclat {

namespace {

/// Prefetches the data of the hits after the i-th, which may be anywhere in the memory of a large scene.
void prefetch_after(size_t i, std::span<const Hit> hits, const Geometry& geometry) {
    constexpr size_t for_face = 12, for_vertices = 6;  // number of hits ahead, which covers about the latency of memory
    if (i + for_face < hits.size() && !hits[i + for_face].missed()) geometry.prefetch_face(hits[i + for_face].triangle);
    if (i + for_vertices < hits.size() && !hits[i + for_vertices].missed())
        geometry.prefetch_vertices(hits[i + for_vertices].triangle);
}

}  // namespace

std::span<Vertex> Vertices::meet(const World& world, std::span<const Ray> rays, Coherence coherence,
                                 Progress& progress) {
    trace(world, rays, coherence, progress);
    return part(world, rays, 0, rays.size());
}

void Vertices::trace(const World& world, std::span<const Ray> rays, Coherence coherence, Progress& progress) {
    hits_.resize(rays.size());
    world.geometry.rays().intersect(rays, hits_, coherence);
    progress.count_rays(rays.size());
}

std::span<Vertex> Vertices::part(const World& world, std::span<const Ray> rays, size_t begin, size_t end) {
    vertices_.clear();
    vertices_.reserve(end - begin);
    for (size_t i = begin; i < end; ++i) {
        prefetch_after(i, hits_, world.geometry);
        vertices_.emplace_back(world.geometry, rays[i], hits_[i]);
    }
    return vertices_;
}

bool go_on(const Vertex& vertex, LobeSet lobes, float roulette, PathState& path, Ray& ray, int paths, int light_samples,
           bool all_lights) {
    const auto next = scatter(vertex.point, vertex.wo_local, path.sampler, lobes);
    const float u_roulette = draw_if(roulette > 0, path.sampler);
    if (!next) return false;
    const BsdfSample& sample = next->sample;
    path.throughput *= sample.weight;
    if (sample.transmission) path.eta2 *= sqr(sample.eta_ratio);
    if (roulette > 0) {  // [ArvoKirk90]
        const float survival = std::min(largest_survival, roulette * max_component(path.throughput) * path.eta2);
        if (!(u_roulette < survival)) return false;
        path.throughput *= 1 / survival;
    }
    if (!(max_component(path.throughput) > 0)) return false;
    ray = vertex.point.ray(next->direction);
    if (sample.straight) {
        ++path.panes;
        return true;
    }
    path.from = vertex.point.position;
    path.pdf = sample.pdf_solid_angle * static_cast<float>(paths);
    path.light_samples = light_samples;
    path.all_lights = all_lights;
    path.past_matte |= vertex.point.bsdf.has_uncached_matte();
    path.arrival = sample.delta ? Arrival::whole : Arrival::weighted;
    return true;
}

}  // namespace eclat
