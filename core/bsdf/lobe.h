// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// One term of a BSDF: a kind, a colour that multiplies it, and the numbers of its kind.

#pragma once

#include <cstdint>
#include <optional>

#include "base/color.h"
#include "bsdf/fresnel.h"
#include "bsdf/microfacet.h"
#include "sampling/warp.h"

namespace eclat {

struct LobeEval {
    Color f;
    float pdf_solid_angle = 0;
};

struct LobeSample {
    Vec3 wi;
    Color weight;  // f · |cos| / pdf of this lobe alone
    float pdf_solid_angle = 1;
    bool transmission = false;
    float eta_ratio = 1;
};

struct Lobe {
    enum class Kind : uint8_t { lambert, coated_diffuse, phong, ward, reflection, refraction, thin };
    enum class Fresnel : uint8_t { conductor, schlick, dielectric };

    Kind kind = Kind::lambert;
    Fresnel fresnel = Fresnel::conductor;
    Color color{1};          // reflectance, or a factor of what the interface reflects
    Color transmittance{1};  // refraction, thin: a factor of what goes through
    Color eta, k{1};         // conductor's index; schlick: f0, f90
    float ior = 1.5f;        // dielectric: inside over outside
    float exponent = 1;      // phong
    float coat_reflectance = 0;  // coated_diffuse: the coat's reflectance for diffuse light from outside
    Microfacets facets{0, 0, false};

    bool diffuse() const { return kind == Kind::lambert || kind == Kind::coated_diffuse; }
    bool delta() const { return (kind == Kind::reflection || kind == Kind::refraction || kind == Kind::thin) && smooth(); }
    bool smooth() const { return kind == Kind::thin || facets.ax == 0; }

    LobeEval eval(Vec3 wo, Vec3 wi) const;
    std::optional<LobeSample> sample(Vec3 wo, float u_choice, Vec2 u) const;
    Color albedo(Vec3 wo) const;

  private:
    Color interface_reflectance(float cos_i) const;
    /// The part of light that enters a coated base, out of 1.
    float entering(float cos_theta) const { return 1 - fresnel_dielectric(cos_theta, ior).reflectance; }
    LobeEval eval_refraction(Vec3 wo, Vec3 wi) const;
    std::optional<LobeSample> sample_refraction(Vec3 wo, float u_choice, Vec2 u) const;
};

}  // namespace eclat
