// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Plastic: a diffuse base under a dielectric coat, smooth or rough. Light enters through the coat, is scattered by the
// base, returns in part from the coat's inside to be scattered again, and leaves.
//
// References   [Walter07] the coat, [Duntley42] the inside of a smooth coat
//
// Symbol       name here               meaning
//   T(μ)       transmittance           what the coat lets in of light at cosine μ
//   R_in       internal_reflectance    what it sends back of diffuse light from inside
//
// Departures   Light that meets a rough coat's facets twice is lost. T and R_in of rough coats are those of Mitsuba 3.

#pragma once

#include <array>

#include "bsdf/bsdf_sample.h"
#include "bsdf/fresnel.h"
#include "bsdf/microfacet.h"
#include "sampling/warp.h"

namespace eclat {

/// The values that depend only on the refractive index and the roughness of a coat. They are computed once per material
/// and must outlive the BSDFs that use them.
struct PlasticTable {
    static constexpr int size = 64;

    float ior = 1.5f, alpha = 0;
    float internal_reflectance = 0;
    float mean_transmittance = 1;                   ///< 2 ∫ T(μ) μ dμ
    std::array<float, size> rough_transmittance{};  ///< T at μ = i / (size − 1), for a rough coat

    float transmittance(float mu) const {
        if (alpha == 0) return 1 - fresnel_dielectric(mu, ior).reflectance;
        const float x = mu * (size - 1);
        const int i = std::min(int(x), size - 2);
        return lerp(rough_transmittance[size_t(i)], rough_transmittance[size_t(i) + 1], x - float(i));
    }
};

/// `alpha` below `smallest_alpha` is smooth. Takes milliseconds for a rough coat.
PlasticTable make_plastic_table(float ior, float alpha, Distribution distribution);

/// The base as seen through the coat, for a white base and without multiple internal reflection, which
/// `plastic_base_weight` includes.
struct CoatedDiffuseLobe {
    static constexpr bool is_diffuse = true, is_delta = false;
    const PlasticTable* table = nullptr;

    EvalPdf eval(Vec3 wo, Vec3 wi) const {
        if (!(wo.z > 0 && wi.z > 0)) return {};
        return {Color(inv_pi * table->transmittance(wo.z) * table->transmittance(wi.z)), wi.z * inv_pi};
    }

    bool sample(Vec3 wo, float, Vec2 u, BsdfSample& s) const {
        s.wi = square_to_cosine_hemisphere(u);
        if (!(wo.z > 0 && s.wi.z > 0)) return false;
        s.weight = Color(table->transmittance(wo.z) * table->transmittance(s.wi.z));
        s.pdf_solid_angle = s.wi.z * inv_pi;
        return true;
    }

    Color albedo(Vec3 wo) const {
        return wo.z > 0 ? Color(table->transmittance(wo.z) * table->mean_transmittance) : Color();
    }
};

/// All bounces between base and coat, and the η² by which radiance spreads on leaving. `nonlinear`: each bounce takes
/// the base's colour, which saturates it; else `kd` is the colour that is seen.
inline Color plastic_base_weight(const PlasticTable& table, Color kd, bool nonlinear) {
    const Color kept = (nonlinear ? kd : Color(1)) * table.internal_reflectance;
    return kd / (Color(1) - kept) * (1 / sqr(table.ior));
}

}  // namespace eclat
