// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Phong's lobe around the mirror direction, normalised so that it never reflects more light than arrives.
//
// References   [LafortuneWillems94] normalisation and sampling
//
// Symbol       name here   meaning
//   n          exponent    sharpness; 0 is wide, thousands nearly a mirror
//   α          –           angle between wi and the mirror direction of wo
//
// Departures   None: the part of the lobe below the horizon is lost, so the albedo is 1 at normal incidence and falls
//              to that of a clipped lobe at grazing angles.

#pragma once

#include "base/frame.h"
#include "bsdf/bsdf_sample.h"

namespace eclat {

struct PhongLobe {
    static constexpr bool is_diffuse = false, is_delta = false;
    float exponent = 30;

    EvalPdf eval(Vec3 wo, Vec3 wi) const {
        if (!(wo.z > 0 && wi.z > 0)) return {};
        const float cos_alpha = wo.z * wi.z - wo.x * wi.x - wo.y * wi.y;
        if (!(cos_alpha > 0)) return {};
        const float lobe = std::pow(std::min(cos_alpha, 1.0f), exponent) * (0.5f * inv_pi);
        return {Color((exponent + 2) * lobe), (exponent + 1) * lobe};  // [LafortuneWillems94]
    }

    bool sample(Vec3 wo, float, Vec2 u, BsdfSample& s) const {
        if (!(wo.z > 0)) return false;
        const float cos_alpha = std::pow(1 - u.x, 1 / (exponent + 1));
        const float sin_alpha = safe_sqrt((1 - cos_alpha) * (1 + cos_alpha));
        const float phi = 2 * pi * u.y;
        const Frame lobe = Frame::around({-wo.x, -wo.y, wo.z});
        s.wi = lobe.to_world({sin_alpha * std::cos(phi), sin_alpha * std::sin(phi), cos_alpha});
        s.weight = Color((exponent + 2) / (exponent + 1) * s.wi.z);
        s.pdf_solid_angle = (exponent + 1) * (0.5f * inv_pi) * std::pow(cos_alpha, exponent);
        return s.wi.z > 0 && s.pdf_solid_angle > 0;
    }

    /// Approximate: the mean of the positive part of cosθ_i, were it normally distributed over the lobe.
    Color albedo(Vec3 wo) const {
        if (!(wo.z > 0)) return {};
        const float deviation = safe_sqrt((1 - wo.z * wo.z) / (exponent + 3)) * (exponent + 2) / (exponent + 1);
        // x/2 + sqrt(x²/4 + s²/2π) is exact for both x = 0 and x ≫ s.
        const float mean_cos = 0.5f * (wo.z + std::sqrt(wo.z * wo.z + sqr(deviation) * (2 * inv_pi)));
        return Color(std::min(mean_cos, 1.0f));
    }
};

}  // namespace eclat
