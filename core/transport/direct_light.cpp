// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "transport/direct_light.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "sampling/mis.h"

namespace eclat {

void Shadows::push(const Ray& ray, Color contribution, uint32_t index, bool direct) {
    rays_.push_back(ray);
    waiting_.push_back({contribution, index, direct});
}

void DirectLight::arrive(const PathState& path, Vertex& vertex) const {
    vertex.arriving = vertex.missed() ? from_behind_everything(path, -vertex.wo) : from_surface(path, vertex);
}

Color DirectLight::from_behind_everything(const PathState& path, Vec3 w) const {
    const Lights::Infinite sampled = world_.lights.infinite(w, set(path.all_lights));
    Color radiance = sampled.radiance;
    if (path.arrival == Arrival::none) radiance = Color();
    if (path.arrival == Arrival::weighted)
        radiance *= power_heuristic(path.pdf, static_cast<float>(path.light_samples) * sampled.pdf_solid_angle);
    // Light that light sampling leaves out is counted with full weight.
    radiance += world_.lights.left_out(w, set(path.all_lights));
    return path.throughput * radiance;
}

Color DirectLight::from_surface(const PathState& path, const Vertex& vertex) const {
    const uint32_t emitter = world_.emitter(vertex.hit.triangle);
    if (emitter == not_emitting || path.arrival == Arrival::none) return {};
    const Color radiance = world_.lights.emitted(emitter, {vertex.hit.u, vertex.hit.v}, vertex.wo);
    if (is_black(radiance)) return {};
    float weight = 1;
    if (path.arrival == Arrival::weighted)
        weight = power_heuristic(path.pdf, static_cast<float>(path.light_samples) *
                                               world_.lights.pdf_solid_angle(emitter, path.from, vertex.point.position,
                                                                             set(path.all_lights)));
    return path.throughput * radiance * weight;
}

void DirectLight::sample(std::span<const WantedLight> wanted, Shadows& shadows) const {
    constexpr size_t most = 32;  // the number of vertices in a part of a batch; queries of so many stay in the cache
    std::array<LightQuery, most> queries;
    std::array<LightSample, most> lights;
    while (!wanted.empty()) {
        const bool all_lights = wanted.front().all_lights;
        const auto last = std::ranges::find_if(wanted.first(std::min(most, wanted.size())),
                                               [&](const WantedLight& w) { return w.all_lights != all_lights; });
        const auto some = wanted.first(static_cast<size_t>(last - wanted.begin()));
        wanted = wanted.subspan(some.size());
        for (size_t i = 0; i < some.size(); ++i) {
            Sampler sampler = some[i].sampler;
            const float u = sampler.next_1d();
            queries[i] = {some[i].vertex->point.position, u, sampler.next_2d()};
        }
        world_.lights.sample(std::span(queries).first(some.size()), set(all_lights), lights);
        for (size_t i = 0; i < some.size(); ++i) reflect(some[i], lights[i], shadows);
    }
}

/// Adds the shadow ray of a light sample, with what its vertex reflects of it.
void DirectLight::reflect(const WantedLight& wanted, const LightSample& light, Shadows& shadows) const {
    const Vertex& vertex = *wanted.vertex;
    const PathState& path = *wanted.path;
    const LitLobes& lobes = wanted.lobes;
    const SurfacePoint& point = vertex.point;
    if (!(light.pdf_solid_angle > 0) || is_black(light.radiance)) return;
    const Vec3 wi = point.frame.to_local(light.wi);
    if (wi.z * dot(light.wi, point.normal) <= 0) return;  // the shading and geometric normals disagree about the side
    // All light samples of the vertex together are one technique, whose density is multiplied by their number.
    const float density = static_cast<float>(lobes.light_samples) * light.pdf_solid_angle;
    Color f;
    if (point.bsdf.has(lobes.alone)) f = point.bsdf.eval(vertex.wo_local, wi, lobes.alone).f;
    if (lobes.has_shared) {
        const EvalPdf e = point.bsdf.eval(vertex.wo_local, wi, lobes.shared);
        const float others = static_cast<float>(lobes.paths) * e.pdf_solid_angle;
        f += e.f * (light.delta ? 1 : power_heuristic(density, others));
    }
    if (is_black(f)) return;
    shadows.push(point.ray_to_light(light.wi, light.distance, light.clearance),
                 path.throughput * f * light.radiance * (std::fabs(wi.z) / density), path.index, wanted.direct);
}

std::optional<ShadowRay> sample_irradiance(const World& world, const SurfacePoint& point, Vec3 n, LightSet set,
                                           Sampler& sampler) {
    const float u = sampler.next_1d();
    const Vec2 uv = sampler.next_2d();
    const LightSample light = world.lights.sample(point.position, u, uv, set);
    const float cosine = dot(light.wi, n);
    if (!(light.pdf_solid_angle > 0) || cosine <= 0) return std::nullopt;
    return ShadowRay{point.ray_to_light(light.wi, light.distance, light.clearance),
                     light.radiance * (cosine / light.pdf_solid_angle)};
}

}  // namespace eclat
