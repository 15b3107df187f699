// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "radiosity/patch_surfaces.h"

#include <algorithm>

#include "base/parallel.h"
#include "sampling/sampler.h"
#include "sampling/warp.h"

namespace eclat {

namespace {

constexpr uint32_t surface_stream = 61, light_stream = 62, closure_stream = 63;
constexpr float shadow_shortening = 1 - 0x1p-13f;  // as in transport/paths.cpp
constexpr uint32_t texture_samples = 16;
constexpr float low_ray = 0.02f;        // height of rays along a patch, in units of its radius
constexpr float resolution = 0x1p-20f;  // of coordinates, with three bits to spare

class PatchMeter {
  public:
    PatchMeter(const World& world, const PatchTree& tree, const SurfaceOptions& options, Progress& progress)
        : world_(world), tree_(tree), options_(options), progress_(progress) {}

    PatchSurface measure(uint32_t patch) {
        PatchSurface out;
        look_at_material(patch, out);
        gather_lights(patch, out);
        look_around(patch, out);
        return out;
    }

  private:
    /// Key of a patch that does not depend on which others there are.
    static uint32_t key(const PatchName& name) {
        return hash(2 * name.triangle + name.back, static_cast<uint32_t>(name.path),
                    static_cast<uint32_t>(name.path >> 32));
    }

    Vec3 spread(const PatchNode& patch, Sampler& sampler) const {
        const Vec2 b = square_to_triangle(sampler.next_2d());
        return patch.corner[0] * (1 - b.x - b.y) + patch.corner[1] * b.x + patch.corner[2] * b.y;
    }

    SurfacePoint bare(const PatchNode& patch, Vec3 position) const {
        SurfacePoint point;
        point.position = position;
        point.normal = patch.normal;
        point.frame = Frame::around(patch.normal);
        point.offset = resolution * (world_.geometry.radius() + length(position));
        return point;
    }

    void look_at_material(uint32_t index, PatchSurface& out) const {
        const PatchNode& patch = tree_[index];
        const Material& material = world_.geometry.material_of(patch.triangle);
        const uint32_t emitter = world_.emitter(patch.triangle);
        const Frame frame = Frame::around(patch.normal);
        Color albedo, emitted;
        float opacity = 0;
        for (uint32_t i = 0; i < texture_samples; ++i) {
            Sampler sampler(options_.seed ^ hash(surface_stream), key(tree_.name(index)), i);
            const Hit hit = hit_on_triangle(world_.geometry, patch.triangle, spread(patch, sampler));
            const Vec3 wo = frame.to_world(square_to_cosine_hemisphere(sampler.next_2d()));
            const SurfacePoint point = world_.geometry.surface_point(hit, wo);
            const Vec3 local = point.frame.to_local(wo);
            albedo += point.bsdf.albedo(local, material.transmits ? LobeSet::diffuse : LobeSet::all);
            if (emitter != not_emitting) emitted += world_.lights.emitted(emitter, {hit.u, hit.v}, patch.normal);
            opacity += opacity_at(material, world_.geometry.coordinates(patch.triangle, hit.u, hit.v));
        }
        constexpr float each = 1.0f / texture_samples;
        // Below 1: a patch that reflects everything may stand among others that do.
        out.albedo = min(albedo * each, Color(0.999f));
        out.emitted = emitted * (pi * each);
        out.opacity = opacity * each;
    }

    void gather_lights(uint32_t index, PatchSurface& out) {
        const PatchNode& patch = tree_[index];
        rays_.clear();
        contributions_.clear();
        for (int i = 0; i < options_.light_samples; ++i) {
            Sampler sampler(options_.seed ^ hash(light_stream), key(tree_.name(index)), static_cast<uint32_t>(i));
            const SurfacePoint point = bare(patch, spread(patch, sampler));
            const float u = sampler.next_1d();
            const LightSample light = world_.lights.sample(point.position, u, sampler.next_2d());
            const float cosine = dot(light.wi, patch.normal);
            // Surfaces that emit are patches: their light comes over links.
            if (light.triangle != no_triangle || !(light.pdf_solid_angle > 0 && cosine > 0)) continue;
            rays_.push_back(point.ray(light.wi, light.distance * shadow_shortening));
            contributions_.push_back(light.radiance * (cosine / light.pdf_solid_angle));
        }
        hidden_.resize(rays_.size());
        world_.geometry.rays().occluded(rays_, hidden_);
        progress_.count_rays(rays_.size());
        for (size_t i = 0; i < rays_.size(); ++i)
            if (!hidden_[i]) out.lights += contributions_[i];
        out.lights *= 1 / static_cast<float>(options_.light_samples);
    }

    void look_around(uint32_t index, PatchSurface& out) {
        const PatchNode& patch = tree_[index];
        rays_.clear();
        for (int i = 0; i < options_.closure_rays; ++i) {
            Sampler sampler(options_.seed ^ hash(closure_stream), key(tree_.name(index)), static_cast<uint32_t>(i));
            const SurfacePoint point = bare(patch, spread(patch, sampler));
            rays_.push_back(point.ray(point.frame.to_world(square_to_cosine_hemisphere(sampler.next_2d()))));
        }
        hits_.resize(rays_.size());
        world_.geometry.rays().intersect(rays_, hits_);
        progress_.count_rays(rays_.size());
        // Each ray starts at a point of its own. One that meets the back of a surface without any starts inside a solid.
        exposed_.clear();
        int patches = 0;
        for (size_t i = 0; i < hits_.size(); ++i) {
            const uint32_t triangle = hits_[i].triangle;
            if (!hits_[i].missed()) {
                const bool back = dot(world_.geometry.geometric_normal(triangle), rays_[i].direction) > 0;
                if (back && world_.geometry.has_no_back(triangle)) continue;
                ++patches;
            }
            exposed_.push_back(rays_[i].origin);
        }
        const auto exposed = static_cast<float>(exposed_.size());
        out.exposed = exposed / static_cast<float>(rays_.size());
        out.cut = is_cut(patch);
        if (out.unknown()) {
            out.lights = Color();
            return;
        }
        out.lights *= 1 / out.exposed;
        out.closure = static_cast<float>(patches) / exposed;
        // Of independent rays; stratified ones err less.
        out.closure_error = 2 * std::sqrt(out.closure * (1 - out.closure) / exposed);
    }

    /// Whether exposed points of the patch are hidden from each other, just above it.
    bool is_cut(const PatchNode& patch) {
        rays_.clear();
        const size_t half = exposed_.size() / 2;
        for (size_t i = 0; i < half; ++i) {
            const Vec3 above = patch.normal * (low_ray * patch.radius);
            const Vec3 to = exposed_[i + half] - exposed_[i];
            const float distance = length(to);
            if (distance > 0) rays_.push_back({exposed_[i] + above, 0, to / distance, distance});
        }
        hidden_.resize(rays_.size());
        world_.geometry.rays().occluded(rays_, hidden_);
        progress_.count_rays(rays_.size());
        return std::find(hidden_.begin(), hidden_.end(), 1) != hidden_.end();
    }

    const World& world_;
    const PatchTree& tree_;
    const SurfaceOptions& options_;
    Progress& progress_;
    std::vector<Ray> rays_;
    std::vector<Color> contributions_;
    std::vector<uint8_t> hidden_;
    std::vector<Hit> hits_;
    std::vector<Vec3> exposed_;  // points of the patch
};

}  // namespace

void measure_surfaces(const World& world, const PatchTree& tree, std::span<const uint32_t> patches,
                      const SurfaceOptions& options, std::span<PatchSurface> surfaces, Progress& progress) {
    constexpr size_t block = 64;
    progress.begin((patches.size() + block - 1) / block);
    parallel_blocks(patches.size(), block, options.threads, [&](size_t begin, size_t end) {
        progress.check();
        PatchMeter meter(world, tree, options, progress);
        for (size_t i = begin; i < end; ++i) surfaces[patches[i]] = meter.measure(patches[i]);
        progress.advance();
    });
}

Hit hit_on_triangle(const Geometry& geometry, uint32_t t, Vec3 position) {
    const Vec3 p0 = geometry.vertex(t, 0), e1 = geometry.vertex(t, 1) - p0, e2 = geometry.vertex(t, 2) - p0;
    const Vec3 d = position - p0, n = cross(e1, e2);
    const float scale = 1 / length_squared(n);
    const float u = clamp(dot(cross(d, e2), n) * scale, 0, 1);
    const float v = clamp(dot(cross(e1, d), n) * scale, 0, 1 - u);
    return {t, 0, u, v};
}

}  // namespace eclat
