// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "bsdf/measured.h"

#include <algorithm>
#include <cmath>

namespace eclat {

bool MeasuredBrdf::sample(Vec3 wo, Vec2 u, BsdfSample& s) const {
    if (!(wo.z > 0)) return false;
    s.wi = direction(wo, u);
    if (!(s.wi.z > 0)) return false;
    const EvalPdf e = eval(wo, s.wi);
    if (!(e.pdf_solid_angle > 0)) return false;
    s.weight = e.f * (s.wi.z / e.pdf_solid_angle);
    s.pdf_solid_angle = e.pdf_solid_angle;
    return true;
}

Color MeasuredBrdf::albedo(Vec3 wo) const {
    if (!(wo.z > 0)) return {};
    const float x = std::min(wo.z, 1.0f) * (albedo_nodes - 1);
    const size_t i = std::min(static_cast<size_t>(x), albedo_nodes - 2);
    const float t = x - static_cast<float>(i);
    return albedo_[i] * (1 - t) + albedo_[i + 1] * t;
}

void MeasuredBrdf::integrate() {
    // The albedo weights lobes and guides the denoiser, so that a few per cent of noise do no harm.
    // Points of a lattice, because samplers divide the square by lines that a grid might just miss.
    constexpr int count = 1024, azimuths = 4;
    constexpr float golden = 0.6180339887f;
    for (size_t node = 0; node < albedo_nodes; ++node) {
        // At the horizon itself nothing is visible; the first node stands for the strip above it.
        const float cosine = std::max(static_cast<float>(node), 0.25f) / (albedo_nodes - 1);
        const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
        Color sum;
        for (int a = 0; a < azimuths; ++a) {
            const float angle = (static_cast<float>(a) + 0.3f) * (2 * pi / azimuths);
            const Vec3 wo{sine * std::cos(angle), sine * std::sin(angle), cosine};
            for (int i = 0; i < count; ++i) {
                const float turns = golden * static_cast<float>(i);
                const Vec2 u{(static_cast<float>(i) + 0.5f) / count, turns - std::floor(turns)};
                BsdfSample s;
                if (sample(wo, u, s)) sum += s.weight;
            }
        }
        const Color mean = sum / static_cast<float>(count * azimuths);
        largest_albedo_ = std::max(largest_albedo_, max_component(mean));
        albedo_[node] = min(mean, Color(1));
    }
}

}  // namespace eclat
