// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Reflection by rough or smooth interfaces: metals, coats, Schlick's approximation; also, for thin sheets, the light
// that passes straight through with the same blur.
//
// References   [Walter07] the facet model, [BornWolf99], [Schlick94]

#pragma once

#include "bsdf/albedo_table.h"
#include "bsdf/bsdf_sample.h"
#include "bsdf/fresnel.h"
#include "bsdf/microfacet.h"

namespace eclat {

/// The reflectance of a facet as a function of the cosine of incidence.
struct InterfaceReflectance {
    enum class Kind : uint8_t { conductor, dielectric, schlick };

    Kind kind = Kind::schlick;
    Color a{1}, b{1};  // conductor: eta, k; dielectric: a.r is the index, a.g the reflectance at 0°; schlick: F0, F90

    static InterfaceReflectance conductor(Color eta, Color k) { return {Kind::conductor, eta, k}; }
    static InterfaceReflectance dielectric(float ior) {
        return {Kind::dielectric, {ior, fresnel_normal(ior), 0}, Color()};
    }
    static InterfaceReflectance schlick(Color f0, Color f90) { return {Kind::schlick, f0, f90}; }

    Color operator()(float cos_i) const {
        switch (kind) {
            case Kind::conductor: return fresnel_conductor(cos_i, a, b);
            case Kind::dielectric: return Color(fresnel_dielectric(cos_i, a.r).reflectance);
            default: return fresnel_schlick(cos_i, a, b);
        }
    }

    /// Albedo of facets of roughness `alpha` seen at cosine `cos_o`; Schlick's approximation stands for all kinds.
    Color albedo(float cos_o, float alpha) const {
        const SplitAlbedo s = split_albedo(cos_o, alpha);
        switch (kind) {
            case Kind::conductor: return fresnel_conductor(1, a, b) * s.f0 + Color(s.f90);
            case Kind::dielectric: return Color(a.g * s.f0 + s.f90);
            default: return a * s.f0 + b * s.f90;
        }
    }
};

/// Rough reflection. With `through`, its mirror image below the surface with what reflection leaves: the blurred view
/// through a thin sheet, which has the same two rough faces.
struct RoughReflectionLobe {
    static constexpr bool is_diffuse = false, is_delta = false;
    Microfacets facets;
    InterfaceReflectance reflectance;
    bool through = false;

    Color passed(float cos_i) const { return through ? Color(1) - reflectance(cos_i) : reflectance(cos_i); }

    EvalPdf eval(Vec3 wo, Vec3 wi) const {
        if (through && wo.z < 0) wo = mirrored(wo), wi = mirrored(wi);
        if (through) wi = mirrored(wi);
        if (!(wo.z > 0 && wi.z > 0)) return {};
        const Vec3 m = normalize(wo + wi);
        const float density = facets.density(m);
        return {passed(dot(wo, m)) * (density * facets.visibility(wo, wi)),  // [Walter07 eq. 20]
                density / (4 * facets.visible_area(wo))};                    // [Heitz14b], mirrored
    }

    bool sample(Vec3 wo, float, Vec2 u, BsdfSample& s) const {
        const bool from_below = through && wo.z < 0;
        if (from_below) wo = mirrored(wo);
        if (!(wo.z > 0)) return false;
        const Vec3 m = facets.sample_visible_normal(wo, u);
        const Vec3 wi = reflected(wo, m);
        if (!(wi.z > 0)) return false;
        // F · G2 / G1
        s.weight = passed(dot(wo, m)) * (4 * wi.z * facets.visible_area(wo) * facets.visibility(wo, wi));
        s.pdf_solid_angle = facets.density(m) / (4 * facets.visible_area(wo));
        s.wi = through != from_below ? mirrored(wi) : wi;
        s.transmission = through;
        return s.pdf_solid_angle > 0;
    }

    Color albedo(Vec3 wo) const {
        if (!(wo.z > 0) && !through) return {};
        const float cos_o = std::abs(wo.z), alpha = std::sqrt(facets.alpha_u * facets.alpha_v);
        const Color r = reflectance.albedo(cos_o, alpha);
        return through ? max(split_albedo(cos_o, alpha).white() - r, Color()) : r;
    }
};

/// The limit of the rough interface for a roughness of 0.
struct MirrorLobe {
    static constexpr bool is_diffuse = false, is_delta = true;
    InterfaceReflectance reflectance;
    bool through = false;

    EvalPdf eval(Vec3, Vec3) const { return {}; }

    bool sample(Vec3 wo, float, Vec2, BsdfSample& s) const {
        if (!(wo.z > 0) && !through) return false;
        s.wi = {-wo.x, -wo.y, through ? -wo.z : wo.z};
        s.weight = albedo(wo);
        s.pdf_solid_angle = 1;
        s.delta = true;
        s.transmission = s.straight = through;
        return true;
    }

    /// Returns the share of light that passes straight through.
    Color straight(Vec3 wo) const { return through ? albedo(wo) : Color(); }

    Color albedo(Vec3 wo) const {
        if (!(wo.z > 0) && !through) return {};
        const Color r = reflectance(std::abs(wo.z));
        return through ? Color(1) - r : r;
    }
};

}  // namespace eclat
