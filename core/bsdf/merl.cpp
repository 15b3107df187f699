// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "bsdf/merl.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "sampling/warp.h"

namespace eclat {

namespace {

/// Two neighbouring cells and the weight of the second, for a position in units of cells whose middles hold the values.
struct Between {
    size_t low, high;
    float weight;
};

Between clamped(float x, size_t count) {
    const float y = std::clamp(x - 0.5f, 0.0f, static_cast<float>(count - 1));
    const size_t low = std::min(static_cast<size_t>(y), count - 2);
    return {low, low + 1, y - static_cast<float>(low)};
}

Between periodic(float x, size_t count) {
    const float y = x - 0.5f, whole = std::floor(y);
    const auto n = static_cast<int>(count);
    const int low = (static_cast<int>(whole) % n + n) % n;
    return {static_cast<size_t>(low), static_cast<size_t>((low + 1) % n), y - whole};
}

/// The border θ_h of cell i.
double border(size_t i) {
    const double x = static_cast<double>(i) / MerlBrdf::half_angles;
    return x * x * M_PI / 2;
}

double squared(double x) { return x * x; }

}  // namespace

MerlBrdf::MerlBrdf(std::span<const float> values) : values_(cells) {
    require(values.size() == 3 * cells,
            "MERL: expected 3 x 90 x 90 x 180 values, got " + std::to_string(values.size()));
    for (size_t i = 0; i < cells; ++i) {
        values_[i] = max(Color(values[i], values[cells + i], values[2 * cells + i]), Color());
        require(is_finite(values_[i]), "MERL: expected finite values");
    }
    // Directions up to 45° from the half vector stand for all: beyond, Fresnel's reflectance hides the shape.
    constexpr size_t used = difference_angles / 2;
    std::vector<double> mean(half_angles), weights(half_angles);
    for (size_t h = 0; h < half_angles; ++h) {
        for (size_t i = 0; i < used * difference_azimuths; ++i)
            mean[h] += luminance(values_[h * difference_angles * difference_azimuths + i]);
        mean[h] /= static_cast<double>(used * difference_azimuths);
        weights[h] = mean[h] * (squared(std::cos(border(h))) - squared(std::cos(border(h + 1))));
    }
    // Cells without light keep a chance, because the mean may be 0 where other angles are not.
    const double least = 1e-3 * *std::max_element(weights.begin(), weights.end());
    for (double& w : weights) w = std::max(w, least);
    half_ = PiecewiseConstant1D(weights);
    // The value at θ_h of 60° is that of the diffuse base, which a cosine lobe of albedo π f samples best.
    const double base = M_PI * mean[static_cast<size_t>(std::sqrt(60.0 / 90) * half_angles)];
    // The albedo at normal incidence is ∫ f cos 2θ_h · 4 cos θ_h dω_h, to 45°.
    double albedo = 1e-9;
    for (size_t h = 0; h < half_angles; ++h)
        albedo += 4 * M_PI * weights[h] * std::max(0.0, std::cos(border(h) + border(h + 1)));
    cosine_share_ = static_cast<float>(std::clamp(base / albedo, 0.1, 0.9));
    integrate();
}

Color MerlBrdf::value(Vec3 wi, Vec3 half) const {
    // The frame of the half vector: t is its direction of rising θ_h, b completes it.
    const float sine = std::sqrt(half.x * half.x + half.y * half.y);
    const Vec3 t = sine > 0 ? Vec3{half.x * half.z / sine, half.y * half.z / sine, -sine} : Vec3{1, 0, 0};
    const Vec3 b = cross(half, t);
    const float x = dot(wi, t), y = dot(wi, b), z = dot(wi, half);
    const float theta_h = std::atan2(sine, half.z), theta_d = std::atan2(std::sqrt(x * x + y * y), z);
    const Between i = clamped(std::sqrt(theta_h * (2 / pi)) * half_angles, half_angles);
    const Between j = clamped(theta_d * (2 / pi) * difference_angles, difference_angles);
    const Between k = periodic(std::atan2(y, x) * (difference_azimuths / pi), difference_azimuths);
    const auto row = [&](size_t h, size_t d) {
        const Color* cell = &values_[(h * difference_angles + d) * difference_azimuths];
        return cell[k.low] * (1 - k.weight) + cell[k.high] * k.weight;
    };
    const auto plane = [&](size_t h) { return row(h, j.low) * (1 - j.weight) + row(h, j.high) * j.weight; };
    return plane(i.low) * (1 - i.weight) + plane(i.high) * i.weight;
}

/// The density of half vectors in solid angle.
float MerlBrdf::pdf_of_half(float cosine) const {
    const float theta = std::acos(std::clamp(cosine, 0.0f, 1.0f));
    const auto i = std::min(static_cast<size_t>(std::sqrt(theta * (2 / pi)) * half_angles), half_angles - 1);
    const double ring = 2 * M_PI * (std::cos(border(i)) - std::cos(border(i + 1)));
    return static_cast<float>(half_.pdf_discrete(static_cast<uint32_t>(i)) / ring);
}

EvalPdf MerlBrdf::eval(Vec3 wo, Vec3 wi) const {
    if (!(wo.z > 0 && wi.z > 0)) return {};
    const Vec3 half = normalize(wo + wi);
    const float of_half = pdf_of_half(half.z) / (4 * dot(wo, half));
    return {value(wi, half), cosine_share_ * wi.z * inv_pi + (1 - cosine_share_) * of_half};
}

Vec3 MerlBrdf::direction(Vec3 wo, Vec2 u) const {
    if (u.x < cosine_share_) return square_to_cosine_hemisphere({u.x / cosine_share_, u.y});
    const DiscreteSample s = half_.sample((u.x - cosine_share_) / (1 - cosine_share_));
    const auto low = static_cast<float>(std::cos(border(s.index))),
               high = static_cast<float>(std::cos(border(s.index + 1)));
    const float cosine = std::lerp(low, high, s.remapped), sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
    const Vec3 half{sine * std::cos(2 * pi * u.y), sine * std::sin(2 * pi * u.y), cosine};
    return reflected(wo, half);
}

}  // namespace eclat
