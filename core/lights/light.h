// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// All lights of a scene. This is the interface of the folder.
//
// Emissive triangles, points, spots, measured luminaires, directional lights (suns) and an environment are sampled as one set: `sample`
// chooses a light and a direction, `pdf_solid_angle` and `environment_pdf_solid_angle` are its exact density for
// directions that a BSDF chose. Everything is const and thread-safe after construction, nothing has an absolute length.

#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "lights/area.h"
#include "lights/directional.h"
#include "lights/emission_discs.h"
#include "lights/environment.h"
#include "lights/light_sample.h"
#include "lights/light_sampler.h"
#include "lights/point.h"
#include "lights/profile.h"
#include "lights/spot.h"

namespace eclat {

struct LightInputs {
    std::span<const EmitterTriangle> triangles{};  // "emitter i" is triangles[i]
    std::vector<PointLight> points{};
    std::vector<SpotLight> spots{};
    std::vector<ProfileLight> profiles{};
    std::vector<DirectionalLight> directionals{};
    std::optional<EnvironmentImage> environment{};
    Vec3 scene_center{};  // of the sphere around the geometry
    float scene_radius = 0;
    std::vector<Ball> places{};  // where surfaces exchange light; if there are none, the whole scene is one
};

/// What one light sample needs: where the light arrives, and uniform random numbers from [0, 1).
struct LightQuery {
    Vec3 position;
    float u_light = 0;
    Vec2 u;
};

class Lights {
  public:
    Lights() = default;
    /// Textures of emissions are borrowed.
    explicit Lights(LightInputs inputs);

    /// Light that may arrive at `position`, unoccluded; pdf 0 = nothing. Uniform random numbers from [0, 1).
    LightSample sample(Vec3 position, float u_light, Vec2 u, LightSet set = LightSet::all) const;
    /// Does the same for many at once, in less time: what all of them read from large tables is fetched together. `out`
    /// gets one sample for each query.
    void sample(std::span<const LightQuery> queries, LightSet set, std::span<LightSample> out) const;

    /// Radiance of emissive triangle `emitter` towards `wo`; `bary` are the weights of its second and third vertex.
    Color emitted(uint32_t emitter, Vec2 bary, Vec3 wo) const { return areas_[emitter].emitted(emissions_, bary, wo); }
    /// Density with which `sample` chooses the direction from `position` to `hit_position` on that triangle.
    float pdf_solid_angle(uint32_t emitter, Vec3 position, Vec3 hit_position, LightSet set = LightSet::all) const {
        return sampler_.pdf_discrete(set, LightKind::triangle, emitter) *
               areas_[emitter].pdf_solid_angle(position, hit_position);
    }

    /// Returns the radiance from infinity: of the environment image, if it is in `set`, and of the discs of suns.
    Color environment(Vec3 direction, LightSet set = LightSet::all) const { return infinite(direction, set).radiance; }
    /// Density of `sample` for a direction that leaves the scene.
    float environment_pdf_solid_angle(Vec3 direction, LightSet set = LightSet::all) const {
        return infinite(direction, set).pdf_solid_angle;
    }
    /// Returns both at once, in the time of one.
    struct Infinite {
        Color radiance;
        float pdf_solid_angle = 0;
    };
    Infinite infinite(Vec3 direction, LightSet set = LightSet::all) const;

    /// A photon from any light, chosen as by `sample`; infinite lights start it outside of the scene's sphere.
    PhotonSample emit(float u_light, Vec2 u_position, Vec2 u_direction) const;
    /// Power of all lights, W; of infinite lights what passes the discs before the places. Textured triangles are estimated.
    Color total_power() const { return total_power_; }

    size_t emitter_count() const { return areas_.size(); }
    const AreaLight& emitter(uint32_t i) const { return areas_[i]; }
    bool has_environment_image() const { return environment_.has_value(); }
    /// Returns the radiance from infinity that is not in `set`, which escaping rays find and light sampling with that
    /// set leaves out.
    Color left_out(Vec3 direction, LightSet set) const {
        if (!environment_ || set == LightSet::all) return Color();
        return environment_->smooth_radiance(direction);
    }
    /// Returns whether there is no light, or only black ones.
    bool dark() const { return sampler_.empty(); }

  private:
    const EnvironmentImage* image_of(LightKind kind) const;
    void sample_group(std::span<const LightQuery> queries, LightSet set, std::span<LightSample> out) const;
    LightSample finish(const LightQuery& query, LightSet set, const LightSampler::Choice& choice,
                       const EnvironmentImage::Search& search) const;
    void add_image(Vec3 direction, LightSet set, Infinite& out) const;
    void add_discs(Vec3 direction, LightSet set, Infinite& out) const;
    std::vector<double> add_triangles(std::span<const EmitterTriangle> triangles);

    std::vector<AreaLight> areas_;
    std::vector<Value> emissions_;  // emissions of textured lights
    std::vector<PointLight> points_;
    std::vector<SpotLight> spots_;
    std::vector<ProfileLight> profiles_;
    std::vector<DirectionalLight> directionals_;
    std::vector<uint32_t> discs_;  // the directional lights with an extent
    std::optional<EnvironmentImage> environment_;
    std::optional<EnvironmentImage> sharp_environment_;  // sharp part, which is direct light in every set
    EmissionDiscs discs_of_emission_;
    LightSampler sampler_;
    Color total_power_;
};

}  // namespace eclat
