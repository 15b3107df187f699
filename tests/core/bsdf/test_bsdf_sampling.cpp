// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Sampling of BSDFs: the density is that of the map, the weight is f·cos / pdf, nothing is lost between them.

#include <doctest/doctest.h>

#include "bsdf_cases.h"

using namespace eclat;
using namespace eclat::test;

namespace {

constexpr int many = 30000;

/// How much solid angle a unit of the square is mapped to, by central differences.
float jacobian(const Bsdf& bsdf, Vec3 wo, Vec2 u, float h) {
    const auto at = [&](float dx, float dy) {
        const auto s = bsdf.sample(wo, 0.5f, {u.x + dx, u.y + dy}, LobeSet::all);
        return s ? s->wi : Vec3{0, 0, 0};
    };
    const Vec3 dx = (at(h, 0) - at(-h, 0)) / (2 * h), dy = (at(0, h) - at(0, -h)) / (2 * h);
    return length(cross(dx, dy));
}

}  // namespace

TEST_CASE("density of each lobe is one over the Jacobian of its sampling map") {
    for (const BsdfCase& c : single_map_cases())
        for (const Vec3 wo : directions_of(c))
            for (const Vec2 u : {Vec2{0.3f, 0.6f}, Vec2{0.71f, 0.2f}, Vec2{0.55f, 0.93f}, Vec2{0.12f, 0.45f}}) {
                CAPTURE(c.name);
                CAPTURE(wo.z);
                CAPTURE(u.x);
                const auto s = c.bsdf.sample(wo, 0.5f, u, LobeSet::all);
                // Skip the edge of total reflection and of the horizon, where the stencil would leave the map.
                if (!s || std::abs(s->wi.z) < 0.03f) continue;
                CHECK(s->pdf_solid_angle * jacobian(c.bsdf, wo, u, 2e-3f) == doctest::Approx(1).epsilon(0.02));
            }
}

// Mixtures and rough glass compute the weight by eval, so that for them only the sides, the set of lobes and the density
// can be found wrong here; their weights are held by the integrals below.
TEST_CASE("a sample's weight and density are those of eval, also where the weight is a closed form") {
    for (const BsdfCase& c : white_cases())
        for (const Vec3 wo : directions_of(c))
            for (const LobeSet set : {LobeSet::all, LobeSet::diffuse, LobeSet::glossy})
                for_each_sample(c.bsdf, wo, set, 125, [&](const std::optional<BsdfSample>& s) {
                    if (!s || s->delta) return;
                    CAPTURE(c.name);
                    CAPTURE(wo.z);
                    CAPTURE(s->wi.z);
                    const EvalPdf e = c.bsdf.eval(wo, s->wi, set);
                    // A half vector found again from rounded directions is off by 1e-7 / α: of the narrowest facets
                    // here, α = 0.001, that is a few per cent of the density, the same in f and pdf.
                    REQUIRE(s->pdf_solid_angle == doctest::Approx(e.pdf_solid_angle).epsilon(0.03));
                    const Color expected = e.f * (abs_cos(s->wi) / e.pdf_solid_angle);
                    for (int i = 0; i < 3; ++i) REQUIRE(s->weight[i] == doctest::Approx(expected[i]).epsilon(2e-3));
                });
}

TEST_CASE("the density integrates to the share of samples that are not absorbed") {
    for (const BsdfCase& c : white_cases()) {
        if (!c.bsdf.has_non_delta() || c.name.find("0.002") != std::string::npos || c.name == "phong 5000") continue;
        for (const Vec3 wo : {direction(20, 30), direction(70, 200), direction(140, 200)}) {
            if (wo.z < 0 && !c.two_faced) continue;
            CAPTURE(c.name);
            CAPTURE(wo.z);
            const float integral =
                integrate_sphere(180, [&](Vec3 wi) { return c.bsdf.eval(wo, wi, LobeSet::all).pdf_solid_angle; });
            float share = 0;
            for_each_sample(c.bsdf, wo, LobeSet::all, many,
                            [&](const auto& s) { share += s && !s->delta ? 1.0f / many : 0; });
            CHECK(integral <= 1.003f);
            CHECK(integral == doctest::Approx(share).epsilon(0.006));
        }
    }
}

TEST_CASE("mean of the weights is the integral of f cos") {
    for (const BsdfCase& c : white_cases()) {
        if (c.name.find("0.002") != std::string::npos || c.name == "phong 5000") continue;
        for (const Vec3 wo : {direction(40, 30), direction(75, 200), direction(130, 70)}) {
            if (wo.z < 0 && !c.two_faced) continue;
            CAPTURE(c.name);
            CAPTURE(wo.z);
            const Color integral =
                integrate_sphere(180, [&](Vec3 wi) { return c.bsdf.eval(wo, wi, LobeSet::all).f * abs_cos(wi); });
            Color mean;
            for_each_sample(c.bsdf, wo, LobeSet::all, many, [&](const auto& s) {
                if (s && !s->delta) mean += s->weight * (1.0f / many);
            });
            for (int i = 0; i < 3; ++i) CHECK(mean[i] == doctest::Approx(integral[i]).epsilon(0.006));
        }
    }
}

TEST_CASE("weights are finite and bounded, at all angles and for the ends of the unit interval") {
    constexpr float ends[] = {0, 1e-7f, 0.25f, 0.5f, 0.999f, 0x1.fffffep-1f};
    for (const BsdfCase& c : white_cases())
        for (const float z : {1.0f, 0.9999999f, 0.5f, 1e-2f, 1e-4f, 1e-7f, 0.0f, -1e-7f, -0.3f, -1.0f})
            for (const LobeSet set : {LobeSet::all, LobeSet::diffuse, LobeSet::glossy})
                for (const float a : ends)
                    for (const float b : ends)
                        for (const float d : ends) {
                            const float s = std::sqrt(1 - z * z);
                            const Vec3 wo{0.6f * s, 0.8f * s, z};
                            const auto sample = c.bsdf.sample(wo, a, {b, d}, set);
                            if (!sample) continue;
                            CAPTURE(c.name);
                            CAPTURE(z);
                            REQUIRE(is_finite(sample->weight));
                            REQUIRE(is_finite(sample->wi));
                            REQUIRE(length(sample->wi) == doctest::Approx(1).epsilon(1e-4));
                            REQUIRE(std::isfinite(sample->pdf_solid_angle));
                            REQUIRE(sample->pdf_solid_angle > 0);
                            // A coat that reflects 4 % is chosen that seldom and may then meet a facet edge-on.
                            REQUIRE(max_component(sample->weight) * sqr(sample->eta_ratio) < 30);
                            REQUIRE(std::min(sample->weight.r, std::min(sample->weight.g, sample->weight.b)) >= 0);
                        }
}
