// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The fast rotation against the matrices of harmonics/rotation.h, and against functions of rotated directions.

#include <doctest/doctest.h>

#include "hemisphere/radiance_projection.h"
#include "hemisphere/radiance_rotation.h"
#include "harmonics_cases.h"

using namespace eclat;
using namespace eclat::test;

namespace {

Frame turned_frame(Vec3 normal, float turn) {
    const Frame around = Frame::around(normalize(normal));
    const Vec3 u = around.u * std::cos(turn) + around.v * std::sin(turn);
    return {u, cross(around.n, u), around.n};
}

/// Takes coordinates in `from` to those in `to`.
Matrix3 between(const Frame& from, const Frame& to) {
    Matrix3 R;
    const Vec3 rows[3] = {to.u, to.v, to.n}, columns[3] = {from.u, from.v, from.n};
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j) R[3 * i + j] = double(dot(rows[i], columns[j]));
    return R;
}

}  // namespace

TEST_CASE("coefficients in another frame are those of the rotated function") {
    const int order = 8;
    const HemisphereFit fit(order, radiance_tikhonov);
    const RadianceRotation rotate(order);
    const Frame from = turned_frame({0.3f, -0.2f, 1}, 1.1f);
    for (const Vec3 tilt : {Vec3{0.3f, -0.2f, 1}, Vec3{0.31f, -0.2f, 1}, Vec3{0.45f, -0.1f, 1}, Vec3{0.2f, -0.5f, 1}})
        for (const float turn : {0.0f, 2.0f, 3.1f, -1.4f}) {
            const Frame to = turned_frame(tilt, turn);
            // Inner products with Y of a function of low order, continued below the horizon.
            std::vector<double> c = random_coefficients(order, 5);
            std::vector<double> expected(c.size());
            SphericalRotation(order, between(from, to)).apply(c, expected);
            fit.orthonormalize(order, c);
            fit.orthonormalize(order, expected);
            std::vector<float> turned(c.begin(), c.end());
            rotate(from, to, order, turned.data());
            double error = 0, norm = 0;
            for (size_t i = 0; i < c.size(); ++i) {
                error += (double(turned[i]) - expected[i]) * (double(turned[i]) - expected[i]);
                norm += expected[i] * expected[i];
            }
            CHECK(std::sqrt(error) < 5e-3 * std::sqrt(norm));
        }
}

TEST_CASE("a lobe reflects the same in a tilted frame as in its own") {
    // ∫ f L where f is a lobe around a direction well above both horizons, and L a smooth light.
    const int order = 10;
    const HemisphereFit fit(order, radiance_tikhonov);
    const Direction axis = direction_at(0.5, 0.4);
    const auto lobe = [&](Direction w) {
        return std::pow(std::max(0.0, axis.x * w.x + axis.y * w.y + axis.z * w.z), 12);
    };
    const Frame from = turned_frame({0, 0, 1}, 0), to = turned_frame({0.15f, 0.1f, 1}, 0.8f);
    const Matrix3 R = between(from, to);
    const auto light = [](Direction w) { return 1 + w.x + 0.5 * w.x * w.y + 0.3 * w.z; };  // in `from`
    std::vector<double> f(100), L(100), Y(100);
    double expected = 0;
    for (const Node& node : product_grid(gauss_legendre(40), 40)) {
        evaluate_harmonics(Basis::spherical, order, node.w, Y.data());
        expected += node.weight * lobe(node.w) * light(node.w);
        for (size_t i = 0; i < 100; ++i) {
            f[i] += node.weight * lobe(node.w) * Y[i];
            L[i] += node.weight * light(turned_back(R, node.w)) * Y[i];
        }
    }
    fit.orthonormalize(order, f);
    fit.orthonormalize(order, L);
    std::vector<float> turned(f.begin(), f.end());
    RadianceRotation rotate(order);
    rotate(from, to, order, turned.data());
    double reflected = 0;
    for (size_t i = 0; i < 100; ++i) reflected += double(turned[i]) * L[i];
    CHECK(reflected == doctest::Approx(expected).epsilon(0.01));
}
