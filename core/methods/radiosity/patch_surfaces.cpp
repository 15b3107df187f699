// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/radiosity/patch_surfaces.h"

#include <algorithm>
#include <numeric>

#include "base/parallel.h"
#include "sampling/sampler.h"
#include "sampling/warp.h"

namespace eclat {

namespace {

constexpr int texture_samples = 16;
// Of a pane that is a mirror at grazing angles, the mean over directions is then known within 1 %.
constexpr int pane_samples = 256;
// A pane is taken to stop at least this share of the light, by which others are divided.
constexpr float least_stopped = 1e-3f;
// Each side takes its share of the samples of a face cluster, but at least this fraction of them.
constexpr float least_share = 1.0f / 8;
constexpr float low_ray = 0.02f;  // height of rays along a patch, in units of its radius
// If less than this share of a patch is exposed, its light is unknown.
constexpr float least_exposed = 0.1f;

class PatchMeter {
  public:
    PatchMeter(const World& world, const PatchTree& tree, const SurfaceOptions& options, Progress& progress)
        : world_(world), tree_(tree), options_(options), progress_(progress) {}

    PatchSurface measure(uint32_t patch) {
        PatchSurface out;
        share_ = share_of_face(patch);
        look_at_material(patch, out);
        look_around(patch, out);
        if (!out.unknown()) gather_lights(patch, out);
        return out;
    }

  private:
    /// Returns a key of a patch that does not depend on the other patches.
    static uint32_t key(const PatchName& name) {
        return hash(2 * name.triangle + name.back, static_cast<uint32_t>(name.path),
                    static_cast<uint32_t>(name.path >> 32));
    }

    float share_of_face(uint32_t patch) const {
        uint32_t face = patch;
        while (tree_[face].parent != no_node && tree_[tree_[face].parent].ends_links) face = tree_[face].parent;
        return std::max(least_share, tree_[patch].area / tree_[face].area);
    }
    int samples(int of_a_patch) const { return std::max(1, static_cast<int>(std::lround(share_ * of_a_patch))); }

    SurfacePoint bare(const PatchNode& patch, Vec3 position) const {
        SurfacePoint point;
        point.position = position;
        point.normal = patch.normal;
        point.frame = Frame::around(patch.normal);
        point.offset = world_.geometry.ray_offset(patch.triangle);
        return point;
    }

    void look_at_material(uint32_t index, PatchSurface& out) const {
        const PatchNode& patch = tree_[index];
        const Material& material = world_.geometry.material_of(patch.triangle);
        const uint32_t emitter = world_.emitter(patch.triangle);
        const Frame frame = Frame::around(patch.normal);
        Color albedo, transmittance, emitted, straight;
        float opacity = 0;
        const int count = material.pane ? pane_samples : samples(texture_samples);
        for (int i = 0; i < count; ++i) {
            Sampler sampler(stream_seed(options_.seed, Stream::patch_surfaces), key(tree_.name(index)),
                            static_cast<uint32_t>(i));
            const Hit hit =
                hit_on_triangle(world_.geometry, patch.triangle, patch.point(square_to_triangle(sampler.next_2d())));
            const Vec3 wo = frame.to_world(square_to_cosine_hemisphere(sampler.next_2d()));
            const SurfacePoint point = world_.geometry.surface_point(hit, wo);
            const Vec3 local = point.frame.to_local(wo);
            // Bumps and smooth normals reflect less of what arrives on the patch.
            const float kept = point.even_share();
            const Color beyond = point.bsdf.straight(local), scattered = point.bsdf.scattered_through(local);
            albedo += (material.refracts ? point.bsdf.diffuse_albedo(local)
                                         : max(point.bsdf.albedo(local) - beyond - scattered, Color())) *
                      kept;
            transmittance += scattered * kept;
            straight += beyond;
            if (emitter != not_emitting) emitted += world_.lights.emitted(emitter, {hit.u, hit.v}, patch.normal);
            opacity += opacity_at(material, world_.geometry.coordinates(patch.triangle, hit.u, hit.v));
        }
        const float each = 1.0f / static_cast<float>(count);
        // What goes straight through a pane is not light of its patches, which are surfaces that are there in part: what they
        // scatter and emit is told in units of that part.
        out.stops = std::max(least_stopped, 1 - each * mean(straight));
        albedo *= 1 / out.stops;
        transmittance *= 1 / out.stops;
        // The sum is kept below 1, because a closed room of patches that reflect or transmit all light has no solution.
        constexpr float most_kept = 0.999f;
        for (int k = 0; k < 3; ++k) {
            const float scale =
                each * std::min(1.0f, most_kept / std::max(1e-6f, each * (albedo[k] + transmittance[k])));
            out.albedo[k] = albedo[k] * scale;
            out.transmittance[k] = transmittance[k] * scale;
        }
        out.emitted = emitted * (pi * each / out.stops);
        out.opacity = opacity * each * out.stops;
    }

    void gather_lights(uint32_t index, PatchSurface& out) {
        const PatchNode& patch = tree_[index];
        rays_.clear();
        contributions_.clear();
        const int count = samples(options_.light_samples);
        for (int i = 0; i < count; ++i) {
            Sampler sampler(stream_seed(options_.seed, Stream::patch_lights), key(tree_.name(index)),
                            static_cast<uint32_t>(i));
            const Vec2 anywhere = square_to_triangle(sampler.next_2d());
            const SurfacePoint point = bare(patch, patch.point(out.exposed_point(anywhere, sampler.next_1d())));
            const float u = sampler.next_1d();
            const LightSample light = world_.lights.sample(point.position, u, sampler.next_2d());
            const float cosine = dot(light.wi, patch.normal);
            // Surfaces that emit are patches: their light comes over links.
            if (light.triangle != no_triangle || !(light.pdf_solid_angle > 0 && cosine > 0)) continue;
            rays_.push_back(point.ray_to_light(light.wi, light.distance, light.clearance));
            const float stays = stopped(world_.geometry, patch.triangle, out.stops, point.position, -light.wi);
            contributions_.push_back(light.radiance * (stays * cosine / light.pdf_solid_angle));
        }
        passed_.resize(rays_.size());
        world_.geometry.rays().transmitted(rays_, passed_);
        progress_.count_rays(rays_.size());
        for (size_t i = 0; i < rays_.size(); ++i) out.lights += contributions_[i] * passed_[i];
        out.lights *= 1 / static_cast<float>(count);
    }

    void look_around(uint32_t index, PatchSurface& out) {
        const PatchNode& patch = tree_[index];
        rays_.clear();
        std::vector<Vec2> where;
        // They are not shared by the sides of a face cluster: of four rays of a side of a small lamp, none may go through the
        // gap by which it lights a room, and a closure of 0 that counts as certain would take the lamp's light away.
        const int count = options_.closure_rays;
        for (int i = 0; i < count; ++i) {
            Sampler sampler(stream_seed(options_.seed, Stream::patch_closure), key(tree_.name(index)),
                            static_cast<uint32_t>(i));
            where.push_back(square_to_triangle(sampler.next_2d()));
            const SurfacePoint point = bare(patch, patch.point(where.back()));
            rays_.push_back(point.ray(point.frame.to_world(square_to_cosine_hemisphere(sampler.next_2d()))));
        }
        hits_.resize(rays_.size());
        world_.geometry.meet_with_backs(rays_, hits_);
        progress_.count_rays(rays_.size());
        // Each ray starts at a different point.
        exposed_.clear();
        for (size_t i = 0; i < hits_.size(); ++i) {
            const Vec3 start = rays_[i].origin;
            Sampler sampler(stream_seed(options_.seed, Stream::patch_panes), key(tree_.name(index)),
                            static_cast<uint32_t>(i));
            pass_panes(rays_[i], hits_[i], sampler);
            exposed_.push_back({where[i], start, met(rays_[i], hits_[i])});
        }
        drop_points_inside(patch, index);
        out.cut = is_cut(patch);
        if (out.cut) keep_largest_part(patch);
        out.exposed = static_cast<float>(exposed_.size()) / static_cast<float>(count);
        // This is the deviation of independent rays; the error of stratified ones is smaller.
        const auto lit =
            std::count_if(exposed_.begin(), exposed_.end(), [](const Exposed& e) { return e.met == Met::patch; });
        out.closure = exposed_.empty() ? 0 : static_cast<float>(lit) / static_cast<float>(exposed_.size());
        out.closure_error = 2 * std::sqrt(out.closure * (1 - out.closure) / std::max(1.0f, out.exposed * count));
        if (out.exposed == 1 || out.exposed < least_exposed) return;
        for (const Exposed& e : exposed_) {
            if (out.point_count == PatchSurface::most_points) break;
            out.points[out.point_count++] = {static_cast<uint8_t>(e.where.x * 255),
                                             static_cast<uint8_t>(e.where.y * 255)};
        }
    }

    /// The kind of surface on which a ray from a patch ends. The back of a one-sided surface is black: it absorbs light
    /// and emits none.
    enum class Met : uint8_t { sky, patch, black_back };

    Met met(const Ray& ray, const Hit& hit) const {
        if (hit.missed()) return Met::sky;
        const bool from_behind = dot(world_.geometry.geometric_normal(hit.triangle), ray.direction) > 0;
        return from_behind && world_.geometry.has_no_back(hit.triangle) ? Met::black_back : Met::patch;
    }

    /// Moves a ray on behind each pane that lets it through by the numbers of `sampler`.
    void pass_panes(Ray& ray, Hit& hit, Sampler& sampler) const {
        constexpr int most_panes = 64;  // more than any scene has one behind the other
        for (int i = 0; i < most_panes && !hit.missed() && world_.geometry.material_of(hit.triangle).pane; ++i) {
            if (sampler.next_1d() >= mean(world_.geometry.straight(hit, ray.direction))) return;
            ray = world_.geometry.surface_point(hit, -ray.direction).ray(ray.direction);
            world_.geometry.meet_with_backs({&ray, 1}, {&hit, 1});
            progress_.count_rays(1);
        }
    }

    /// Points that see a black back lie behind a one-sided surface or inside a solid. More rays distinguish the two
    /// cases, because inside a solid hardly any ray hits anything else. Parts of a patch inside a solid are not visible
    /// from other patches.
    void drop_points_inside(const PatchNode& patch, uint32_t index) {
        constexpr uint32_t rays_of_point = 16, others_inside = 1;
        rays_.clear();
        for (uint32_t i = 0; i < exposed_.size(); ++i) {
            if (exposed_[i].met != Met::black_back) continue;
            const SurfacePoint point = bare(patch, patch.point(exposed_[i].where));
            const uint32_t stream = stream_seed(options_.seed, Stream::patch_insides, i);
            for (uint32_t k = 0; k < rays_of_point; ++k) {
                Sampler sampler(stream, key(tree_.name(index)), k);
                rays_.push_back(point.ray(point.frame.to_world(square_to_cosine_hemisphere(sampler.next_2d()))));
            }
        }
        hits_.resize(rays_.size());
        world_.geometry.meet_with_backs(rays_, hits_);
        progress_.count_rays(rays_.size());
        size_t kept = 0, ray = 0;
        for (const Exposed& e : exposed_) {
            uint32_t others = others_inside + 1;
            if (e.met == Met::black_back) {
                others = 0;
                for (uint32_t k = 0; k < rays_of_point; ++k, ++ray)
                    others += met(rays_[ray], hits_[ray]) != Met::black_back;
            }
            if (others > others_inside) exposed_[kept++] = e;
        }
        exposed_.resize(kept);
    }

    /// Tests in pairs whether points of one half and of the other half see each other just above the patch.
    bool is_cut(const PatchNode& patch) {
        rays_.clear();
        const size_t half = exposed_.size() / 2;
        for (size_t i = 0; i < half; ++i) look_across(patch, i, i + half);
        trace_across();
        return std::find(hidden_.begin(), hidden_.end(), 1) != hidden_.end();
    }

    /// Keeps the largest set of points that see each other directly or by way of other points.
    void keep_largest_part(const PatchNode& patch) {
        rays_.clear();
        const size_t n = exposed_.size();
        for (size_t i = 0; i < n; ++i)
            for (size_t j = i + 1; j < n; ++j) look_across(patch, i, j);
        trace_across();
        std::vector<size_t> part(n), size(n, 0);
        std::iota(part.begin(), part.end(), size_t(0));
        size_t ray = 0;
        for (size_t i = 0; i < n; ++i)
            for (size_t j = i + 1; j < n; ++j)
                if (!hidden_[ray++])
                    std::replace(part.begin(), part.end(), std::max(part[i], part[j]), std::min(part[i], part[j]));
        for (const size_t p : part) ++size[p];
        const auto largest = static_cast<size_t>(std::max_element(size.begin(), size.end()) - size.begin());
        size_t kept = 0;
        for (size_t i = 0; i < n; ++i)
            if (part[i] == largest) exposed_[kept++] = exposed_[i];
        exposed_.resize(kept);
    }

    void look_across(const PatchNode& patch, size_t from, size_t to) {
        const Vec3 above = patch.normal * (low_ray * patch.radius),
                   along = exposed_[to].position - exposed_[from].position;
        const float distance = length(along);
        rays_.push_back({exposed_[from].position + above, 0, distance > 0 ? along / distance : patch.normal, distance});
    }

    /// Light on both sides of a pane is much the same, so only what stops more than half of it hides points.
    void trace_across() {
        passed_.resize(rays_.size());
        world_.geometry.rays().transmitted(rays_, passed_);
        progress_.count_rays(rays_.size());
        hidden_.clear();
        for (const Color& passed : passed_) hidden_.push_back(mean(passed) < 0.5f);
    }

    struct Exposed {
        Vec2 where;  // barycentric weights of the point
        Vec3 position;
        Met met;  // kind of surface that its ray hit
    };

    const World& world_;
    const PatchTree& tree_;
    const SurfaceOptions& options_;
    Progress& progress_;
    float share_ = 1;  // share of the samples that a patch takes
    std::vector<Ray> rays_;
    std::vector<Color> contributions_;
    std::vector<uint8_t> hidden_;
    std::vector<Color> passed_;
    std::vector<Hit> hits_;
    std::vector<Exposed> exposed_;  // exposed points of the patch
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

float stopped(const Geometry& geometry, uint32_t triangle, float stops, Vec3 position, Vec3 direction) {
    if (!geometry.material_of(triangle).pane) return 1;
    return (1 - mean(geometry.straight(hit_on_triangle(geometry, triangle, position), direction))) / stops;
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
