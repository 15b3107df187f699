// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "hemisphere/radiance_rotation.h"

#include <algorithm>

#include "hemisphere/radiance_projection.h"

namespace eclat {

void turn_coefficients(int order, float cosine, float sine, float* c) {
    float re = cosine, im = sine;
    for (int m = 1; m < order; ++m) {
        for (int l = m; l < order; ++l) {
            float &a = c[coefficient_index(l, m)], &b = c[coefficient_index(l, -m)];
            const float turned = re * a - im * b;
            b = im * a + re * b;
            a = turned;
        }
        const float next = re * cosine - im * sine;
        im = re * sine + im * cosine;
        re = next;
    }
}

RadianceRotation::RadianceRotation(int order)
    : order_(order), factors_(size_t(order) * size_t(order) * size_t(order)), ladder_(size_t(polar_count(order))) {
    const HemisphereFit fit(order, radiance_tikhonov);
    for (int m = 0; m < order; ++m)
        for (int l = m; l < order; ++l) {
            for (int k = m; k <= l; ++k) factors_[index(l, k, m)] = float(fit.factor(l, k, m));
            // √2 where cos 0φ = 1 meets √2 cos φ.
            ladder_[size_t(polar_index(l, m))] = float(0.5 * std::sqrt((l - m) * (l + m + 1.0) * (m == 0 ? 2 : 1)));
        }
}

void RadianceRotation::operator()(const Frame& from, const Frame& to, int order, float* c) const {
    // R = R_z(α) R_y(β) R_z(γ) has from's normal at azimuth α and height cos β in `to`, and to's at azimuth π − γ in `from`.
    const Vec3 normal = to.to_local(from.n), back = from.to_local(to.n);
    const float sin_beta = std::sqrt(normal.x * normal.x + normal.y * normal.y);
    constexpr float least_tilt = 1e-3f;  // rad; times the order, what is neglected
    if (sin_beta < least_tilt) {
        const float cosine = dot(from.u, to.u), sine = dot(from.u, to.v);
        const float scale = 1 / std::sqrt(cosine * cosine + sine * sine);
        if (std::fabs(sine) > 1e-5f || cosine < 0) turn_coefficients(order, cosine * scale, sine * scale, c);
        return;
    }
    const float scale = 1 / std::sqrt(back.x * back.x + back.y * back.y);
    turn_coefficients(order, -back.x * scale, back.y * scale, c);
    tilt(std::atan2(sin_beta, normal.z), order, c);
    turn_coefficients(order, normal.x / sin_beta, normal.y / sin_beta, c);
}

void RadianceRotation::tilt(float angle, int order, float* c) const {
    for (int m = 1 - order; m < order; ++m)  // c ↦ L c
        for (int l = order - 1, n = std::abs(m); l >= n; --l) {
            float sum = 0;
            for (int k = n; k <= l; ++k) sum += factors_[index(l, k, n)] * c[coefficient_index(k, m)];
            c[coefficient_index(l, m)] = sum;
        }
    // exp(β J) = Σ (β J)ᵏ / k!; J links neighbouring m of a band only, is skew and has eigenvalues up to i (order − 1).
    constexpr float tolerance = 1e-3f;
    float term[144], next[144];
    const auto count = size_t(coefficient_count(order));
    std::copy_n(c, count, term);
    const float reach = angle * static_cast<float>(order - 1);
    float rest = reach;
    for (int k = 1; rest > tolerance && k < 64; ++k) {
        const float scale = angle / static_cast<float>(k);
        for (int l = 0; l < order; ++l) {
            const float* ladder = &ladder_[size_t(polar_index(l, 0))];
            const float* in = term + coefficient_index(l, 0);
            float* out = next + coefficient_index(l, 0);
            for (int m = 0; m <= l; ++m) {
                float with_cos = 0, with_sin = 0;
                if (m > 0) {
                    with_cos += ladder[m - 1] * in[m - 1];
                    if (m > 1) with_sin += ladder[m - 1] * in[1 - m];
                }
                if (m < l) {
                    with_cos -= ladder[m] * in[m + 1];
                    if (m > 0) with_sin -= ladder[m] * in[-m - 1];
                }
                out[m] = with_cos * scale;
                if (m > 0) out[-m] = with_sin * scale;
            }
        }
        for (size_t i = 0; i < count; ++i) {
            term[i] = next[i];
            c[i] += term[i];
        }
        rest *= reach / static_cast<float>(k + 1);
    }
    for (int m = 1 - order; m < order; ++m)  // c ↦ L⁻¹ c
        for (int n = std::abs(m), l = n; l < order; ++l) {
            float& out = c[coefficient_index(l, m)];
            for (int k = n; k < l; ++k) out -= factors_[index(l, k, n)] * c[coefficient_index(k, m)];
            out /= factors_[index(l, l, n)];
        }
}

}  // namespace eclat
