// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Light that comes straight from lights to a point in space or on a surface, as weighted directions: light samples find
// small lamps, directions that the receiver samples find what is large and near, and the two are weighted as techniques of
// one estimator [Veach97 §9]. Light samples alone are noisy close to large lights; directions alone miss lamps.
//
// Symbol   name here    meaning
//   L(ω)     radiance     what arrives along −ω straight from lights, through panes
//   f(ω)     –            what the caller integrates: the cosine for irradiance, a harmonic for a probe
//   N        samples      light samples; there are `directions` · N directions
//
// Each technique calls `add(ω, w L(ω) / p(ω))` for its directions ω, of density p and weight w. In the mean over the N
// samples, the sum of these numbers times f(ω) has the expectation ∫ L(ω) f(ω) dω.

#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "base/progress.h"
#include "sampling/mis.h"
#include "sampling/sampler.h"
#include "sampling/warp.h"
#include "transport/world.h"

namespace eclat {

/// Receives light from the side of a point's normal, by the cosine.
struct HemisphereReceiver {
    const SurfacePoint& point;

    Vec3 position() const { return point.position; }
    Ray ray(Vec3 w) const { return point.ray(w); }
    Ray ray_to_light(const LightSample& s) const { return point.ray_to_light(s.wi, s.distance, s.clearance); }
    Vec3 direction(Vec2 u) const { return point.frame.to_world(square_to_cosine_hemisphere(u)); }
    /// The density of `direction`, which is 0 where no light is received.
    float pdf_solid_angle(Vec3 w) const { return std::max(0.0f, dot(w, point.normal)) * inv_pi; }
};

/// Receives light from the side of a point's normal, from all directions alike.
struct HalfSpaceReceiver {
    SurfacePoint point;

    Vec3 position() const { return point.position; }
    Ray ray(Vec3 w) const { return point.ray(w); }
    Ray ray_to_light(const LightSample& s) const { return point.ray_to_light(s.wi, s.distance, s.clearance); }
    Vec3 direction(Vec2 u) const { return point.frame.to_world(square_to_uniform_hemisphere(u)); }
    float pdf_solid_angle(Vec3 w) const { return dot(w, point.normal) > 0 ? 0.5f * inv_pi : 0; }
};

/// Receives light from all sides of a point in space.
struct SphereReceiver {
    Vec3 at;

    Vec3 position() const { return at; }
    Ray ray(Vec3 w) const { return {at, 0, w, infinity}; }
    Ray ray_to_light(const LightSample& s) const {
        if (s.distance == infinity) return ray(s.wi);
        return SurfacePoint::ray_between(at, {}, s.wi * s.distance + s.clearance);
    }
    Vec3 direction(Vec2 u) const { return square_to_uniform_sphere(u); }
    float pdf_solid_angle(Vec3) const { return uniform_sphere_pdf_solid_angle(); }
};

template <class Receiver>
class ArrivingLight {
  public:
    /// `directions`: the number of directions for each light sample.
    ArrivingLight(const World& world, const Receiver& receiver, LightSet set, float directions)
        : world_(world), receiver_(receiver), set_(set), directions_(directions) {}

    /// Takes one light sample with each sampler.
    template <class Add>
    void sample_lights(std::span<Sampler> samplers, Progress& progress, Add&& add) {
        queries_.clear();
        for (Sampler& sampler : samplers) {
            const float u = sampler.next_1d();
            queries_.push_back({receiver_.position(), u, sampler.next_2d()});
        }
        lights_.resize(queries_.size());
        world_.lights.sample(queries_, set_, lights_);
        rays_.clear();
        towards_.clear();
        contributions_.clear();
        for (const LightSample& light : lights_) {
            const float other = receiver_.pdf_solid_angle(light.wi);
            if (!(light.pdf_solid_angle > 0) || !(other > 0)) continue;
            const float weight = light.delta ? 1 : power_heuristic(light.pdf_solid_angle, directions_ * other);
            rays_.push_back(receiver_.ray_to_light(light));
            contributions_.push_back(light.radiance * (weight / light.pdf_solid_angle));
            towards_.push_back(light.wi);
        }
        passed_.resize(rays_.size());
        world_.geometry.rays().transmitted(rays_, passed_);
        progress.count_rays(rays_.size());
        for (size_t i = 0; i < rays_.size(); ++i) add(towards_[i], contributions_[i] * passed_[i]);
    }

    /// Takes the light that arrives along `directions`, which the receiver sampled.
    template <class Add>
    void meet_lights(std::span<const Vec3> directions, Progress& progress, Add&& add) {
        rays_.clear();
        for (const Vec3 w : directions) rays_.push_back(receiver_.ray(w));
        hits_.resize(rays_.size());
        world_.geometry.rays().intersect(rays_, hits_);
        progress.count_rays(rays_.size());
        for (size_t i = 0; i < rays_.size(); ++i) {
            const Vec3 w = rays_[i].direction;
            const float pdf = directions_ * receiver_.pdf_solid_angle(w);
            if (pdf > 0) add(w, arriving_through_panes(w, hits_[i], pdf) / pdf);
        }
    }

  private:
    /// Follows the direction through panes, which light samples pass too.
    Color arriving_through_panes(Vec3 w, Hit hit, float pdf) const {
        constexpr int most_panes = 64;  // more than any scene has one behind the other
        Color sum = arriving(w, hit, pdf), passed(1);
        for (int i = 0; i < most_panes && !hit.missed() && world_.geometry.material_of(hit.triangle).pane; ++i) {
            const SurfacePoint pane = world_.geometry.surface_point(hit, -w);
            passed *= pane.bsdf.straight(pane.frame.to_local(-w));
            if (is_black(passed)) break;
            const Ray ray = pane.ray(w);
            const float travelled = hit.t;
            world_.geometry.rays().intersect({&ray, 1}, {&hit, 1});
            if (!hit.missed()) hit.t += travelled;
            sum += passed * arriving(w, hit, pdf);
        }
        return sum;
    }

    /// Returns the radiance of what a direction of density `pdf` hits, without the share that light samples count.
    Color arriving(Vec3 w, const Hit& hit, float pdf) const {
        Color radiance;
        float pdf_of_lights = 0;
        if (hit.missed()) {
            const Lights::Infinite behind = world_.lights.infinite(w, set_);
            radiance = behind.radiance;
            pdf_of_lights = behind.pdf_solid_angle;
        } else if (const uint32_t emitter = world_.emitter(hit.triangle); emitter != not_emitting) {
            radiance = world_.lights.emitted(emitter, {hit.u, hit.v}, -w);
            pdf_of_lights =
                world_.lights.pdf_solid_angle(emitter, receiver_.position(), receiver_.position() + w * hit.t, set_);
        }
        if (is_black(radiance)) return {};
        return radiance * power_heuristic(pdf, pdf_of_lights);
    }

    const World& world_;
    Receiver receiver_;
    LightSet set_;
    float directions_;
    // These are scratch memory of a call.
    std::vector<LightQuery> queries_;
    std::vector<LightSample> lights_;
    std::vector<Ray> rays_;
    std::vector<Vec3>
        towards_;  // directions of the light samples, from which those of their rays differ by the offsets
    std::vector<Hit> hits_;
    std::vector<Color> contributions_, passed_;
};

}  // namespace eclat
