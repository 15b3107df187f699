// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Measured BRDFs against the models whose tables they hold. All that holds of every BSDF is tested with the others
// (`white_cases`); Mitsuba's reading of the same tables is in tests/methods/test_measured_against_mitsuba.py.

#include <doctest/doctest.h>

#include "base/error.h"
#include "bsdf_cases.h"

using namespace eclat;
using namespace eclat::test;

namespace {

/// The greatest relative difference of f · cos from a model, of what is at least `least` times the greatest value.
float largest_difference(const MeasuredBrdf& brdf, const Bsdf& model, float least) {
    float greatest = 0, difference = 0;
    for (const bool compares : {false, true})
        for (int a = 0; a < 8; ++a)
            for (int b = 0; b < 8; ++b)
                for (int p = 0; p < 12; ++p) {
                    const Vec3 wo = direction(4 + 9 * float(a), 17), wi = direction(2 + 10 * float(b), 30 * float(p));
                    const float wanted = model.eval(wo, wi, LobeSet::all).f.g * wi.z,
                                got = brdf.eval(wo, wi).f.g * wi.z;
                    if (!compares) greatest = std::max(greatest, wanted);
                    if (compares && wanted > least * greatest)
                        difference = std::max(difference, std::abs(got / wanted - 1));
                }
    return difference;
}

}  // namespace

TEST_CASE("tables give the values of the models that they hold") {
    // Tables of one degree, and of 32 x 32 nodes; interpolation errs most at the peak.
    CHECK(largest_difference(merl(), measured_model(), 0.01f) < 0.02f);
    CHECK(largest_difference(rgl(), measured_model(), 0.05f) < 0.1f);
    CHECK(largest_difference(anisotropic_rgl(), anisotropic_model(), 0.05f) < 0.2f);
}

TEST_CASE("directions are chosen nearly in proportion to the light that they reflect") {
    const auto spread = [](const MeasuredBrdf& brdf, Vec3 wo) {
        double sum = 0, squares = 0;
        const int n = 64;
        for (int i = 0; i < n * n; ++i) {
            BsdfSample s;
            if (!brdf.sample(wo, {(float(i % n) + 0.5f) / n, (float(i / n) + 0.5f) / n}, s)) continue;
            sum += double(s.weight.g), squares += sqr(double(s.weight.g));
        }
        return std::sqrt(squares * n * n / (sum * sum) - 1);
    };
    for (const float angle : {5.0f, 40.0f, 70.0f}) {
        CAPTURE(angle);
        CHECK(spread(merl(), direction(angle, 20)) < 0.8);
        CHECK(spread(rgl(), direction(angle, 20)) < 0.35);
        CHECK(spread(anisotropic_rgl(), direction(angle, 200)) < 0.35);
    }
}

TEST_CASE("the scale of a material multiplies its values") {
    const Vec3 wo = direction(30, 0), wi = direction(20, 100);
    const Bsdf half = make_measured(merl(), Color(0.5f, 0.25f, 0));
    CHECK(half.eval(wo, wi, LobeSet::all).f.g == doctest::Approx(0.25f * merl().eval(wo, wi).f.g));
    CHECK(half.eval(wo, wi, LobeSet::all).f.b == 0);
    CHECK(half.albedo(wo).r == doctest::Approx(0.5f * merl().albedo(wo).r));
}

TEST_CASE("only what turns with the viewer is isotropic") {
    CHECK(merl().isotropic());
    CHECK(rgl().isotropic());
    CHECK(!anisotropic_rgl().isotropic());
}

TEST_CASE("light that is made of nothing is told") {
    CHECK(merl().largest_albedo() < 1.01f);
    std::vector<float> twice = merl_values(make_diffuse(Color(1)));
    for (float& value : twice) value *= 2;
    const MerlBrdf bright(twice);
    CHECK(bright.largest_albedo() == doctest::Approx(2).epsilon(0.01));
    CHECK(bright.albedo(direction(40, 0)).g == 1);
}

TEST_CASE("tables that are none are refused") {
    CHECK_THROWS_AS(MerlBrdf(std::vector<float>(7)), std::invalid_argument);
    std::vector<float> values = merl_values(make_diffuse(Color(1)));
    values[123] = infinity;
    CHECK_THROWS_AS(MerlBrdf{values}, std::invalid_argument);
    const auto with = [](const auto& change) {
        RglTables tables(measured_model(), {0.3f, 0.3f, Distribution::ggx}, {0});
        change(tables);
        return RglBrdf(tables.data());
    };
    CHECK_THROWS_AS(with([](RglTables& t) { t.theta.pop_back(); }), std::invalid_argument);
    CHECK_THROWS_AS(with([](RglTables& t) { std::swap(t.theta[1], t.theta[2]); }), std::invalid_argument);
    CHECK_THROWS_AS(with([](RglTables& t) { t.normals[5] = infinity; }), std::invalid_argument);
    CHECK_THROWS_AS(with([](RglTables& t) { std::ranges::fill(t.visible, 0.0f); }), std::invalid_argument);
}
