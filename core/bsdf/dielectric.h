// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Interfaces of a dielectric solid: reflection and refraction, rough or smooth. The index `ior` is that of the inside
// (z < 0) over the outside.
//
// References   [Walter07] rough refraction, [Veach97] radiance across an interface
//
// Symbol       name here   meaning
//   η          eta         index on the side of wi over the side of wo, for refraction
//
// Radiance is scaled by 1 / η² when it crosses: eval is reciprocal only as η_i² f(wo, wi) = η_o² f(wi, wo).

#pragma once

#include "bsdf/bsdf_sample.h"
#include "bsdf/fresnel.h"
#include "bsdf/microfacet.h"

namespace eclat {

/// The colours that multiply the two parts, and the choice between them.
struct DielectricTint {
    Color reflection{1}, transmission{1};

    /// Probability to reflect where the interface reflects `reflectance`: in proportion to what either part carries.
    float reflect_probability(float reflectance) const {
        const float r = reflectance * luminance(reflection), t = (1 - reflectance) * luminance(transmission);
        return r + t > 0 ? r / (r + t) : 0;
    }
    Color albedo(float reflectance) const { return reflection * reflectance + transmission * (1 - reflectance); }
};

struct RoughDielectricLobe {
    static constexpr bool is_diffuse = false, is_delta = false;
    Microfacets facets;
    float ior = 1.5f;
    DielectricTint tint;

    EvalPdf eval(Vec3 wo, Vec3 wi) const {
        // wo is mirrored to the upper side, because the facets are the same from both sides.
        const float eta = wo.z > 0 ? ior : 1 / ior;
        if (wo.z < 0) wo = mirrored(wo), wi = mirrored(wi);
        if (wo.z == 0 || wi.z == 0) return {};
        return wi.z > 0 ? eval_reflection(wo, wi, eta) : eval_refraction(wo, wi, eta);
    }

    bool sample(Vec3 wo, float u_lobe, Vec2 u, BsdfSample& s) const {
        const bool from_below = wo.z < 0;
        const float eta = from_below ? 1 / ior : ior;
        if (from_below) wo = mirrored(wo);
        if (!(wo.z > 0)) return false;

        const Vec3 m = facets.sample_visible_normal(wo, u);
        const float cos_o = dot(wo, m);
        if (!(cos_o > 0)) return false;
        const Refraction f = fresnel_dielectric(cos_o, eta);
        s.transmission = u_lobe >= tint.reflect_probability(f.reflectance);
        s.wi = s.transmission ? refracted(wo, m, cos_o, f.cos_t, eta) : reflected(wo, m);
        s.eta_ratio = s.transmission ? eta : 1;
        if (s.transmission ? !(s.wi.z < 0 && f.cos_t > 0) : !(s.wi.z > 0)) return false;

        const EvalPdf e = s.transmission ? eval_refraction(wo, s.wi, eta) : eval_reflection(wo, s.wi, eta);
        if (!(e.pdf_solid_angle > 0)) return false;
        s.weight = e.f * (abs_cos(s.wi) / e.pdf_solid_angle);
        s.pdf_solid_angle = e.pdf_solid_angle;
        if (from_below) s.wi = mirrored(s.wi);
        return true;
    }

    Color albedo(Vec3 wo) const {
        return tint.albedo(fresnel_dielectric(std::abs(wo.z), wo.z > 0 ? ior : 1 / ior).reflectance);
    }

  private:
    /// Evaluates the reflection, with both directions on the upper side.
    EvalPdf eval_reflection(Vec3 wo, Vec3 wi, float eta) const {
        const Vec3 m = normalize(wo + wi);
        const float r = fresnel_dielectric(dot(wo, m), eta).reflectance;
        const float density = facets.density(m);
        return {tint.reflection * (r * density * facets.visibility(wo, wi)),
                tint.reflect_probability(r) * density / (4 * facets.visible_area(wo))};
    }

    /// Evaluates the refraction, with wo on the upper side and wi below.
    EvalPdf eval_refraction(Vec3 wo, Vec3 wi, float eta) const {
        // Half vector towards the thinner side [Walter07 eq. 16], turned up.
        const Vec3 h = wo + wi * eta;
        const float h2 = length_squared(h);
        if (!(h2 > 0)) return {};
        const Vec3 m = h * (std::copysign(1.0f, h.z) / std::sqrt(h2));
        const float cos_o = dot(wo, m), cos_i = -dot(wi, m);
        if (!(cos_o > 0 && cos_i > 0 && m.z > 0)) return {};
        const float r = fresnel_dielectric(cos_o, eta).reflectance;
        const float density = facets.density(m);
        // (cos_o − η cos_i)² is |h|²: the sum in [Walter07 eq. 17, 21], without their η² in f, which the change of
        // radiance cancels.
        const float f = (1 - r) * density * 4 * facets.visibility(wo, mirrored(wi)) * cos_o * cos_i / h2;
        const float jacobian = eta * eta * cos_i / h2;
        return {tint.transmission * f,
                (1 - tint.reflect_probability(r)) * density * cos_o / facets.visible_area(wo) * jacobian};
    }
};

struct SmoothDielectricLobe {
    static constexpr bool is_diffuse = false, is_delta = true;
    float ior = 1.5f;
    DielectricTint tint;

    EvalPdf eval(Vec3, Vec3) const { return {}; }

    bool sample(Vec3 wo, float u_lobe, Vec2, BsdfSample& s) const {
        if (wo.z == 0) return false;
        const float eta = wo.z > 0 ? ior : 1 / ior;
        const Refraction f = fresnel_dielectric(std::abs(wo.z), eta);
        const float p = tint.reflect_probability(f.reflectance);
        s.delta = true;
        s.transmission = u_lobe >= p;
        if (!s.transmission) {
            s.wi = {-wo.x, -wo.y, wo.z};
            s.weight = tint.reflection * (f.reflectance / p);
            s.pdf_solid_angle = p;
            return true;
        }
        s.wi = {-wo.x / eta, -wo.y / eta, -std::copysign(f.cos_t, wo.z)};
        s.weight = tint.transmission * ((1 - f.reflectance) / ((1 - p) * eta * eta));
        s.pdf_solid_angle = 1 - p;
        s.eta_ratio = eta;
        return f.cos_t > 0;
    }

    Color albedo(Vec3 wo) const {
        return tint.albedo(fresnel_dielectric(std::abs(wo.z), wo.z > 0 ? ior : 1 / ior).reflectance);
    }
};

}  // namespace eclat
