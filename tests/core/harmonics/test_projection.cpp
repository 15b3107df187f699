// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <doctest/doctest.h>

#include "harmonics/projection.h"
#include "harmonics_cases.h"

using namespace eclat;
using namespace eclat::test;

namespace {

struct Samples {
    std::vector<Direction> directions;
    std::vector<double> weights;
};

Samples hemisphere(int count) {
    Samples out;
    for (const Node& node : hemisphere_grid(count)) {
        out.directions.push_back(node.w);
        out.weights.push_back(node.weight);
    }
    return out;
}

/// cos^exponent around a direction `degrees` from the normal.
std::vector<double> lobe(const Samples& samples, double exponent, double degrees) {
    const Direction a = direction_at(degrees * pi_double / 180, 0.7);
    std::vector<double> out;
    for (const Direction& w : samples.directions)
        out.push_back(std::pow(std::max(0.0, a.x * w.x + a.y * w.y + a.z * w.z), exponent));
    return out;
}

double relative_error(const Samples& s, const std::vector<double>& f, Basis basis, int order,
                      const std::vector<double>& c) {
    const std::vector<double> again = reconstruct(basis, order, c, s.directions, 1);
    double error = 0, energy = 0;
    for (size_t i = 0; i < f.size(); ++i) {
        error += s.weights[i] * (f[i] - again[i]) * (f[i] - again[i]);
        energy += s.weights[i] * f[i] * f[i];
    }
    return std::sqrt(error / energy);
}

}  // namespace

TEST_CASE("projecting a sum of basis functions returns its coefficients, per channel") {
    const Samples s = hemisphere(24);
    constexpr int order = 6, count = order * order;
    const std::vector<double> a = random_coefficients(order, 1), b = random_coefficients(order, 2);
    std::vector<double> both;
    for (int i = 0; i < count; ++i) both.insert(both.end(), {a[size_t(i)], b[size_t(i)]});
    const std::vector<double> values = reconstruct(Basis::hemispherical, order, both, s.directions, 2);
    CHECK(distance(project(Basis::hemispherical, order, s.directions, values, s.weights, 2), both) < 1e-12);
}

TEST_CASE("the relative errors of three representations of a lobe") {
    // Measured apart from this code, plain / least squares / hemispherical: .16/.07/.03, .19/.11/.19, .28/.18/.09.
    struct Row {
        double exponent, degrees;
        int order;
        double plain, fitted, hemispherical;
    };
    const Samples s = hemisphere(64);
    for (const Row& row : std::vector<Row>{
             {10, 30, 6, 0.16, 0.07, 0.03}, {10, 70, 6, 0.19, 0.11, 0.19}, {40, 45, 10, 0.28, 0.18, 0.09}}) {
        const std::vector<double> f = lobe(s, row.exponent, row.degrees);
        const std::vector<double> plain = project(Basis::spherical, row.order, s.directions, f, s.weights, 1);
        std::vector<double> fitted = plain;
        HemisphereFit(row.order).fit(row.order, fitted);
        const std::vector<double> hemi = project(Basis::hemispherical, row.order, s.directions, f, s.weights, 1);
        CHECK(std::fabs(relative_error(s, f, Basis::spherical, row.order, plain) - row.plain) < 0.0051);
        CHECK(std::fabs(relative_error(s, f, Basis::spherical, row.order, fitted) - row.fitted) < 0.0051);
        CHECK(std::fabs(relative_error(s, f, Basis::hemispherical, row.order, hemi) - row.hemispherical) < 0.0051);
    }
}

TEST_CASE("the Gram matrix on the hemisphere") {
    const HemisphereFit fit(12);
    const Samples s = hemisphere(32);
    // Row by row: the inner products of one harmonic with all.
    for (const auto& [l, m] : {std::pair{0, 0}, {3, 2}, {7, -4}, {11, 0}}) {
        std::vector<double> one(144);
        one[size_t(coefficient_index(l, m))] = 1;
        const auto f = reconstruct(Basis::spherical, 12, one, s.directions, 1);
        const auto row = project(Basis::spherical, 12, s.directions, f, s.weights, 1);
        for (int k = 0; k < 12; ++k)
            for (int j = -k; j <= k; ++j)
                CHECK(std::fabs(row[size_t(coefficient_index(k, j))] - (j == m ? fit.gram(l, k, m) : 0)) < 1e-12);
    }
}

TEST_CASE("a fit is the best sum: the error is orthogonal to all harmonics, and energies tell it") {
    constexpr int order = 8;
    const Samples s = hemisphere(48);
    const std::vector<double> f = lobe(s, 12, 65);
    const std::vector<double> moments = project(Basis::spherical, order, s.directions, f, s.weights, 1);
    const HemisphereFit exact(order, 1e-13);
    double energy = 0;
    for (size_t i = 0; i < f.size(); ++i) energy += s.weights[i] * f[i] * f[i];
    const std::vector<double> energies = exact.energies(moments);
    for (int n = 1; n <= order; ++n) {
        std::vector<double> c(moments.begin(), moments.begin() + n * n);
        exact.fit(n, c);
        const std::vector<double> again = reconstruct(Basis::spherical, n, c, s.directions, 1);
        std::vector<double> rest;
        for (size_t i = 0; i < f.size(); ++i) rest.push_back(f[i] - again[i]);
        CHECK(norm(project(Basis::spherical, n, s.directions, rest, s.weights, 1)) < 1e-6);
        // Pythagoras.
        const double error = relative_error(s, f, Basis::spherical, n, c);
        CHECK(error * error == doctest::Approx(1 - energies[size_t(n - 1)] / energy).epsilon(1e-5));
    }
}

TEST_CASE("orthonormal coefficients: product integrals are dot products, for every order that is cut out") {
    const Samples s = hemisphere(48);
    const int order = 8;
    const HemisphereFit exact(order, 0);
    const std::vector<double> f = lobe(s, 12, 65), g = lobe(s, 3, 20);
    const std::vector<double> inner_f = project(Basis::spherical, order, s.directions, f, s.weights, 1);
    std::vector<double> a = inner_f, b = project(Basis::spherical, order, s.directions, g, s.weights, 1);
    exact.orthonormalize(order, a);
    exact.orthonormalize(order, b);
    for (int n = 1; n <= order; ++n) {
        std::vector<double> c(inner_f.begin(), inner_f.begin() + n * n);
        exact.fit(n, c);
        const std::vector<double> fitted = reconstruct(Basis::spherical, n, c, s.directions, 1);
        double expected = 0, dot = 0;
        for (size_t i = 0; i < f.size(); ++i) expected += s.weights[i] * fitted[i] * g[i];
        for (int i = 0; i < n * n; ++i) dot += a[size_t(i)] * b[size_t(i)];
        CHECK(dot == doctest::Approx(expected).epsilon(1e-6));
    }
    exact.to_inner_products(order, a);
    for (size_t i = 0; i < a.size(); ++i) CHECK(a[i] == doctest::Approx(inner_f[i]).epsilon(1e-9));
}

TEST_CASE("Tikhonov's factor bounds the coefficients where the Gram matrix is nearly singular") {
    const Samples s = hemisphere(48);
    std::vector<double> noisy = project(Basis::spherical, 12, s.directions, lobe(s, 12, 65), s.weights, 1);
    const std::vector<double> noise = random_coefficients(12, 3);
    for (size_t i = 0; i < noisy.size(); ++i) noisy[i] += 1e-6 * noise[i];
    std::vector<double> bounded = noisy, free = noisy;
    HemisphereFit(12).fit(12, bounded);
    HemisphereFit(12, 1e-12).fit(12, free);
    CHECK(norm(bounded) < 20);
    CHECK(norm(free) > 10 * norm(bounded));
    CHECK_THROWS_WITH_AS(HemisphereFit(40, 0), doctest::Contains("singular"), std::invalid_argument);
}
