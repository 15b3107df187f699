// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Lambert's lobe: the reflected radiance, or that transmitted by paper, cloth or leaves, is the same in all directions.

#pragma once

#include "bsdf/bsdf_sample.h"
#include "sampling/warp.h"

namespace eclat {

/// Reflectance 1; the colour is the weight in the sum of lobes.
struct LambertLobe {
    static constexpr bool is_diffuse = true, is_delta = false;

    EvalPdf eval(Vec3 wo, Vec3 wi) const {
        if (!(wo.z > 0 && wi.z > 0)) return {};
        return {Color(inv_pi), wi.z * inv_pi};
    }

    bool sample(Vec3 wo, float, Vec2 u, BsdfSample& s) const {
        s.wi = square_to_cosine_hemisphere(u);
        s.weight = Color(1);
        s.pdf_solid_angle = s.wi.z * inv_pi;
        return wo.z > 0 && s.wi.z > 0;
    }

    Color albedo(Vec3 wo) const { return Color(wo.z > 0 ? 1 : 0); }
};

/// A lobe with transmittance 1 to the other side, which is the same from both sides. It belongs to the translucent and
/// not to the diffuse lobes, because records of the other side give its light.
struct DiffuseTransmissionLobe {
    static constexpr bool is_diffuse = false, is_delta = false;

    EvalPdf eval(Vec3 wo, Vec3 wi) const {
        if (!(wo.z * wi.z < 0)) return {};
        return {Color(inv_pi), std::abs(wi.z) * inv_pi};
    }

    bool sample(Vec3 wo, float, Vec2 u, BsdfSample& s) const {
        s.wi = square_to_cosine_hemisphere(u);
        s.weight = Color(1);
        s.pdf_solid_angle = s.wi.z * inv_pi;
        s.transmission = true;
        if (wo.z > 0) s.wi = mirrored(s.wi);
        return wo.z * s.wi.z < 0;
    }

    Color albedo(Vec3 wo) const { return Color(wo.z != 0 ? 1 : 0); }
};

}  // namespace eclat
