// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Interpolation between radiance records of a known light.

#include <doctest/doctest.h>

#include "records/radiance_record_cache.h"
#include "harmonics/quadrature.h"
#include "harmonics_cases.h"

using namespace eclat;
using namespace eclat::test;

namespace {

constexpr int order = 8;

/// Light that varies over directions in world space and, linearly, over the plane.
double light(Direction w, Vec3 p) {
    return (1 + 0.3 * double(p.x)) * (1 + 0.6 * w.x + 0.3 * w.y * w.z) + 0.2 * double(p.y) * w.z;
}

std::vector<double> projected(const Frame& frame, Vec3 p) {
    std::vector<double> b(size_t(coefficient_count(order))), Y(b.size());
    for (const Node& node : product_grid(gauss_legendre(16), 16)) {
        evaluate_harmonics(Basis::spherical, order, node.w, Y.data());
        const Vec3 w = frame.to_world({float(node.w.x), float(node.w.y), float(node.w.z)});
        const double L = light({double(w.x), double(w.y), double(w.z)}, p);
        for (size_t i = 0; i < b.size(); ++i) b[i] += node.weight * L * Y[i];
    }
    HemisphereFit(order, radiance_tikhonov).orthonormalize(order, b);
    return b;
}

/// The coefficients of light that is 1 from all directions.
std::vector<double> projected_even() {
    std::vector<double> b(size_t(coefficient_count(order))), Y(b.size());
    for (const Node& node : product_grid(gauss_legendre(16), 16)) {
        evaluate_harmonics(Basis::spherical, order, node.w, Y.data());
        for (size_t i = 0; i < b.size(); ++i) b[i] += node.weight * Y[i];
    }
    HemisphereFit(order, radiance_tikhonov).orthonormalize(order, b);
    return b;
}

struct Records {
    std::vector<IrradianceRecord> records;
    std::vector<RadianceCoefficients> coefficients;

    void add(Vec3 p, Vec3 normal, float radius = 1) {
        IrradianceRecord r;
        r.position = p;
        r.normal = normalize(normal);
        r.irradiance = Color(1);
        r.distance = r.radius = radius;
        r.clearance.fill(infinity);
        const Frame frame = Frame::around(r.normal);
        RadianceCoefficients c;
        const auto at = projected(frame, p), u = projected(frame, p + frame.u), v = projected(frame, p + frame.v);
        for (int channel = 0; channel < 3; ++channel)
            for (const double x : at) c.values.push_back(float(x) * float(channel + 1));
        for (const auto* moved : {&u, &v})
            for (int channel = 0; channel < 3; ++channel)
                for (size_t i = 0; i < at.size(); ++i)
                    c.gradients.push_back(float((*moved)[i] - at[i]) * float(channel + 1));
        records.push_back(r);
        coefficients.push_back(c);
    }
    RadianceCache cache() const {
        RadianceCache out({}, order);
        out.insert(records, coefficients, {}, 1, 1);
        return out;
    }
};

/// cosᵏ around a direction of `frame`, as factors there.
ReflectedFactors lobe_around(Direction axis, int exponent) {
    std::vector<double> b(size_t(coefficient_count(order))), Y(b.size());
    for (const Node& node : product_grid(gauss_legendre(32), 32)) {
        evaluate_harmonics(Basis::spherical, order, node.w, Y.data());
        const double f = std::pow(std::max(0.0, axis.x * node.w.x + axis.y * node.w.y + axis.z * node.w.z), exponent);
        for (size_t i = 0; i < b.size(); ++i) b[i] += node.weight * f * Y[i];
    }
    HemisphereFit(order, radiance_tikhonov).orthonormalize(order, b);
    ReflectedFactors out;
    out.order = order;
    std::copy(b.begin(), b.end(), out.factors[0].begin());
    return out;
}

double reflected_exactly(Direction axis, int exponent, const Frame& frame, Vec3 p) {
    double sum = 0;
    for (const Node& node : product_grid(gauss_legendre(32), 32)) {
        const Vec3 w = frame.to_world({float(node.w.x), float(node.w.y), float(node.w.z)});
        sum += node.weight * light({double(w.x), double(w.y), double(w.z)}, p) *
               std::pow(std::max(0.0, axis.x * node.w.x + axis.y * node.w.y + axis.z * node.w.z), exponent);
    }
    return sum;
}

}  // namespace

TEST_CASE("a light that is linear in position is reproduced between records") {
    Records records;
    records.add({0, 0, 0}, {0, 0, 1});
    records.add({0.7f, 0.2f, 0}, {0, 0, 1});
    records.add({0.2f, 0.8f, 0}, {0, 0, 1});
    const RadianceCache cache = records.cache();
    const Direction axis = direction_at(0.6, 0.3);
    // A shading frame turned about the normal.
    const Frame shading{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}};
    for (const Vec3 p : {Vec3{0.1f, 0.1f, 0}, Vec3{0.4f, 0.3f, 0}, Vec3{0.5f, 0.6f, 0}}) {
        const auto found = cache.reflect(p, {0, 0, 1}, shading, lobe_around(axis, 10));
        REQUIRE(found);
        const double expected = reflected_exactly(axis, 10, shading, p);
        CHECK(double(found->r) == doctest::Approx(expected).epsilon(3e-3));
        CHECK(double(found->b) == doctest::Approx(3 * expected).epsilon(3e-3));
    }
}

TEST_CASE("a light that bends over the surface is reflected without bias amid its records") {
    // The light is the same from all directions and bends down like a paraboloid. By tangents alone, each record between its
    // neighbours would give too much: 0.065 of 3 here.
    const auto bent = [](Vec3 p) { return 3 + 0.2f * p.x - 0.5f * p.x * p.x - 0.3f * p.y * p.y + 0.2f * p.x * p.y; };
    const std::vector<double> even = projected_even();
    Records records;
    for (float x = -1.2f; x <= 1.21f; x += 0.2f)
        for (float y = -1.2f; y <= 1.21f; y += 0.2f) {
            IrradianceRecord r;
            r.position = {x, y, 0};
            r.normal = {0, 0, 1};
            r.irradiance = Color(1);
            r.distance = r.radius = 0.6f;
            r.clearance.fill(infinity);
            const Frame frame = Frame::around(r.normal);
            const Vec3 slope{0.2f - x + 0.2f * y, -0.6f * y + 0.2f * x, 0};
            RadianceCoefficients c;
            for (const float factor : {bent(r.position), dot(slope, frame.u), dot(slope, frame.v)})
                for (int channel = 0; channel < 3; ++channel)
                    for (const double y_i : even)
                        (c.values.size() < 3 * even.size() ? c.values : c.gradients).push_back(float(y_i) * factor);
            records.records.push_back(r);
            records.coefficients.push_back(c);
        }
    const RadianceCache cache = records.cache();
    const Frame up = Frame::around({0, 0, 1});
    const ReflectedFactors factors = lobe_around(direction_at(0.4, 1.0), 3);
    // What the lobe reflects of even light of 1.
    double unit = 0;
    for (size_t i = 0; i < even.size(); ++i) unit += even[i] * double(factors.factors[0][i]);
    double error = 0, worst = 0;
    int count = 0;
    for (float x = -0.5f; x < 0.5f; x += 0.07f)
        for (float y = -0.5f; y < 0.5f; y += 0.07f, ++count) {
            const auto L = cache.reflect({x, y, 0}, {0, 0, 1}, up, factors);
            REQUIRE(L);
            const double off = double(L->g) / unit - double(bent({x, y, 0}));
            error += off;
            worst = std::max(worst, std::abs(off));
        }
    CHECK(std::abs(error / count) < 1e-3);
    CHECK(worst < 5e-3);
}

TEST_CASE("records with tilted normals, and a bent shading normal") {
    Records records;
    records.add({0, 0, 0}, {0, 0.05f, 1});
    records.add({0.1f, 0, 0}, {0.08f, 0, 1});
    const RadianceCache cache = records.cache();
    const Direction axis = direction_at(0.4, 1.3);
    for (const Vec3 n : {Vec3{0.03f, 0, 1}, Vec3{0.15f, -0.1f, 1}}) {
        const Frame shading = Frame::around(normalize(n));
        const auto found = cache.reflect({0.05f, 0.02f, 0}, {0, 0, 1}, shading, lobe_around(axis, 10));
        REQUIRE(found);
        CHECK(double(found->r) ==
              doctest::Approx(reflected_exactly(axis, 10, shading, {0.05f, 0.02f, 0})).epsilon(0.01));
    }
    // A bump too steep for rotation is traced.
    CHECK(!cache.reflect({0.05f, 0.02f, 0}, {0, 0, 1}, Frame::around(normalize(Vec3{0.4f, 0, 1})),
                         lobe_around(axis, 10)));
}

TEST_CASE("narrow lobes are served from a shorter distance") {
    Records records;
    records.add({0, 0, 0}, {0, 0, 1});
    const RadianceCache cache = records.cache();
    CHECK(cache.serves({0.9f, 0, 0}, {0, 0, 1}, 1));
    CHECK(!cache.serves({0.9f, 0, 0}, {0, 0, 1}, 0.5f));
    CHECK(cache.serves({0.45f, 0, 0}, {0, 0, 1}, 0.5f));
    ReflectedFactors factors = lobe_around({0, 0, 1}, 2);
    const Frame shading = Frame::around({0, 0, 1});
    CHECK(cache.reflect({1.4f, 0, 0}, {0, 0, 1}, shading, factors));  // relaxed
    factors.width = 0.5f;
    CHECK(!cache.reflect({1.4f, 0, 0}, {0, 0, 1}, shading, factors));
}

TEST_CASE("a record whose neighbour reflects otherwise shrinks until it no longer reaches it") {
    const Frame up = Frame::around({0, 0, 1});
    const ReflectedFactors factors = lobe_around(direction_at(0.4, 1.0), 6);
    const auto shrunk = [&](float jump, float width, float distance) {
        Records records;
        records.add({0, 0, 0}, {0, 0, 1});
        records.add({distance, 0, 0}, {0, 0, 1});
        for (float& value : records.coefficients[1].values) value *= jump;
        RadianceCache cache({}, order);
        ReflectedFactors seen = factors;
        seen.width = width;
        const std::vector<PlacedLobe> lobes(2, cache.placed_lobe(seen, up, {0, 0, 1}));
        cache.insert(records.records, records.coefficients, lobes, 1, 1);
        const size_t count = cache.shrink_where_records_disagree(0.02f, 1, 1);
        const bool reach = cache.serves({distance, 0, 0}, {0, 0, 1}, width) &&
                           std::min(cache.records()[0].radius, cache.records()[1].radius) * width > distance;
        CHECK(reach == (count == 0 && width > distance));
        return count;
    };
    CHECK(shrunk(1, 1, 0.5f) == 0);     // a linear light is extrapolated exactly
    CHECK(shrunk(1.1f, 1, 0.5f) == 1);  // the worse of both
    CHECK(shrunk(1.01f, 1, 0.5f) == 0);
    CHECK(shrunk(1.1f, 0.3f, 0.5f) == 0);  // too far for so narrow a lobe
}

TEST_CASE("the arrays of a cache are read by another cache") {
    Records records;
    records.add({0, 0, 0}, {0, 0, 1});
    records.add({0.5f, 0, 0}, {0.05f, 0, 1});
    const RadianceCache cache = records.cache();
    RadianceCache again({}, order);
    again.insert(cache.records(), cache.values(), cache.gradients(), 1, 1);
    const ReflectedFactors factors = lobe_around({0, 0, 1}, 5);
    const Frame shading = Frame::around({0, 0, 1});
    const auto a = cache.reflect({0.2f, 0.1f, 0}, {0, 0, 1}, shading, factors),
               b = again.reflect({0.2f, 0.1f, 0}, {0, 0, 1}, shading, factors);
    REQUIRE((a && b));
    CHECK(a->r == b->r);
    RadianceCache other({}, order - 2);
    CHECK_THROWS_AS(other.insert(cache.records(), cache.values(), cache.gradients(), 1, 1), std::invalid_argument);
}
