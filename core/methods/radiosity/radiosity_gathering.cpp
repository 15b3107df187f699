// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Held to      tests/methods/test_radiosity.py

#include "methods/radiosity/radiosity_gathering.h"

#include <algorithm>

namespace eclat {

namespace {

/// Returns the indirect light at the end of a gather ray of length `distance`. It returns nothing for short rays, as in
/// corners, where single patches would be visible, so that the path continues.
std::optional<Color> far_light(const RadiosityField& field, const SurfacePoint& point, float distance) {
    const auto patch = field.on_patch(point);
    if (!patch || distance < 2 * patch->radius) return std::nullopt;
    return patch->light.indirect();
}

void trace_by_gather(const World& world, const RadiosityField& field, int gather_rays, int max_depth,
                     std::span<const PathRay> rays, std::span<PathResult> out, Progress& progress) {
    PathOptions options;
    options.max_depth = max_depth;
    options.coherence = Coherence::camera;
    options.cache = [](const SurfacePoint&, float) { return std::nullopt; };
    options.far_cache = [&field](const SurfacePoint& point, float distance) {
        return far_light(field, point, distance);
    };
    options.miss_paths = gather_rays;
    options.light_samples = std::max(1, gather_rays / 2);
    trace_paths(world, rays, options, out, progress);
}

/// Returns the radiance of a diffuse surface from its patches.
PathResult patch_picture(const World& world, const RadiosityField& field, int max_depth, const Hit& hit,
                         const SurfacePoint& point, Vec3 wo) {
    PathResult result;
    result.distance = hit.t;
    result.normal = point.frame.n;
    result.albedo = point.bsdf.albedo(point.frame.to_local(wo));
    result.rough_normal = result.normal, result.rough_albedo = result.albedo;
    if (const uint32_t emitter = world.emitter(hit.triangle); emitter != not_emitting)
        result.emitted = world.lights.emitted(emitter, {hit.u, hit.v}, wo);
    result.radiance = result.direct = result.emitted;
    if (max_depth == 1 || is_black(result.albedo)) return result;
    const Vec3 local = point.frame.to_local(wo);
    const auto add = [&](const SurfacePoint& side, Color albedo) {
        const auto light = is_black(albedo) ? std::nullopt : field.smooth(side);
        if (!light) return;
        result.direct += albedo * light->direct * inv_pi;
        result.radiance += albedo * light->total * inv_pi;
    };
    add(point, point.bsdf.diffuse_albedo(local));
    add(point.other_side(), point.bsdf.translucent_albedo(local));
    return result;
}

void show_patches(const World& world, const RadiosityField& field, int max_depth, std::span<const PathRay> rays,
                  std::span<PathResult> out, Progress& progress) {
    std::vector<Ray> seen;
    for (const PathRay& r : rays) seen.push_back(r.ray);
    std::vector<Hit> hits(rays.size());
    world.geometry.rays().intersect(seen, hits, Coherence::camera);
    progress.count_rays(rays.size());
    std::vector<PathRay> glossy;
    std::vector<size_t> glossy_index;
    for (size_t i = 0; i < rays.size(); ++i) {
        const Vec3 wo = -seen[i].direction;
        out[i] = PathResult{};
        if (hits[i].missed()) {
            out[i].radiance = out[i].direct = out[i].emitted = world.lights.environment(seen[i].direction);
            continue;
        }
        const SurfacePoint point = world.geometry.surface_point(hits[i], wo);
        if (point.bsdf.has(LobeSet::glossy)) {
            glossy.push_back(rays[i]);
            glossy_index.push_back(i);
        } else {
            out[i] = patch_picture(world, field, max_depth, hits[i], point, wo);
        }
    }
    PathOptions options;
    options.max_depth = max_depth;
    options.cache = [&field](const SurfacePoint& point, float) -> std::optional<Color> {
        const auto light = field.smooth(point);
        return light ? std::optional(light->indirect()) : std::nullopt;
    };
    std::vector<PathResult> traced(glossy.size());
    trace_paths(world, glossy, options, traced, progress);
    for (size_t i = 0; i < traced.size(); ++i) out[glossy_index[i]] = traced[i];
}

}  // namespace

void trace_to_patches(const World& world, const RadiosityField& field, int gather_rays, int max_depth,
                      std::span<const PathRay> rays, std::span<PathResult> out, Progress& progress) {
    if (gather_rays > 0) {
        trace_by_gather(world, field, gather_rays, max_depth, rays, out, progress);
    } else {
        show_patches(world, field, max_depth, rays, out, progress);
    }
}

std::vector<Color> radiosity_irradiance(const World& world, std::span<const PointNormal> points,
                                        const RadiosityField& field, const PointIrradianceOptions& options,
                                        Progress& progress) {
    // The solution contains light of all path lengths.
    if (options.max_depth >= 0) return path_irradiance(world, points, options, progress);
    return path_irradiance(world, points, options, progress, [&](const SurfacePoint& point, float distance) {
        return far_light(field, point, distance);
    });
}

}  // namespace eclat
