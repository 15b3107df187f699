// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "bsdf/albedo_table.h"

#include "bsdf/fresnel.h"
#include "bsdf/microfacet.h"

namespace eclat {

namespace {

// Midpoint rules; over the azimuth, periodic, they converge exponentially. With the interpolation they leave an error
// of 2e-3 at most in the albedo of a dielectric (F0 = 0.04), at grazing angles, and 7e-3 in that of a perfect mirror.
constexpr int azimuths = 16, heights = 32;

/// Computes the mean reflectance of the visible facets, split by Schlick's weight.
SplitAlbedo integrate(float cos_theta, float alpha) {
    if (alpha < smallest_alpha) {
        const float w = schlick_weight(cos_theta);
        return {1 - w, w};
    }
    const Microfacets facets(alpha, alpha, Distribution::ggx, Masking::correlated);
    const Vec3 wo{safe_sqrt(1 - cos_theta * cos_theta), 0, cos_theta};
    double f0 = 0, f90 = 0;
    for (int i = 0; i < azimuths; ++i)
        for (int j = 0; j < heights; ++j) {
            // Half of the azimuths suffice, because the other half mirrors them.
            const Vec3 m =
                facets.sample_visible_normal(wo, {0.5f * (float(i) + 0.5f) / azimuths, (float(j) + 0.5f) / heights});
            const Vec3 wi = m * (2 * dot(wo, m)) - wo;
            if (!(wi.z > 0)) continue;
            const float weight = 4 * wi.z * facets.visible_area(wo) * facets.visibility(wo, wi);
            const float w = schlick_weight(dot(wo, m));
            f0 += double(weight * (1 - w));
            f90 += double(weight * w);
        }
    return {float(f0 / (azimuths * heights)), float(f90 / (azimuths * heights))};
}

}  // namespace

AlbedoTable::AlbedoTable() {
    for (int i = 0; i < cos_count; ++i)
        for (int j = 0; j < alpha_count; ++j) {
            const float cos_theta = std::max(sqr(float(i) / (cos_count - 1)), 1e-6f);
            entries_[size_t(i * alpha_count + j)] = integrate(cos_theta, sqr(float(j) / (alpha_count - 1)));
        }
    for (int j = 0; j < alpha_count; ++j) {
        // E is linear in t = sqrt(μ) between entries, and 2 μ dμ = 4 t³ dt: Simpson's rule on each interval is exact to
        // the third degree, halving it makes the fourth negligible.
        double f0 = 0, f90 = 0;
        const auto add = [&](double t, double weight) {
            const detail::TablePosition c(float(t), cos_count);
            const SplitAlbedo e = detail::lerp(entry(c.index, j), entry(c.index + 1, j), c.fraction);
            f0 += weight * 4 * t * t * t * double(e.f0);
            f90 += weight * 4 * t * t * t * double(e.f90);
        };
        constexpr int intervals = 2 * (cos_count - 1);
        for (int i = 0; i < intervals; ++i) {
            const double h = 1.0 / intervals, t = i * h;
            add(t, h / 6);
            add(t + h / 2, 4 * h / 6);
            add(t + h, h / 6);
        }
        means_[size_t(j)] = {float(f0), float(f90)};
    }
}

const AlbedoTable albedo_table;

}  // namespace eclat
