// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Orthonormality of both bases by quadrature; their first members against formulas; windows.

#include <doctest/doctest.h>

#include "harmonics_cases.h"

using namespace eclat;
using namespace eclat::test;

namespace {

/// Largest difference between the Gram matrix and the identity.
double gram_error(Basis basis, int order, const std::vector<Node>& grid) {
    const size_t n = size_t(coefficient_count(order));
    std::vector<double> gram(n * n), B(n);
    for (const Node& node : grid) {
        evaluate_harmonics(basis, order, node.w, B.data());
        for (size_t i = 0; i < n; ++i)
            for (size_t j = 0; j < n; ++j) gram[i * n + j] += node.weight * B[i] * B[j];
    }
    double worst = 0;
    for (size_t i = 0; i < n; ++i)
        for (size_t j = 0; j < n; ++j) worst = std::max(worst, std::fabs(gram[i * n + j] - (i == j)));
    return worst;
}

}  // namespace

TEST_CASE("Gauss–Legendre nodes integrate polynomials up to twice their number") {
    for (const int count : {1, 2, 7, 40})
        for (int degree = 0; degree < 2 * count; ++degree) {
            double sum = 0;
            for (const QuadratureNode& node : gauss_legendre(count)) sum += node.weight * std::pow(node.x, degree);
            CHECK(sum == doctest::Approx(1.0 / (degree + 1)).epsilon(1e-13));
        }
    double sum = 0;
    for (const QuadratureNode& node : hemisphere_heights(8)) sum += node.weight * std::sqrt(node.x);
    CHECK(sum == doctest::Approx(2.0 / 3).epsilon(1e-14));
}

TEST_CASE("spherical harmonics are orthonormal on the sphere") {
    CHECK(gram_error(Basis::spherical, 12, sphere_grid(24)) < 1e-12);
}

TEST_CASE("hemispherical harmonics are orthonormal on the hemisphere") {
    CHECK(gram_error(Basis::hemispherical, 12, hemisphere_grid(32)) < 1e-12);
}

TEST_CASE("high orders stay orthonormal") {
    // Band by band against the addition theorem: Σ_m Y² = (2l + 1) / 4π in every direction.
    std::vector<double> Y(size_t(coefficient_count(max_harmonic_order)));
    for (const double theta : {0.0, 1e-7, 0.3, 1.5, 3.1}) {
        spherical_harmonics(max_harmonic_order, direction_at(theta, 2), Y.data());
        for (int l = 0; l < max_harmonic_order; ++l) {
            double sum = 0;
            for (int m = -l; m <= l; ++m)
                sum += Y[size_t(coefficient_index(l, m))] * Y[size_t(coefficient_index(l, m))];
            CHECK(sum == doctest::Approx((2 * l + 1) / (4 * pi_double)).epsilon(1e-11));
        }
    }
}

TEST_CASE("band 1 is the direction itself, without Condon–Shortley phase") {
    const Direction w = direction_at(0.7, 2.1);
    double Y[4];
    spherical_harmonics(2, w, Y);
    const double k = std::sqrt(3 / (4 * pi_double));
    CHECK(Y[0] == doctest::Approx(std::sqrt(1 / (4 * pi_double))));
    CHECK(Y[1] == doctest::Approx(k * w.y));
    CHECK(Y[2] == doctest::Approx(k * w.z));
    CHECK(Y[3] == doctest::Approx(k * w.x));
}

TEST_CASE("hemispherical harmonics as [Gautron04] writes them") {
    // K̃ P_l^m(2 cosθ − 1) with explicit polynomials, P_1^1 and P_2^1 without phase.
    const double theta = 1.1, phi = 0.4, t = 2 * std::cos(theta) - 1, s = std::sqrt(1 - t * t);
    double H[9];
    hemispherical_harmonics(3, direction_at(theta, phi), H);
    const auto K = [](int l, int m) {
        return std::sqrt((2 * l + 1) * std::tgamma(l - m + 1) / (2 * pi_double * std::tgamma(l + m + 1)));
    };
    CHECK(H[0] == doctest::Approx(K(0, 0)));
    CHECK(H[2] == doctest::Approx(K(1, 0) * t));
    CHECK(H[3] == doctest::Approx(std::sqrt(2) * K(1, 1) * s * std::cos(phi)));
    CHECK(H[1] == doctest::Approx(std::sqrt(2) * K(1, 1) * s * std::sin(phi)));
    CHECK(H[7] == doctest::Approx(std::sqrt(2) * K(2, 1) * 3 * t * s * std::cos(phi)));
    CHECK(H[4] == doctest::Approx(std::sqrt(2) * K(2, 2) * 3 * s * s * std::sin(2 * phi)));

    hemispherical_harmonics(3, direction_at(1.8, phi), H);
    for (const double h : H) CHECK(h == 0);
}

TEST_CASE("the polar factors are those of the full functions") {
    const double theta = 0.9, phi = 1.3;
    constexpr int order = 7;
    double H[order * order], P[polar_count(order)];
    hemispherical_harmonics(order, direction_at(theta, phi), H);
    hemispherical_legendre(order, std::cos(theta), P);
    for (int l = 0; l < order; ++l)
        for (int m = 0; m <= l; ++m) {
            CHECK(H[coefficient_index(l, m)] == doctest::Approx(P[polar_index(l, m)] * std::cos(m * phi)));
            if (m > 0) CHECK(H[coefficient_index(l, -m)] == doctest::Approx(P[polar_index(l, m)] * std::sin(m * phi)));
        }
}

TEST_CASE("irradiance from two hemispherical coefficients") {
    // cosθ = √(π/2) H_00 + (π/3) √(3/2π) H_10: it has no others.
    const auto grid = hemisphere_grid(24);
    std::vector<double> c(size_t(coefficient_count(12))), H(c.size());
    for (const Node& node : grid) {
        hemispherical_harmonics(12, node.w, H.data());
        for (size_t i = 0; i < c.size(); ++i) c[i] += node.weight * node.w.z * H[i];
    }
    CHECK(c[0] == doctest::Approx(std::sqrt(pi_double / 2)));
    CHECK(c[2] == doctest::Approx(pi_double / 3 * std::sqrt(3 / (2 * pi_double))));
    c[0] = c[2] = 0;
    CHECK(norm(c) < 1e-13);
}

TEST_CASE("windows keep the mean and lower high bands") {
    for (const Window window : {Window::hanning, Window::lanczos}) {
        CHECK(window_factor(window, 8, 0) == 1);
        for (int l = 1; l < 8; ++l) {
            CHECK(window_factor(window, 8, l) < window_factor(window, 8, l - 1));
            CHECK(window_factor(window, 8, l) > 0);
        }
    }
    CHECK(window_factor(Window::hanning, 8, 4) == doctest::Approx(0.5));
    CHECK(window_factor(Window::lanczos, 8, 4) == doctest::Approx(2 / pi_double));

    // A step rings: 9 % over its height for ever without a window. With one it overshoots by 2 %.
    constexpr int order = 12;
    std::vector<double> step(size_t(coefficient_count(order))), Y(step.size());
    for (const Node& node : hemisphere_grid(24)) {
        spherical_harmonics(order, node.w, Y.data());
        for (size_t i = 0; i < step.size(); ++i) step[i] += node.weight * Y[i];
    }
    const auto highest = [](const std::vector<double>& c) {
        double most = 0;
        for (int i = 0; i <= 200; ++i)
            most = std::max(most, evaluated(Basis::spherical, order, c, direction_at(pi_double * i / 200, 0)));
        return most;
    };
    CHECK(highest(step) > 1.08);
    for (const Window window : {Window::hanning, Window::lanczos}) {
        std::vector<double> windowed = step;
        apply_window(window, order, windowed);
        CHECK(highest(windowed) < 1.025);
        CHECK(windowed[0] == step[0]);
    }
}
