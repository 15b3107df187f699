// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// What tables make of light against integrals of the BSDF itself.

#include <doctest/doctest.h>

#include "tables/radiance_tables.h"
#include "harmonics_cases.h"

using namespace eclat;
using namespace eclat::test;

namespace {

constexpr int order = 8;

Value constant(float r, float g, float b) {
    Value v;
    v.constant = Color(r, g, b);
    return v;
}
Value constant(float x) { return constant(x, x, x); }

Material make(MaterialKind kind, std::vector<Value> parameters) {
    Material m;
    m.kind = kind;
    m.parameters = std::move(parameters);
    return m;
}

std::vector<Material> materials() {
    std::vector<Material> out{
        make(MaterialKind::phong, {constant(0.2f), constant(0.5f, 0.3f, 0.1f), constant(8)}),
        make(MaterialKind::ward, {constant(0.1f), constant(0.6f), constant(0.35f), constant(0.6f)}),
        // Gold-like: the three Fresnel terms.
        make(MaterialKind::conductor, {constant(0.14f, 0.37f, 1.44f), constant(3.98f, 2.39f, 1.6f), constant(1),
                                       constant(0.5f), constant(0.5f)}),
        make(MaterialKind::metallic_roughness,
             {constant(0.8f, 0.5f, 0.2f), constant(0.5f), constant(0.45f), constant(1.5f), constant(1), constant(1),
              constant(0), constant(0), constant(1)})};
    for (Material& m : out) m.prepare(out);
    return out;
}

/// The tables that are wanted, exact enough for any direction.
std::vector<BrdfTable> make_tables(const std::vector<Material>& materials, double max_error) {
    const auto wanted = RadianceTables::wanted(materials);
    Progress progress;
    BrdfTableOptions options;
    options.basis = Basis::spherical;
    options.order = order;
    options.max_error = max_error;
    options.resolution = 24;
    std::vector<BrdfTable> out;
    for (const TableLobe& lobe : wanted.lobes) out.emplace_back(std::vector<TableLobe>{lobe}, options, progress);
    CHECK(!wanted.roughness);
    return out;
}

std::vector<const BrdfTable*> pointers(const std::vector<BrdfTable>& tables) {
    std::vector<const BrdfTable*> out;
    for (const BrdfTable& t : tables) out.push_back(&t);
    return out;
}

double light(Direction w) { return 1 + 0.8 * w.x - 0.5 * w.y + 0.4 * w.x * w.y + 0.3 * w.z * w.z; }

}  // namespace

TEST_CASE("factors against light of low order are the integral of the lobes, from all sides") {
    const auto all = materials();
    const auto made = make_tables(all, 1);
    const RadianceTables tables(all, pointers(made), order);
    const HemisphereFit fit(order, radiance_tikhonov);
    std::vector<double> L(64), Y(64);
    const auto nodes = product_grid(hemisphere_heights(48), 48);
    for (const Node& node : nodes) {
        evaluate_harmonics(Basis::spherical, order, node.w, Y.data());
        for (size_t i = 0; i < 64; ++i) L[i] += node.weight * light(node.w) * Y[i];
    }
    fit.orthonormalize(order, L);
    for (size_t m = 0; m < all.size(); ++m) {
        const Bsdf bsdf = make_bsdf(all, int(m), {}, false);
        for (const Vec3 wo : {Vec3{0, 0, 1}, Vec3{0.6f, 0, 0.8f}, Vec3{-0.3f, 0.7f, 0.65f}, Vec3{-0.5f, -0.7f, 0.5f},
                              Vec3{0.7f, -0.5f, 0.5f}}) {
            const Vec3 w = normalize(wo);
            ReflectedFactors factors;
            tables.reflect(bsdf, w, factors);
            REQUIRE(factors.order == order);
            double expected[3] = {}, white[3] = {};
            for (const Node& node : nodes) {
                const Vec3 wi{float(node.w.x), float(node.w.y), float(node.w.z)};
                const Color f = bsdf.eval(w, wi, LobeSet::glossy).f;
                for (int c = 0; c < 3; ++c) {
                    expected[c] += node.weight * node.w.z * double(f[c]) * light(node.w);
                    white[c] += node.weight * node.w.z * double(f[c]);
                }
            }
            for (int c = 0; c < 3; ++c) {
                double reflected = 0;
                for (size_t i = 0; i < 64; ++i)
                    reflected += double(factors.factors[factors.grey ? 0 : size_t(c)][i]) * L[i];
                CAPTURE(m);
                CAPTURE(c);
                // What interpolation between nodes, and the fit of Fresnel's equations, leave.
                CHECK(reflected == doctest::Approx(expected[c]).epsilon(0.02));
                CHECK(double(factors.albedo[c]) == doctest::Approx(white[c]).epsilon(0.02));
            }
            CHECK(factors.width > 0.1f);
            CHECK(factors.width < 1.01f);
        }
    }
}

TEST_CASE("narrow lobes and mirrors have no factors; wide lobes have them") {
    std::vector<Material> all = materials();
    all.push_back(make(MaterialKind::conductor, {constant(0), constant(1), constant(0.8f), constant(0), constant(0)}));
    all.push_back(
        make(MaterialKind::conductor, {constant(0), constant(1), constant(0.8f), constant(0.12f), constant(0.12f)}));
    for (Material& m : all) m.prepare(all);
    const auto made = make_tables(all, 0.1);
    const RadianceTables tables(all, pointers(made), order);
    const auto reflects = [&](int m, Vec3 wo) { return tables.reflects(make_bsdf(all, m, {}, false), normalize(wo)); };
    CHECK(reflects(2, {0, 0, 1}));
    CHECK(!reflects(2, {0, 0, -1}));
    CHECK(!reflects(4, {0, 0, 1}));
    CHECK(!reflects(5, {0, 0, 1}));
    CHECK(!reflects(5, {1, 0, 0.3f}));
    ReflectedFactors factors;
    tables.reflect(make_bsdf(all, 0, {}, false), {0, 0, 1}, factors);
    CHECK(factors.shares[0] == 0);
    CHECK(factors.shares[1] == 1);  // after the diffuse one
}

TEST_CASE("the share of a lobe that is cached varies continuously, and nothing of the lobe is lost") {
    std::vector<Material> all{
        make(MaterialKind::conductor, {constant(0), constant(1), constant(0.8f), constant(0.3f), constant(0.3f)})};
    all[0].prepare(all);
    const auto made = make_tables(all, 0.4);
    const RadianceTables tables(all, pointers(made), order);
    const Vec3 wi = normalize(Vec3{0.3f, -0.2f, 0.8f});
    float before = 1;
    int divided = 0;
    for (int i = 0; i <= 200; ++i) {
        const float theta = static_cast<float>(i) / 200 * 0.49f * pi;
        const Vec3 wo{std::sin(theta), 0, std::cos(theta)};
        Bsdf bsdf = make_bsdf(all, 0, {}, false);
        const Color whole = bsdf.eval(wo, wi, LobeSet::all).f;
        ReflectedFactors factors;
        tables.reflect(bsdf, wo, factors);
        const float share = factors.shares[0];
        CHECK(std::fabs(share - before) < 0.1f);
        CHECK((factors.order > 0) == (share > 0));
        // Each part is what it is called.
        set_cached(bsdf, factors);
        CHECK(bsdf.eval(wo, wi, LobeSet::cached).f.g == doctest::Approx(share * whole.g));
        CHECK(bsdf.eval(wo, wi, LobeSet::uncached).f.g == doctest::Approx((1 - share) * whole.g));
        if (share > 0)
            CHECK(double(factors.albedo.g) == doctest::Approx(double(share * bsdf.albedo(wo).g)).epsilon(0.1));
        divided += share > 0 && share < 1;
        before = share;
    }
    CHECK(divided > 5);
    CHECK(before == 0);  // grazing
}

TEST_CASE("a lambertian lobe has width 1, narrower ones less") {
    Progress progress;
    BrdfTableOptions options;
    options.basis = Basis::spherical;
    options.order = order;
    options.max_error = 1;
    const HemisphereFit fit(order, radiance_tikhonov);
    float before = 1.01f;
    for (const float exponent : {1.0f, 4.0f, 16.0f}) {
        const BrdfTable table({{TableLobe::Kind::phong, exponent, exponent}}, options, progress);
        ReflectedFactors factors;
        const Color white[3] = {Color(1), Color(), Color()};
        const LobeTable lobe(table, fit);
        REQUIRE(lobe.share({0, 0, 1}, 0) == 1);
        lobe.add({0, 0, 1}, 0, 1, white, factors);
        // ∫ (cosⁿ⁺¹)ᵏ: a² / energy = 2π (2n + 3) / (n + 2)², over 3π/2.
        const double n = double(exponent);
        CHECK(double(factors.width) ==
              doctest::Approx(std::sqrt(4.0 / 3 * (2 * n + 3) / ((n + 2) * (n + 2)))).epsilon(0.03));
        CHECK(factors.width < before);
        before = factors.width;
    }
}

TEST_CASE("tables of another order or basis are refused") {
    Progress progress;
    BrdfTableOptions options;
    options.order = order;
    options.resolution = 4;
    const BrdfTable hemispherical({{TableLobe::Kind::phong, 4, 4}}, options, progress);
    CHECK_THROWS_AS(RadianceTables({}, {&hemispherical}, order), std::invalid_argument);
    options.basis = Basis::spherical;
    const BrdfTable spherical({{TableLobe::Kind::phong, 4, 4}}, options, progress);
    CHECK_THROWS_AS(RadianceTables({}, {&spherical}, order + 1), std::invalid_argument);
}

TEST_CASE("textured roughness has a table, over all roughnesses, only for metallic-roughness") {
    std::vector<Material> all = materials();
    const uint8_t grey = 128;
    const Texture texture({1, 1, 1, &grey, nullptr}, {});
    all[2].parameters[3].texture = &texture;
    const size_t constant = RadianceTables::wanted(materials()).lobes.size();
    CHECK(RadianceTables::wanted(all).lobes.size() == constant - 1);
    CHECK(!RadianceTables::wanted(all).roughness);
    all[3].parameters[2].texture = &texture;
    CHECK(RadianceTables::wanted(all).lobes.size() == constant - 2);
    CHECK(RadianceTables::wanted(all).roughness);
}
