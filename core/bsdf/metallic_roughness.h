// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The metallic-roughness model of glTF 2.0: one GGX interface over a mixture of metal, diffuse base and transmission.
//
// References   [glTF20] appendix B with KHR_materials_ior, _specular, _transmission, [Kelemen01] the diffuse base
//
// Symbol       name here   meaning
//   E(μ)       –           directional albedo of the dielectric interface: F0 · A + F90 · B of albedo_table.h
//
// Departures   glTF lets (1 − F) of the light at the half vector reach the base, which is neither reciprocal nor keeps
//              energy when mixed; here the base is (1 − E(μ_o)) (1 − E(μ_i)) / (1 − Ē), which is both: a white base
//              reflects exactly what the interface does not. Solid transmission uses the exact Fresnel equations.

#pragma once

#include "bsdf/albedo_table.h"
#include "bsdf/bsdf_sample.h"
#include "bsdf/fresnel.h"
#include "sampling/warp.h"

namespace eclat {

/// Diffuse base below a GGX interface, reciprocal [Kelemen01].
struct CoupledDiffuseLobe {
    static constexpr bool is_diffuse = true, is_delta = false;
    float alpha = 0.5f;
    float f0 = 0.04f, f90 = 1;    // of the interface: largest channel
    float inv_mean_entering = 1;  // 1 / (1 − Ē)

    CoupledDiffuseLobe() = default;
    CoupledDiffuseLobe(float alpha, float f0, float f90)
        : alpha(alpha),
          f0(f0),
          f90(f90),
          inv_mean_entering(1 / std::max(1 - albedo_table.mean(alpha).of(f0, f90), 1e-4f)) {}

    float entering(float mu) const { return std::max(1 - split_albedo(mu, alpha).of(f0, f90), 0.0f); }

    EvalPdf eval(Vec3 wo, Vec3 wi) const {
        if (!(wo.z > 0 && wi.z > 0)) return {};
        return {Color(inv_pi * entering(wo.z) * entering(wi.z) * inv_mean_entering), wi.z * inv_pi};
    }

    bool sample(Vec3 wo, float, Vec2 u, BsdfSample& s) const {
        s.wi = square_to_cosine_hemisphere(u);
        if (!(wo.z > 0 && s.wi.z > 0)) return false;
        s.weight = Color(entering(wo.z) * entering(s.wi.z) * inv_mean_entering);
        s.pdf_solid_angle = s.wi.z * inv_pi;
        return true;
    }

    Color albedo(Vec3 wo) const { return Color(wo.z > 0 ? entering(wo.z) : 0); }
};

}  // namespace eclat
