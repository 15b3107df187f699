// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Photon mapping, second pass [Jensen01]. At a vertex that the camera sees, directly or after glossy lobes:
//
//   emission                  what the ray meets, weighted against light sampling after a glossy lobe
//   direct                    by light sampling: all of the diffuse lobes', the glossy lobes' weighted
//   caustics                  light that met glossy lobes only: density of the caustic map, ρ / π · E
//   diffuse interreflection   looked up in the global map, or gathered: diffuse rays to what the point sees
//   glossy lobes              the path goes on, to the next vertex that the camera sees
//
// At a vertex that a gather ray meets, directly or after glossy lobes: direct light and photons of both maps by its diffuse
// lobes; no emission and no light through its glossy lobes, which the first vertex has as direct light and as caustics.
// So each path of light belongs to exactly one term.
//
// Where the gather ray was shorter than the disc of an estimate, in corners, photons would blur what is near: it goes on
// by one more diffuse ray.
//
// References   [Jensen01], [Christensen99] irradiance precomputed at photons
// Bias         Blur of caustics; what gather rays see is blurred too. docs/algorithms/photon_map.md
// Held to      tests/methods/test_photon_map.py, tests/methods/test_caustics.py

#include "methods/photon_map/photon_gathering.h"

#include <algorithm>

#include "base/parallel.h"
#include "sampling/mis.h"

namespace eclat {

namespace {

// As in transport/paths.cpp.
constexpr float shadow_shortening = 1 - 0x1p-13f;
constexpr int roulette_depth = 3;

enum class Arrival : uint8_t { whole, weighted };

struct State {
    Color throughput{1};
    Sampler sampler;
    uint32_t index;
    float pdf = 0;   // of the ray's direction
    float eta2 = 1;  // radiance scaling by refraction
    Arrival arrival = Arrival::whole;
    bool gathering = false;
    Vec3 from;
};

struct Shadow {
    Color contribution;
    uint32_t index;
    bool direct;
};

class Gatherer {
  public:
    Gatherer(const World& world, const PhotonMaps& maps, const PhotonMapOptions& options, std::span<PathResult> out,
             Progress& progress)
        : world_(world), maps_(maps), options_(options), out_(out), progress_(progress) {}

    void run(std::span<const PathRay> rays) {
        for (uint32_t i = 0; i < rays.size(); ++i) {
            rays_.push_back(rays[i].ray);
            states_.push_back({.sampler = rays[i].sampler, .index = i, .from = rays[i].ray.origin});
        }
        for (edges_ = 1; !states_.empty(); ++edges_) {
            hits_.resize(rays_.size());
            world_.geometry.rays().intersect(rays_, hits_, edges_ == 1 ? Coherence::camera : Coherence::none);
            progress_.count_rays(rays_.size());
            for (size_t i = 0; i < states_.size(); ++i) advance(states_[i], rays_[i], hits_[i]);
            states_.swap(next_states_);
            rays_.swap(next_rays_);
            next_states_.clear();
            next_rays_.clear();
            resolve_shadows();
        }
    }

  private:
    bool may_have(int edges) const { return options_.max_depth < 0 || edges <= options_.max_depth; }

    void add(uint32_t index, Color radiance, bool direct) {
        out_[index].radiance += radiance;
        if (direct) out_[index].direct += radiance;
    }

    void advance(State& s, const Ray& ray, const Hit& hit) {
        if (hit.missed()) {
            if (!s.gathering) add_environment(s, ray.direction);
            return;
        }
        const Vec3 wo = -ray.direction;
        const SurfacePoint point = world_.geometry.surface_point(hit, wo);
        const Vec3 wo_local = point.frame.to_local(wo);
        if (edges_ == 1) {
            PathResult& first = out_[s.index];
            first.distance = hit.t;
            first.normal = point.frame.n;
            first.albedo = point.bsdf.albedo(wo_local);
        }
        if (!s.gathering) add_emission(s, hit, point, wo);
        if (!may_have(edges_ + 1)) return;
        sample_light(s, point, wo_local);
        if (const Color albedo = point.bsdf.diffuse_albedo(wo_local); !is_black(albedo))
            add_diffuse(s, point, wo, wo_local, albedo, hit.t);
        if (point.bsdf.has(LobeSet::glossy)) {
            State next = s;
            next.sampler.skip(6);
            go_on(next, point, wo_local, LobeSet::glossy);
        }
    }

    void add_environment(const State& s, Vec3 w) {
        const Lights::Infinite sampled = world_.lights.infinite(w);
        const float weight = s.arrival == Arrival::whole ? 1 : power_heuristic(s.pdf, sampled.pdf_solid_angle);
        add(s.index, s.throughput * sampled.radiance * weight, edges_ <= 2);
    }

    void add_emission(const State& s, const Hit& hit, const SurfacePoint& point, Vec3 wo) {
        const uint32_t emitter = world_.emitter(hit.triangle);
        if (emitter == not_emitting) return;
        const Color radiance = world_.lights.emitted(emitter, {hit.u, hit.v}, wo);
        if (is_black(radiance)) return;
        const float weight =
            s.arrival == Arrival::whole
                ? 1
                : power_heuristic(s.pdf, world_.lights.pdf_solid_angle(emitter, s.from, point.position));
        add(s.index, s.throughput * radiance * weight, edges_ <= 2);
    }

    /// Direct light: the diffuse lobes take all of it; the glossy lobes, where no gather leads here, their weighted part.
    void sample_light(State& s, const SurfacePoint& point, Vec3 wo) {
        const float u = s.sampler.next_1d();
        const Vec2 uv = s.sampler.next_2d();
        if (!point.bsdf.has_non_delta()) return;
        const LightSample light = world_.lights.sample(point.position, u, uv);
        if (!(light.pdf_solid_angle > 0) || is_black(light.radiance)) return;
        const Vec3 wi = point.frame.to_local(light.wi);
        if (wi.z * dot(light.wi, point.normal) <= 0) return;  // the shading normal and the surface disagree
        Color f = point.bsdf.eval(wo, wi, LobeSet::diffuse).f;
        if (!s.gathering) {
            const EvalPdf glossy = point.bsdf.eval(wo, wi, LobeSet::glossy);
            f += glossy.f * (light.delta ? 1 : power_heuristic(light.pdf_solid_angle, glossy.pdf_solid_angle));
        }
        if (is_black(f)) return;
        const Color contribution = s.throughput * f * light.radiance * (std::fabs(wi.z) / light.pdf_solid_angle);
        shadow_rays_.push_back(point.ray(light.wi, light.distance * shadow_shortening));
        shadows_.push_back({contribution, s.index, edges_ == 1});
    }

    /// Indirect light that the diffuse lobes reflect.
    void add_diffuse(const State& s, const SurfacePoint& point, Vec3 wo, Vec3 wo_local, Color albedo, float distance) {
        const DensityPoint at(point, wo);
        const Color reflected = s.throughput * albedo * inv_pi;
        if (s.gathering) {
            const auto far = far_irradiance(world_, maps_, at, distance, max_photon_edges(), progress_);
            if (far) return add(s.index, reflected * *far, false);
        } else if (options_.gather_rays == 0) {
            const Color diffuse = density(maps_.global, at, maps_.reading.global);
            return add(s.index, reflected * (diffuse + density(maps_.caustic, at, maps_.reading.caustic)), false);
        }
        add(s.index, reflected * density(maps_.caustic, at, maps_.reading.caustic), false);
        const auto parts = static_cast<uint32_t>(edges_ == 1 ? options_.gather_rays : 1);
        for (uint32_t part = 0; part < parts; ++part) {
            State next = s;
            next.sampler = s.sampler.split(parts, part);
            next.throughput *= 1 / static_cast<float>(parts);
            next.gathering = true;
            go_on(next, point, wo_local, LobeSet::diffuse);
        }
    }

    Color density(const PhotonMap& map, const DensityPoint& at, DensityOptions options) {
        options.max_edges = max_photon_edges();
        return estimate_irradiance(world_, map, at, options, progress_).irradiance;
    }

    /// Of photons' paths that are not too long with that of the camera.
    int max_photon_edges() const { return options_.max_depth < 0 ? -1 : options_.max_depth - edges_; }

    /// One more edge by `lobes`, if it survives.
    void go_on(State& s, const SurfacePoint& point, Vec3 wo, LobeSet lobes) {
        const float u_lobe = s.sampler.next_1d();
        const Vec2 u = s.sampler.next_2d();
        const float u_roulette = s.sampler.next_1d();
        const auto sample = point.bsdf.sample(wo, u_lobe, u, lobes);
        if (!sample) return;
        const Vec3 wi = point.frame.to_world(sample->wi);
        if (dot(wi, point.normal) * sample->wi.z <= 0) return;
        s.throughput *= sample->weight;
        if (sample->transmission) s.eta2 *= sqr(sample->eta_ratio);
        if (edges_ >= roulette_depth) {
            const float survival = std::min(0.95f, max_component(s.throughput) * s.eta2);  // [ArvoKirk90]
            if (!(u_roulette < survival)) return;
            s.throughput *= 1 / survival;
        }
        if (!(max_component(s.throughput) > 0)) return;
        s.from = point.position;
        s.pdf = sample->pdf_solid_angle;
        s.arrival = sample->delta ? Arrival::whole : Arrival::weighted;
        next_states_.push_back(s);
        next_rays_.push_back(point.ray(wi));
    }

    void resolve_shadows() {
        occluded_.resize(shadow_rays_.size());
        world_.geometry.rays().occluded(shadow_rays_, occluded_);
        progress_.count_rays(shadow_rays_.size());
        for (size_t i = 0; i < shadows_.size(); ++i)
            if (!occluded_[i]) add(shadows_[i].index, shadows_[i].contribution, shadows_[i].direct);
        shadow_rays_.clear();
        shadows_.clear();
    }

    const World& world_;
    const PhotonMaps& maps_;
    const PhotonMapOptions& options_;
    std::span<PathResult> out_;
    Progress& progress_;
    int edges_ = 0;  // of all paths under way, the one that is traced included
    std::vector<State> states_, next_states_;
    std::vector<Ray> rays_, next_rays_;  // of each state
    std::vector<Hit> hits_;
    std::vector<Ray> shadow_rays_;
    std::vector<Shadow> shadows_;
    std::vector<uint8_t> occluded_;
};

}  // namespace

void trace_to_photons(const World& world, const PhotonMaps& maps, const PhotonMapOptions& options,
                      std::span<const PathRay> rays, std::span<PathResult> out, Progress& progress) {
    std::fill(out.begin(), out.end(), PathResult{});
    Gatherer(world, maps, options, out, progress).run(rays);
}

std::vector<Color> photon_irradiance(const World& world, std::span<const PointNormal> points, const PhotonMaps& maps,
                                     const PointIrradianceOptions& options, Progress& progress) {
    // The maps hold light of any depth. Points need not lie on a surface, where photons are: caustics are found by paths.
    if (options.max_depth >= 0) return path_irradiance(world, points, options, progress);
    return path_irradiance(world, points, options, progress, [&](const SurfacePoint& point, float distance) {
        return far_irradiance(world, maps, {point, point.frame.n}, distance, -1, progress);
    });
}

}  // namespace eclat
