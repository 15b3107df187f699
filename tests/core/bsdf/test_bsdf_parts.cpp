// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Fresnel's equations, the distributions of facets and the tables, each against another way to the same number.

#include <doctest/doctest.h>

#include "bsdf/albedo_table.h"
#include "bsdf/beckmann.h"
#include "bsdf_cases.h"

using namespace eclat;
using namespace eclat::test;

namespace {

/// Closed form of the diffuse reflectance of a dielectric, n > 1 [Duntley42].
double duntley(double n) {
    const double n2 = n * n, n4 = n2 * n2;
    return 0.5 + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) +
           n2 * (n2 - 1) * (n2 - 1) / std::pow(n2 + 1, 3) * std::log((n - 1) / (n + 1)) -
           2 * n2 * n * (n2 + 2 * n - 1) / ((n2 + 1) * (n4 - 1)) +
           8 * n4 * (n4 + 1) / ((n2 + 1) * (n4 - 1) * (n4 - 1)) * std::log(n);
}

}  // namespace

TEST_CASE("dielectric reflectance: normal incidence, Brewster's angle, grazing, total reflection") {
    CHECK(fresnel_dielectric(1, 1.5f).reflectance == doctest::Approx(0.04));
    CHECK(fresnel_dielectric(0, 1.5f).reflectance == doctest::Approx(1));
    // At Brewster's angle tan θ = η only s-polarised light is reflected: half of ((η² − 1) / (η² + 1))².
    const float brewster = std::cos(std::atan(1.5f));
    CHECK(fresnel_dielectric(brewster, 1.5f).reflectance == doctest::Approx(0.5 * sqr(1.25f / 3.25f)));
    CHECK(fresnel_dielectric(std::cos(0.8f), 1 / 1.5f).reflectance == 1);
    CHECK(fresnel_dielectric(0.3f, 1).reflectance == 0);
    // The same interface from the other side, along the same path.
    const Refraction in = fresnel_dielectric(0.6f, 1.5f);
    CHECK(fresnel_dielectric(in.cos_t, 1 / 1.5f).reflectance == doctest::Approx(in.reflectance));
}

TEST_CASE("Schlick's reflectance: its ends, the fifth power between them, and near Fresnel's for glass") {
    CHECK(schlick_weight(1) == 0);
    CHECK(schlick_weight(0) == 1);
    CHECK(schlick_weight(0.5f) == doctest::Approx(1.0 / 32));
    CHECK(fresnel_schlick(0.5f, Color(0.2f, 0.4f, 0.6f), Color(1)).g == doctest::Approx(0.4 + 0.6 / 32));
    for (float cos_i = 0.05f; cos_i <= 1; cos_i += 0.05f)
        CHECK(std::abs(fresnel_schlick(cos_i, Color(0.04f), Color(1)).r - fresnel_dielectric(cos_i, 1.5f).reflectance) <
              0.05f);
}

TEST_CASE("a conductor without absorption is a dielectric; with only absorption it reflects all") {
    for (const float cos_i : {1.0f, 0.7f, 0.2f, 0.01f}) {
        CHECK(fresnel_conductor(cos_i, 1.5f, 0) ==
              doctest::Approx(fresnel_dielectric(cos_i, 1.5f).reflectance).epsilon(1e-4));
        CHECK(fresnel_conductor(cos_i, 0, 1) == doctest::Approx(1));
    }
    CHECK(fresnel_conductor(1, 0.2f, 3) == doctest::Approx((0.64 + 9) / (1.44 + 9)));
}

TEST_CASE("diffuse reflectance of a dielectric is its closed form, from both sides") {
    for (const float n : {1.1f, 1.33f, 1.5f, 2.0f, 3.0f}) {
        CHECK(diffuse_fresnel_reflectance(n) == doctest::Approx(duntley(double(n))).epsilon(1e-4));
        CHECK(diffuse_fresnel_reflectance(1 / n) ==
              doctest::Approx(1 - (1 - duntley(double(n))) / double(n * n)).epsilon(1e-4));
    }
}

TEST_CASE("facets' projected area is the surface's, and the visible area the integral of what faces the viewer") {
    for (const auto distribution : {Distribution::ggx, Distribution::beckmann}) {
        const Microfacets facets(0.3f, 0.6f, distribution);
        CHECK(integrate_sphere(200, [&](Vec3 m) { return m.z > 0 ? facets.density(m) * m.z : 0; }) ==
              doctest::Approx(1).epsilon(2e-3));
        for (const Vec3 w : directions_above()) {
            CAPTURE(w.z);
            const float seen = integrate_sphere(
                200, [&](Vec3 m) { return m.z > 0 ? facets.density(m) * std::max(dot(m, w), 0.0f) : 0; });
            CHECK(facets.visible_area(w) == doctest::Approx(seen).epsilon(2e-3));
            // Walter's fit of Beckmann's masking is off by 0.4 % at most.
            CHECK(facets.visibility(w, w) * 4 * seen * seen == doctest::Approx(1).epsilon(9e-3));
        }
    }
}

TEST_CASE("inverse error function") {
    for (const float x : {-0.99999f, -0.9f, -0.1f, 0.0f, 1e-4f, 0.5f, 0.95f, 0.9999f})
        CHECK(std::erf(double(inverse_erf(x))) == doctest::Approx(double(x)).epsilon(2e-6));
}

TEST_CASE("albedo table against integration over the hemisphere") {
    for (const float alpha : {0.15f, 0.4f, 0.77f, 1.0f})
        for (const Vec3 wo : {direction(5, 0), direction(45, 0), direction(70, 0), direction(85, 0)})
            for (const Vec2 f : {Vec2{1, 1}, Vec2{0.04f, 1}, Vec2{0.04f, 0.04f}}) {
                const RoughReflectionLobe lobe{{alpha, alpha, Distribution::ggx, Masking::correlated},
                                               InterfaceReflectance::schlick(Color(f.x), Color(f.y)),
                                               false};
                const float truth = integrate_sphere(200, [&](Vec3 wi) { return lobe.eval(wo, wi).f.r * abs_cos(wi); });
                CAPTURE(alpha);
                CAPTURE(wo.z);
                CHECK(split_albedo(wo.z, alpha).of(f.x, f.y) == doctest::Approx(truth).epsilon(0.004));
            }
}

TEST_CASE("albedo table's mean is the integral of its entries") {
    for (const float alpha : {0.0f, 0.3f, 0.9f}) {
        double f0 = 0;
        for (int i = 0; i < 20000; ++i) {
            const float mu = (float(i) + 0.5f) / 20000;
            f0 += double(split_albedo(mu, alpha).f0 * 2 * mu / 20000);
        }
        CHECK(albedo_table.mean(alpha).f0 == doctest::Approx(f0).epsilon(1e-4));
    }
}

TEST_CASE("a rough coat's table tends to the smooth one and ends in sensible numbers") {
    const PlasticTable smooth = make_plastic_table(1.5f, 0, Distribution::ggx);
    for (const auto distribution : {Distribution::ggx, Distribution::beckmann}) {
        const PlasticTable rough = make_plastic_table(1.5f, 0.01f, distribution);
        for (const float mu : {1.0f, 0.7f, 0.4f})
            CHECK(rough.transmittance(mu) == doctest::Approx(smooth.transmittance(mu)).epsilon(0.002));
        CHECK(rough.mean_transmittance == doctest::Approx(smooth.mean_transmittance).epsilon(0.005));
        CHECK(rough.internal_reflectance == doctest::Approx(smooth.internal_reflectance).epsilon(0.01));
    }
}
