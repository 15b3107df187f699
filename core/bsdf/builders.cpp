// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Construction of the lobes of a BSDF from the parameters of a material.

#include "bsdf/bsdf.h"

namespace eclat {

namespace {

/// Reflection by one interface, a mirror where it is smooth; `through` as in `RoughReflectionLobe`.
Lobe interface_lobe(const Microfacets& facets, bool smooth, const InterfaceReflectance& reflectance, bool through) {
    if (smooth) return MirrorLobe{reflectance, through};
    return RoughReflectionLobe{facets, reflectance, through};
}

Lobe dielectric_lobe(float ior, float alpha_u, float alpha_v, const DielectricTint& tint, Distribution distribution) {
    // Facets that hardly bend light do not blur it either, and between equal media there is no half vector of
    // refraction at all: straight through is the limit (pbrt-v4 does the same; Mitsuba 3 refuses equal indices).
    const bool bends = std::abs(ior - 1) > 1e-3f;
    if (!bends || Microfacets::smooth(alpha_u, alpha_v)) return SmoothDielectricLobe{ior, tint};
    return RoughDielectricLobe{{alpha_u, alpha_v, distribution}, ior, tint};
}

}  // namespace

Bsdf make_diffuse(Color reflectance) { return Bsdf::lambertian(reflectance); }

Bsdf make_phong(Color diffuse, Color specular, float exponent) {
    Bsdf bsdf;
    bsdf.add(LambertLobe{}, diffuse);
    bsdf.add(PhongLobe{std::max(exponent, 0.0f)}, specular);
    return bsdf;
}

Bsdf make_ward(Color diffuse, Color specular, float alpha_u, float alpha_v) {
    Bsdf bsdf;
    bsdf.add(LambertLobe{}, diffuse);
    bsdf.add(WardLobe{std::max(alpha_u, smallest_alpha), std::max(alpha_v, smallest_alpha)}, specular);
    return bsdf;
}

Bsdf make_conductor(Color eta, Color k, Color specular, float alpha_u, float alpha_v, Distribution distribution,
                    Masking masking) {
    Bsdf bsdf;
    bsdf.add(interface_lobe({alpha_u, alpha_v, distribution, masking}, Microfacets::smooth(alpha_u, alpha_v),
                            InterfaceReflectance::conductor(eta, k), false),
             specular);
    return bsdf;
}

Bsdf make_dielectric(float ior, float alpha_u, float alpha_v, Color reflection, Color transmission,
                     Distribution distribution) {
    Bsdf bsdf;
    bsdf.add(dielectric_lobe(ior, alpha_u, alpha_v, {reflection, transmission}, distribution), Color(1));
    return bsdf;
}

Bsdf make_thin_dielectric(float ior, Color reflection, Color transmission) {
    Bsdf bsdf;
    bsdf.add(ThinDielectricLobe{ior, {reflection, transmission}}, Color(1));
    return bsdf;
}

Bsdf make_measured(const MeasuredBrdf& brdf, Color scale) {
    Bsdf bsdf;
    bsdf.add(MeasuredLobe{&brdf}, scale);
    return bsdf;
}

Bsdf make_translucent(Color reflectance, Color transmittance) {
    Bsdf bsdf;
    bsdf.add(LambertLobe{}, reflectance);
    bsdf.add(DiffuseTransmissionLobe{}, transmittance);
    return bsdf;
}

Bsdf make_plastic(const PlasticTable& table, Color diffuse, Color specular, Distribution distribution, bool nonlinear) {
    Bsdf bsdf;
    bsdf.add(CoatedDiffuseLobe{&table}, plastic_base_weight(table, diffuse, nonlinear));
    bsdf.add(interface_lobe({table.alpha, table.alpha, distribution}, table.alpha == 0,
                            InterfaceReflectance::dielectric(table.ior), false),
             specular);
    return bsdf;
}

Bsdf make_metallic_roughness(const MetallicRoughness& p) {
    const float metal = p.metallic, dielectric = 1 - metal;
    const float through = dielectric * p.transmission, solid_through = p.thin ? 0 : through;
    const Color f0 = min(p.specular_color * fresnel_normal(p.ior), Color(1)) * p.specular;
    const float f90 = p.specular;
    const Microfacets facets(p.alpha, p.alpha, Distribution::ggx, Masking::correlated);
    const bool smooth = Microfacets::smooth(p.alpha, p.alpha);

    Bsdf bsdf;
    const float diffuse = dielectric - through, turned = 1 - p.diffuse_transmission;
    bsdf.add(CoupledDiffuseLobe(smooth ? 0 : p.alpha, max_component(f0), f90), p.base_color * (diffuse * turned));
    // The light that the specular lobe reflects at normal incidence does not reach the diffuse base, neither on the way
    // in nor on the way out.
    bsdf.add(DiffuseTransmissionLobe{}, p.diffuse_transmission_color * (diffuse * p.diffuse_transmission *
                                                                        (1 - std::min(max_component(f0), 1.0f))));

    // Metal and dielectric share facets, and Schlick's reflectance is linear: one lobe is their mixture.
    const float opaque = dielectric - solid_through;
    const auto outside = InterfaceReflectance::schlick(p.base_color * metal + f0 * opaque, Color(metal + f90 * opaque));
    if (metal + opaque > 0) bsdf.add(interface_lobe(facets, smooth, outside, false), Color(1));

    const Color tint = p.base_color * through;
    if (p.thin)
        bsdf.add(interface_lobe(facets, smooth, InterfaceReflectance::schlick(f0, Color(f90)), true), tint);
    else if (through > 0) {
        const Color reflection = min(p.specular_color * p.specular, Color(1));
        bsdf.add(dielectric_lobe(p.ior, p.alpha, p.alpha, {reflection, p.base_color}, Distribution::ggx),
                 Color(through));
    }
    return bsdf;
}

}  // namespace eclat
