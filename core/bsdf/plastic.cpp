// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "bsdf/plastic.h"

namespace eclat {

namespace {

struct FacetShares {
    float reflected = 0, refracted = 0;
};

/// The shares of light at cosine `mu` that rough facets reflect and refract, unmasked on the way out; `eta` is the
/// index beyond the facets over that before.
FacetShares facet_shares(float mu, float eta, float alpha, Distribution distribution) {
    constexpr int columns = 32, rows = 32;
    const Microfacets facets(alpha, alpha, distribution);
    const Vec3 wo{safe_sqrt(1 - mu * mu), 0, mu};
    // Midpoint rule over one half of what mirrors itself in the plane of incidence: of the azimuth, which is the first
    // number of GGX's samples, or of the slope across, the second of Beckmann's.
    const Vec2 extent = distribution == Distribution::ggx ? Vec2{0.5f, 1} : Vec2{1, 0.5f};
    double reflection = 0, refraction = 0;
    for (int i = 0; i < columns; ++i)
        for (int j = 0; j < rows; ++j) {
            const Vec2 u{(float(i) + 0.5f) / columns * extent.x, (float(j) + 0.5f) / rows * extent.y};
            const Vec3 m = facets.sample_visible_normal(wo, u);
            const float cos_o = dot(wo, m);
            const Refraction f = fresnel_dielectric(cos_o, eta);
            const Vec3 up = reflected(wo, m), down = refracted(wo, m, cos_o, f.cos_t, eta);
            if (up.z > 0) reflection += double(f.reflectance * facets.unmasked(up));
            if (down.z < 0) refraction += double((1 - f.reflectance) * facets.unmasked(mirrored(down)));
        }
    return {float(reflection / (columns * rows)), float(refraction / (columns * rows))};
}

/// 2 ∫ f(μ) μ dμ of values at μ = i / (size − 1), linear between.
float diffuse_mean(const std::array<float, PlasticTable::size>& values) {
    constexpr int n = PlasticTable::size - 1;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        const double a = double(values[size_t(i)]), b = double(values[size_t(i) + 1]);
        sum += (a * (3 * i + 1) + b * (3 * i + 2)) / 3;  // ∫ of the segment times 2μ, in units of 1 / n²
    }
    return float(sum / (double(n) * n));
}

}  // namespace

PlasticTable make_plastic_table(float ior, float alpha, Distribution distribution) {
    PlasticTable table;
    table.ior = ior;
    if (alpha < smallest_alpha) {
        table.internal_reflectance = diffuse_fresnel_reflectance(1 / ior);
        table.mean_transmittance = 1 - diffuse_fresnel_reflectance(ior);
        return table;
    }
    table.alpha = alpha;
    for (int i = 0; i < PlasticTable::size; ++i) {
        const float mu = std::max(float(i) / (PlasticTable::size - 1), 1e-6f);
        table.rough_transmittance[size_t(i)] = facet_shares(mu, ior, alpha, distribution).refracted;
        // By this rule, 2 ∫ R(μ) μ dμ is too small by 1 / size. Mitsuba uses the same rule, and pictures shall agree
        // with it.
        table.internal_reflectance +=
            2 * mu * facet_shares(mu, 1 / ior, alpha, distribution).reflected / PlasticTable::size;
    }
    table.mean_transmittance = diffuse_mean(table.rough_transmittance);
    return table;
}

}  // namespace eclat
