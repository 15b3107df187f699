// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "transport/paths.h"

#include "sampling/mis.h"

namespace eclat {

namespace {

// A shadow ray ends this fraction short of the light, so that it does not meet the light itself: a point sampled in
// solid angle is found by intersecting the light's plane, to some hundred ulps.
constexpr float shadow_shortening = 1 - 0x1p-13f;

/// How much of the light that a direction finds has not been counted by next-event estimation.
enum class Arrival : uint8_t { whole, weighted, none };

struct State {
    Color throughput{1};
    Sampler sampler;
    uint32_t index;
    float pdf = 0;   // of the ray's direction, summed over the paths that share its last vertex
    float eta2 = 1;  // radiance scaling by refraction, which roulette must not mistake for absorption
    Arrival arrival;
    Vec3 from;
};

struct Shadow {
    Color contribution;
    uint32_t index;
    bool direct;
};

class Tracer {
  public:
    Tracer(const World& world, const PathOptions& options, std::span<PathResult> out, Progress& progress)
        : world_(world), options_(options), out_(out), progress_(progress) {}

    void run(std::span<const PathRay> rays) {
        start(rays);
        for (edges_ = 1; !states_.empty(); ++edges_) {
            hits_.resize(rays_.size());
            world_.geometry.rays().intersect(rays_, hits_, edges_ == 1 ? options_.coherence : Coherence::none);
            progress_.count_rays(rays_.size());
            shadow_rays_.clear();
            shadows_.clear();
            const size_t going_on = advance_all();
            states_.erase(states_.begin() + static_cast<ptrdiff_t>(going_on), states_.end());
            rays_.resize(going_on);
            states_.insert(states_.end(), split_states_.begin(), split_states_.end());
            rays_.insert(rays_.end(), split_rays_.begin(), split_rays_.end());
            split_states_.clear();
            split_rays_.clear();
            resolve_shadows();
            progress_.count_rays(shadow_rays_.size());
        }
    }

  private:
    void start(std::span<const PathRay> rays) {
        states_.reserve(rays.size());
        rays_.reserve(rays.size());
        const Arrival arrival = options_.emission_at_first_hit ? Arrival::whole : Arrival::none;
        for (uint32_t i = 0; i < rays.size(); ++i) {
            rays_.push_back(rays[i].ray);
            states_.push_back({.sampler = rays[i].sampler, .index = i, .arrival = arrival, .from = rays[i].ray.origin});
        }
    }

    /// Follow all paths over the edge that was traced; those that go on move to the front. Returns how many.
    size_t advance_all() {
        size_t kept = 0;
        for (size_t i = 0; i < states_.size(); ++i) {
            prefetch(i);
            if (!advance(states_[i], rays_[i], hits_[i])) continue;
            if (kept != i) {
                states_[kept] = states_[i];
                rays_[kept] = rays_[i];
            }
            ++kept;
        }
        return kept;
    }

    /// What the hits after the i-th will read lies anywhere in a large scene.
    void prefetch(size_t i) const {
        constexpr size_t for_face = 12, for_vertices = 6;  // hits ahead, about as long as memory takes to answer
        if (i + for_face < hits_.size() && !hits_[i + for_face].missed())
            world_.geometry.prefetch_face(hits_[i + for_face].triangle);
        if (i + for_vertices < hits_.size() && !hits_[i + for_vertices].missed())
            world_.geometry.prefetch_vertices(hits_[i + for_vertices].triangle);
    }

    bool may_have(int edges) const { return options_.max_depth < 0 || edges <= options_.max_depth; }

    void add(uint32_t index, Color radiance, bool direct) {
        out_[index].radiance += radiance;
        if (direct) out_[index].direct += radiance;
    }

    /// Follow one path over the edge `ray` that ended at `hit`; true where it goes on, along `ray`.
    bool advance(State& s, Ray& ray, const Hit& hit) {
        if (hit.missed()) {
            add_environment(s, ray.direction);
            return false;
        }
        const Vec3 wo = -ray.direction;
        SurfacePoint point = world_.geometry.surface_point(hit, wo);
        const Vec3 wo_local = point.frame.to_local(wo);
        if (edges_ == 1) {
            PathResult& first = out_[s.index];
            first.distance = hit.t;
            first.normal = point.frame.n;
            first.behind = world_.geometry.has_no_back(hit.triangle) &&
                           dot(world_.geometry.geometric_normal(hit.triangle), wo) < 0;
            first.albedo = point.bsdf.albedo(wo_local);
        }
        add_emission(s, hit, point, wo);
        if (!may_have(edges_ + 1)) return false;

        if (options_.cache && point.bsdf.has(LobeSet::diffuse)) {
            auto irradiance = options_.cache(point, hit.t);
            if (!irradiance && edges_ > 1 && options_.far_cache) irradiance = options_.far_cache(point, hit.t);
            if (irradiance) {
                add(s.index, s.throughput * point.bsdf.diffuse_albedo(wo_local) * *irradiance * inv_pi, false);
                point.bsdf.set_cached(LobeSet::diffuse);
            } else {
                out_[s.index].cache_missed = true;
            }
        }
        if (options_.reflection && point.bsdf.has(LobeSet::glossy)) reflect(s, point, wo_local);
        const int parts = paths_from(s, point);
        sample_lights(s, point, wo_local, parts);
        if (parts > 1) return split_path(s, point, wo_local, parts);
        return continue_path(s, ray, point, wo_local);
    }

    /// How many paths go on from the vertex that was met.
    int paths_from(const State& s, const SurfacePoint& point) const {
        if (edges_ > 1) return 1;
        if (out_[s.index].cache_missed) return options_.miss_paths;
        return point.bsdf.has_uncached_rough_gloss() ? options_.gloss_paths : 1;
    }

    /// Takes what a cache knows of lobes that are not diffuse.
    void reflect(const State& s, SurfacePoint& point, Vec3 wo) {
        const Color reflected = options_.reflection(point, wo);
        add(s.index, s.throughput * reflected, false);
        if (edges_ > 1) return;
        out_[s.index].gloss_cached = !is_black(reflected);
        out_[s.index].gloss_traced = point.bsdf.has_uncached_gloss();
    }

    /// Goes on from the first vertex in many directions, stratified together.
    bool split_path(const State& s, const SurfacePoint& point, Vec3 wo, int parts) {
        for (int part = 0; part < parts; ++part) {
            State state = s;
            Ray ray;
            state.sampler = s.sampler.split(static_cast<uint32_t>(parts), static_cast<uint32_t>(part));
            state.throughput *= 1 / static_cast<float>(parts);
            if (!continue_path(state, ray, point, wo)) continue;
            state.pdf *= static_cast<float>(parts);
            split_states_.push_back(state);
            split_rays_.push_back(ray);
        }
        return false;
    }

    void add_environment(const State& s, Vec3 w) {
        const Lights::Infinite sampled = world_.lights.infinite(w, options_.light_set);
        Color radiance = sampled.radiance;
        if (s.arrival == Arrival::none) radiance = Color();
        if (s.arrival == Arrival::weighted)
            radiance *= power_heuristic(s.pdf, static_cast<float>(light_samples(edges_ - 1)) * sampled.pdf_solid_angle);
        // What light sampling leaves out arrives whole.
        if (options_.light_set == LightSet::without_environment_image)
            radiance += world_.lights.environment(w) - sampled.radiance;
        add(s.index, s.throughput * radiance, edges_ <= 2);
    }

    void add_emission(const State& s, const Hit& hit, const SurfacePoint& point, Vec3 wo) {
        const uint32_t emitter = world_.emitter(hit.triangle);
        if (emitter == not_emitting || s.arrival == Arrival::none) return;
        const Color radiance = world_.lights.emitted(emitter, {hit.u, hit.v}, wo);
        if (is_black(radiance)) return;
        float weight = 1;
        if (s.arrival == Arrival::weighted)
            weight = power_heuristic(
                s.pdf, static_cast<float>(light_samples(edges_ - 1)) *
                           world_.lights.pdf_solid_angle(emitter, s.from, point.position, options_.light_set));
        add(s.index, s.throughput * radiance * weight, edges_ <= 2);
    }

    /// Light samples that the vertex at the end of that many edges takes.
    int light_samples(int edges) const { return edges == 1 ? options_.light_samples : 1; }

    /// `parts`: of the paths that go on, which find lights as well.
    void sample_lights(State& s, const SurfacePoint& point, Vec3 wo, int parts) {
        const int count = light_samples(edges_);
        if (point.bsdf.has_non_delta())
            for (int i = 0; i < count; ++i)
                sample_light(s, s.sampler.split(static_cast<uint32_t>(count), static_cast<uint32_t>(i)), point, wo,
                             parts);
        s.sampler.skip(2);
    }

    void sample_light(const State& s, Sampler sampler, const SurfacePoint& point, Vec3 wo, int parts) {
        const float u = sampler.next_1d();
        const LightSample light = world_.lights.sample(point.position, u, sampler.next_2d(), options_.light_set);
        if (!(light.pdf_solid_angle > 0) || is_black(light.radiance)) return;
        const Vec3 wi = point.frame.to_local(light.wi);
        if (wi.z * dot(light.wi, point.normal) <= 0) return;  // the shading normal and the surface disagree
        // All samples of the vertex together are one technique, of so many times the density.
        const float density = static_cast<float>(light_samples(edges_)) * light.pdf_solid_angle;
        Color f;
        if (point.bsdf.has(LobeSet::cached)) f = point.bsdf.eval(wo, wi, LobeSet::cached).f;
        const EvalPdf e = point.bsdf.eval(wo, wi, LobeSet::uncached);
        f += e.f * (light.delta ? 1 : power_heuristic(density, static_cast<float>(parts) * e.pdf_solid_angle));
        if (is_black(f)) return;
        const Color contribution = s.throughput * f * light.radiance * (std::fabs(wi.z) / density);
        shadow_rays_.push_back(point.ray(light.wi, light.distance * shadow_shortening));
        shadows_.push_back({contribution, s.index, edges_ == 1});
    }

    bool continue_path(State& s, Ray& ray, const SurfacePoint& point, Vec3 wo) {
        const bool roulette = edges_ >= options_.roulette_depth;
        const float u_lobe = draw_if(point.bsdf.chooses_lobe(), s.sampler);
        const Vec2 u = s.sampler.next_2d();
        const float u_roulette = draw_if(roulette, s.sampler);
        const auto sample = point.bsdf.sample(wo, u_lobe, u, LobeSet::uncached);
        if (!sample) return false;
        const Vec3 wi = point.frame.to_world(sample->wi);
        if (dot(wi, point.normal) * sample->wi.z <= 0) return false;
        s.throughput *= sample->weight;
        if (sample->transmission) s.eta2 *= sqr(sample->eta_ratio);
        if (roulette) {
            const float survival = std::min(0.95f, max_component(s.throughput) * s.eta2);  // [ArvoKirk90]
            if (u_roulette >= survival) return false;
            s.throughput *= 1 / survival;
        }
        if (!(max_component(s.throughput) > 0)) return false;
        ray = point.ray(wi);
        s.from = point.position;
        s.pdf = sample->pdf_solid_angle;
        s.arrival = sample->delta ? Arrival::whole : Arrival::weighted;
        return true;
    }

    /// The sampler's next number; 0 where nobody will look at it, which costs nothing.
    static float draw_if(bool wanted, Sampler& sampler) {
        if (wanted) return sampler.next_1d();
        sampler.skip(1);
        return 0;
    }

    void resolve_shadows() {
        occluded_.resize(shadow_rays_.size());
        world_.geometry.rays().occluded(shadow_rays_, occluded_);
        for (size_t i = 0; i < shadows_.size(); ++i)
            if (!occluded_[i]) add(shadows_[i].index, shadows_[i].contribution, shadows_[i].direct);
    }

    const World& world_;
    const PathOptions& options_;
    std::span<PathResult> out_;
    Progress& progress_;
    int edges_ = 0;  // of all paths under way, the one that is traced included
    std::vector<State> states_;
    std::vector<Ray> rays_;  // of each state
    std::vector<State> split_states_;
    std::vector<Ray> split_rays_;
    std::vector<Ray> shadow_rays_;
    std::vector<Hit> hits_;
    std::vector<Shadow> shadows_;
    std::vector<uint8_t> occluded_;
};

}  // namespace

void trace_paths(const World& world, std::span<const PathRay> rays, const PathOptions& options,
                 std::span<PathResult> out, Progress& progress) {
    std::fill(out.begin(), out.end(), PathResult{});
    Tracer(world, options, out, progress).run(rays);
}

std::optional<ShadowRay> sample_irradiance(const World& world, const SurfacePoint& point, Vec3 n, LightSet set,
                                           Sampler& sampler) {
    const float u = sampler.next_1d();
    const Vec2 uv = sampler.next_2d();
    const LightSample light = world.lights.sample(point.position, u, uv, set);
    const float cosine = dot(light.wi, n);
    if (!(light.pdf_solid_angle > 0) || cosine <= 0) return std::nullopt;
    return ShadowRay{point.ray(light.wi, light.distance * shadow_shortening),
                     light.radiance * (cosine / light.pdf_solid_angle)};
}

}  // namespace eclat
