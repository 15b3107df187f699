// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A pane of glass as one surface: the reflection and transmission of its two parallel faces, summed over all bounces between
// them. Transmitted light keeps its direction.
//
// References   [Stokes62] the sum over bounces

#pragma once

#include "bsdf/dielectric.h"

namespace eclat {

struct ThinDielectricLobe {
    static constexpr bool is_diffuse = false, is_delta = true;
    float ior = 1.5f;
    DielectricTint tint;

    /// R + T² R (1 + R² + …) = 2R / (1 + R) where T = 1 − R.
    float reflectance(float cos_theta) const {
        const float r = fresnel_dielectric(std::abs(cos_theta), ior).reflectance;
        return 2 * r / (1 + r);
    }

    EvalPdf eval(Vec3, Vec3) const { return {}; }

    bool sample(Vec3 wo, float u_lobe, Vec2, BsdfSample& s) const {
        if (wo.z == 0) return false;
        const float r = reflectance(wo.z), p = tint.reflect_probability(r);
        s.delta = true;
        s.transmission = s.straight = u_lobe >= p;
        s.wi = {-wo.x, -wo.y, s.transmission ? -wo.z : wo.z};
        s.weight = s.transmission ? tint.transmission * ((1 - r) / (1 - p)) : tint.reflection * (r / p);
        s.pdf_solid_angle = s.transmission ? 1 - p : p;
        return true;
    }

    /// Returns the share of light that passes straight through.
    Color straight(Vec3 wo) const { return tint.transmission * (1 - reflectance(wo.z)); }

    Color albedo(Vec3 wo) const { return tint.albedo(reflectance(wo.z)); }
};

}  // namespace eclat
