// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A rotated function is the function of the rotated direction, whichever way the coefficients were rotated.

#include <doctest/doctest.h>

#include "harmonics_cases.h"

using namespace eclat;
using namespace eclat::test;

namespace {

std::vector<double> rotated(int order, const Matrix3& R, const std::vector<double>& c) {
    std::vector<double> out(c.size());
    SphericalRotation(order, R).apply(c, out);
    return out;
}

const std::vector<Matrix3>& rotations() {
    static const std::vector<Matrix3> all{
        about_z(0.3) * about_y(0.7) * about_z(-2),
        about_z(-1.1) * about_y(2.9) * about_z(0.2),
        about_z(2.5) * about_y(0.15) * about_z(1),
        about_y(pi_double / 2),
        about_z(1.2),
        {1, 0, 0, 0, 1, 0, 0, 0, 1},
        {-1, 0, 0, 0, 1, 0, 0, 0, -1},
        {0, 0, 1, 1, 0, 0, 0, 1, 0},
    };
    return all;
}

/// Sum of lobes: no symmetry, nothing below the horizon before and after tilts of up to 0.3.
double lobes(Direction w) {
    const auto lobe = [&](double theta, double phi, double exponent) {
        const Direction a = direction_at(theta, phi);
        return std::pow(std::max(0.0, a.x * w.x + a.y * w.y + a.z * w.z), exponent);
    };
    return lobe(0.1, 0, 6) + 0.7 * lobe(0.3, 1.3, 8) - 0.2 * lobe(0.4, 3, 5);
}

template <class F>
std::vector<double> projected(Basis basis, int order, const std::vector<Node>& grid, const F& f) {
    std::vector<double> c(size_t(coefficient_count(order))), B(c.size());
    for (const Node& node : grid) {
        evaluate_harmonics(basis, order, node.w, B.data());
        for (size_t i = 0; i < c.size(); ++i) c[i] += node.weight * f(node.w) * B[i];
    }
    return c;
}

}  // namespace

TEST_CASE("rotated coefficients evaluate to the function of the rotated direction") {
    constexpr int order = 12;
    const std::vector<double> c = random_coefficients(order, 1);
    for (const Matrix3& R : rotations()) {
        const std::vector<double> turned = rotated(order, R, c);
        for (int i = 0; i < 20; ++i) {
            const Direction w = direction_at(0.15 * i, 0.9 * i);
            const double here = evaluated(Basis::spherical, order, turned, w);
            CHECK(std::fabs(here - evaluated(Basis::spherical, order, c, turned_back(R, w))) < 1e-12 * norm(c));
        }
    }
}

TEST_CASE("rotations compose, and their matrices are orthogonal") {
    constexpr int order = 12;
    const std::vector<double> c = random_coefficients(order, 2);
    for (const Matrix3& A : rotations())
        for (const Matrix3& B : rotations())
            CHECK(distance(rotated(order, A * B, c), rotated(order, A, rotated(order, B, c))) < 1e-12 * norm(c));
    for (const Matrix3& R : rotations()) {
        const SphericalRotation rotation(order, R);
        double worst = 0;
        for (int l = 0; l < order; ++l)
            for (int i = -l; i <= l; ++i)
                for (int j = -l; j <= l; ++j) {
                    double sum = i == j ? -1 : 0;
                    for (int k = -l; k <= l; ++k) sum += rotation.entry(l, i, k) * rotation.entry(l, j, k);
                    worst = std::max(worst, std::fabs(sum));
                }
        CHECK(worst < 1e-12);
    }
}

TEST_CASE("high orders, as hemispherical rotations use them") {
    const std::vector<double> c = random_coefficients(max_harmonic_order, 3);
    for (const Matrix3& R : rotations()) {
        const std::vector<double> turned = rotated(max_harmonic_order, R, c);
        const Direction w = direction_at(0.8, 0.9);
        const double there = evaluated(Basis::spherical, max_harmonic_order, c, turned_back(R, w));
        CHECK(std::fabs(evaluated(Basis::spherical, max_harmonic_order, turned, w) - there) < 1e-10 * norm(c));
    }
}

TEST_CASE("a rotation about z is the same in both bases and by the matrix") {
    constexpr int order = 9;
    const std::vector<double> c = random_coefficients(order, 4);
    std::vector<double> turned = c;
    rotate_about_z(order, 0.8, turned);
    CHECK(distance(turned, rotated(order, about_z(0.8), c)) < 1e-13 * norm(c));
    for (const Basis basis : {Basis::spherical, Basis::hemispherical}) {
        const Direction w = direction_at(1.2, 0.5);
        CHECK(evaluated(basis, order, turned, w) ==
              doctest::Approx(evaluated(basis, order, c, turned_back(about_z(0.8), w))).epsilon(1e-12));
    }
}

TEST_CASE("the series equals the matrix to its tolerance") {
    constexpr int order = 12;
    const std::vector<double> c = random_coefficients(order, 5);
    for (const Matrix3& R : rotations()) {
        const TurnTiltTurn angles = turn_tilt_turn(R);
        const Matrix3 again = about_z(angles.alpha) * about_y(angles.beta) * about_z(angles.gamma);
        for (size_t i = 0; i < 9; ++i) CHECK(again[i] == doctest::Approx(R[i]).epsilon(1e-14));
        if (angles.beta > 0.7) continue;
        for (const double tolerance : {1e-2, 1e-5, 1e-12}) {
            std::vector<double> turned = c;
            rotate_by_series(order, angles, tolerance, turned);
            CHECK(distance(turned, rotated(order, R, c)) <= 1.01 * tolerance * norm(c));
        }
    }
}

TEST_CASE("rotations with tiny tilts keep their rotation about z") {
    constexpr int order = 6;
    const std::vector<double> c = random_coefficients(order, 6);
    for (const double tilt : {1e-9, 1e-17, 1e-300}) {
        // A tilt below the resolution of R leaves α to chance; α + γ must not be.
        const Matrix3 R = about_z(1.9) * about_y(tilt) * about_z(0.4);
        std::vector<double> turned = c;
        rotate_by_series(order, turn_tilt_turn(R), 1e-12, turned);
        CHECK(distance(turned, rotated(order, about_z(2.3), c)) < 1e-7 * norm(c));
    }
}

TEST_CASE("hemispherical coefficients of a function that stays above the horizon") {
    constexpr int order = 10;
    const auto grid = hemisphere_grid(40);
    const std::vector<double> c = projected(Basis::hemispherical, order, grid, lobes);

    // A turn about z is exact.
    std::vector<double> turned = c, exact = c;
    HemisphericalRotation(order, Horizon::continued).apply(about_z(0.6), turned);
    rotate_about_z(order, 0.6, exact);
    CHECK(distance(turned, exact) == 0);

    for (const Horizon horizon : {Horizon::continued, Horizon::dark}) {
        const HemisphericalRotation rotation(order, horizon);
        // By series, and by matrices where the tilt is large.
        for (const double tilt : {0.1, 0.2, 0.6}) {
            const Matrix3 R = about_z(0.5) * about_y(tilt) * about_z(1.1);
            exact = projected(Basis::hemispherical, order, grid, [&](Direction w) { return lobes(turned_back(R, w)); });
            turned = c;
            rotation.apply(R, turned);
            CHECK(distance(turned, exact) < 0.01 * norm(exact));
        }
    }
}

TEST_CASE("the step at the horizon causes the error of hemispherical rotation that the documentation states") {
    constexpr int order = 10;
    const auto grid = hemisphere_grid(40);
    const Matrix3 R = about_z(0.3) * about_y(0.2) * about_z(1);
    const auto loss = [&](Horizon horizon, const auto& f) {
        std::vector<double> turned = projected(Basis::hemispherical, order, grid, f);
        const auto exact =
            projected(Basis::hemispherical, order, grid, [&](Direction w) { return f(turned_back(R, w)); });
        HemisphericalRotation(order, horizon).apply(R, turned);
        return distance(turned, exact) / norm(exact);
    };
    const auto uniform = [](Direction) { return 1.0; };
    const auto from_one_side = [](Direction w) { return 0.5 * (1 + w.x); };
    CHECK(std::fabs(loss(Horizon::continued, uniform) - 0.044) < 0.004);
    CHECK(std::fabs(loss(Horizon::dark, uniform) - 0.233) < 0.01);
    CHECK(std::fabs(loss(Horizon::continued, from_one_side) - 0.028) < 0.003);
    CHECK(std::fabs(loss(Horizon::dark, from_one_side) - 0.149) < 0.008);

    // Noise must not grow.
    const HemisphericalRotation rotation(order, Horizon::continued);
    double before = 0, after = 0;
    for (uint32_t seed = 0; seed < 20; ++seed) {
        std::vector<double> noise = random_coefficients(order, 100 + seed);
        before += norm(noise);
        rotation.apply(R, noise);
        after += norm(noise);
    }
    CHECK(after < 1.15 * before);

    // A random spectrum that falls like 1 / (l + 1), to spherical harmonics of equal order and back: two fifths
    // are lost; through twice the order, a seventh.
    const auto round_trip = [&](int spherical_order) {
        const HemisphericalRotation dark(order, Horizon::dark, spherical_order);
        double lost = 0;
        for (uint32_t seed = 0; seed < 20; ++seed) {
            std::vector<double> c = random_coefficients(order, 200 + seed);
            for (int l = 0; l < order; ++l)
                for (int m = -l; m <= l; ++m) c[size_t(coefficient_index(l, m))] /= l + 1;
            std::vector<double> back = c;
            dark.from_spherical(dark.to_spherical(c), back);
            lost += distance(back, c) / norm(c) / 20;
        }
        return lost;
    };
    CHECK(std::fabs(round_trip(10) - 0.40) < 0.01);
    CHECK(std::fabs(round_trip(20) - 0.14) < 0.01);
}

TEST_CASE("spherical coefficients of a hemispherical function are those by quadrature") {
    constexpr int order = 5, spherical_order = 9;
    const std::vector<double> c = random_coefficients(order, 7);
    const auto f = [&](Direction w) { return evaluated(Basis::hemispherical, order, c, w); };
    const std::vector<double> exact = projected(Basis::spherical, spherical_order, hemisphere_grid(24), f);
    CHECK(distance(HemisphericalRotation(order, Horizon::dark, spherical_order).to_spherical(c), exact) < 1e-12);
}

TEST_CASE("matrices that are no rotations are refused") {
    const std::vector<Matrix3> wrong{
        {1, 0, 0, 0, 1, 0, 0, 0, 1.001}, {1, 0, 0, 0, 1, 0, 0, 0, -1}, {1, 0, 0, 0, std::nan(""), 0, 0, 0, 1}};
    for (const Matrix3& R : wrong) CHECK_THROWS_AS(SphericalRotation(3, R), std::invalid_argument);
    CHECK_THROWS_AS(HemisphericalRotation(4, Horizon::dark, 3), std::invalid_argument);
    CHECK_THROWS_AS(SphericalRotation(max_harmonic_order + 1, about_z(1)), std::invalid_argument);
}
