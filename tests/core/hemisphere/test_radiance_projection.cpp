// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Coefficients of gathers against closed forms, and their gradients against finite differences of integrals over the very
// rectangles that the gather sees.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "hemisphere/radiance_projection.h"
#include "harmonics/quadrature.h"
#include "harmonics_cases.h"
#include "plate_scene.h"

using namespace eclat;
using namespace eclat::test;

namespace {

/// Orthonormal coefficients of cosθ: their dot product with those of light is irradiance.
std::vector<double> cosine(const RadianceProjection& projection) {
    std::vector<double> b(size_t(coefficient_count(projection.order()))), Y(b.size());
    for (const Node& node : product_grid(gauss_legendre(24), 24)) {
        evaluate_harmonics(Basis::spherical, projection.order(), node.w, Y.data());
        for (size_t i = 0; i < b.size(); ++i) b[i] += node.weight * node.w.z * Y[i];
    }
    projection.fit().orthonormalize(projection.order(), b);
    return b;
}

template <class Values>
double dot(const std::vector<double>& a, const Values* b) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i) sum += a[i] * double(b[i]);
    return sum;
}

/// A gather of the plate scene with rows of either kind, turned by an angle.
HemisphereSamples turned_gather(Rows kind, int rows, float x, float y, float turn, uint32_t seed) {
    HemisphereSamples s;
    s.rows = rows;
    s.columns = columns_for(rows);
    s.kind = kind;
    const Frame around = Frame::around({0, 0, 1});
    const Vec3 u = around.u * std::cos(turn) + around.v * std::sin(turn);
    s.frame = {u, cross(around.n, u), around.n};
    Rng rng(7, seed);
    for (int j = 0; j < s.rows; ++j)
        for (int k = 0; k < s.columns; ++k) {
            const float u1 = rng.next(), u2 = rng.next();
            const Vec3 local = cell_direction(s.rows, s.columns, j, k, {u1, u2}, kind), w = s.frame.to_world(local);
            float radiance = 0, distance = infinity;
            for (const Rectangle& r : scene) {
                const float t = r.z / w.z, hx = x + t * w.x, hy = y + t * w.y;
                if (t < distance && hx > r.x0 && hx < r.x1 && hy > r.y0 && hy < r.y1) {
                    radiance = r.radiance;
                    distance = t;
                }
            }
            s.radiance.emplace_back(radiance);
            s.distance.push_back(distance);
            s.direction.push_back(local);
        }
    return s;
}

/// Adds ∫ Y over the rectangle as seen from (px, py, 0), times `scale`.
void add_rectangle(double x0, double x1, double y0, double y1, double z, double px, double py, int order, double scale,
                   std::vector<double>& b) {
    if (!(x1 > x0 && y1 > y0)) return;
    std::vector<double> Y(b.size());
    const auto nodes = gauss_legendre(24);
    for (const QuadratureNode& s : nodes)
        for (const QuadratureNode& t : nodes) {
            const double x = x0 + (x1 - x0) * s.x - px, y = y0 + (y1 - y0) * t.x - py;
            const double r2 = x * x + y * y + z * z, r = std::sqrt(r2);
            evaluate_harmonics(Basis::spherical, order, {x / r, y / r, z / r}, Y.data());
            const double solid_angle = z / (r2 * r) * (x1 - x0) * (y1 - y0) * s.weight * t.weight;
            for (size_t i = 0; i < b.size(); ++i) b[i] += scale * solid_angle * Y[i];
        }
}

/// What changes with the point: patch and plate before the ceiling, whose edges are far away.
std::vector<double> exact_coefficients(const RadianceProjection& projection, double x, double y) {
    const int order = projection.order();
    std::vector<double> b(size_t(coefficient_count(order)));
    const Rectangle &patch = scene[1], &plate = scene[2];
    add_rectangle(patch.x0, patch.x1, patch.y0, patch.y1, patch.z, x, y, order, 2, b);
    add_rectangle(plate.x0, plate.x1, plate.y0, plate.y1, plate.z, x, y, order, -1, b);
    const double scale = double(patch.z) / plate.z;
    const auto project = [&](double c, double p) { return p + (c - p) * scale; };
    add_rectangle(std::max<double>(patch.x0, project(plate.x0, x)), std::min<double>(patch.x1, project(plate.x1, x)),
                  std::max<double>(patch.y0, project(plate.y0, y)), std::min<double>(patch.y1, project(plate.y1, y)),
                  patch.z, x, y, order, -2, b);
    projection.fit().orthonormalize(order, b);
    return b;
}

}  // namespace

TEST_CASE("light of radiance 1 has the coefficients of 1, whatever the directions in the cells") {
    for (const Rows kind : {Rows::cosine, Rows::balanced}) {
        const RadianceProjection projection(8, kind, 12);
        HemisphereSamples s = turned_gather(kind, 12, 0, 0, 0.7f, 1);
        for (Color& L : s.radiance) L = Color(1, 2, 3);
        const RadianceCoefficients c = projection(s);
        std::vector<double> one(64), Y(64);
        for (const Node& node : product_grid(gauss_legendre(24), 24)) {
            evaluate_harmonics(Basis::spherical, 8, node.w, Y.data());
            for (size_t i = 0; i < 64; ++i) one[i] += node.weight * Y[i];
        }
        projection.fit().orthonormalize(8, one);
        for (size_t i = 0; i < 64; ++i) {
            CHECK(double(c.values[i]) == doctest::Approx(one[i]).epsilon(1e-5));
            CHECK(double(c.values[128 + i]) == doctest::Approx(3 * one[i]).epsilon(1e-5));
        }
        CHECK(dot(cosine(projection), c.values.data()) == doctest::Approx(pi_double).epsilon(1e-4));
        for (const float g : c.gradients) CHECK(std::fabs(g) < 1e-5f);
    }
}

TEST_CASE("the inner product of coefficients with the cosine is the irradiance of the same gather") {
    for (const Rows kind : {Rows::cosine, Rows::balanced}) {
        const RadianceProjection projection(6, kind, 20);
        const HemisphereSamples s = turned_gather(kind, 20, 0.3f, 0.2f, 2, 3);
        CHECK(dot(cosine(projection), projection(s).values.data()) ==
              doctest::Approx(double(irradiance(s).g)).epsilon(2e-4));
        CHECK(double(irradiance(s).g) == doctest::Approx(exact(0.3, 0.2)).epsilon(0.02));
    }
}

TEST_CASE("translation gradient of every coefficient against finite differences") {
    const double x = 0.3, y = 0.2, h = 1e-3;
    const RadianceProjection projection(6, Rows::balanced, 64);
    const auto difference = [&](double dx, double dy) {
        std::vector<double> d = exact_coefficients(projection, x + dx, y + dy);
        const std::vector<double> before = exact_coefficients(projection, x - dx, y - dy);
        for (size_t i = 0; i < d.size(); ++i) d[i] = (d[i] - before[i]) / (2 * h);
        return d;
    };
    const std::vector<double> along[2] = {difference(h, 0), difference(0, h)};
    std::vector<double> mean[2] = {std::vector<double>(36), std::vector<double>(36)};
    constexpr int gathers = 8;  // their mean shows the bias
    const Frame frame = Frame::around({0, 0, 1});
    REQUIRE(frame.u.x == 1);
    for (int i = 0; i < gathers; ++i) {
        const auto c =
            projection(turned_gather(Rows::balanced, 64, float(x), float(y), 0.7f * float(i), uint32_t(10 + i)));
        for (size_t axis = 0; axis < 2; ++axis)
            for (size_t k = 0; k < 36; ++k) mean[axis][k] += double(c.gradients[axis * 108 + k]) / gathers;
    }
    for (size_t axis = 0; axis < 2; ++axis) {
        std::vector<double> error = mean[axis];
        for (size_t k = 0; k < error.size(); ++k) error[k] -= along[axis][k];
        CHECK(norm(error) < 0.04 * norm(along[0]));
    }
}

TEST_CASE("inner products of the gradients with the cosine are the gradients of irradiance") {
    for (const Rows kind : {Rows::cosine, Rows::balanced}) {
        const RadianceProjection projection(6, kind, 32);
        const HemisphereSamples s = turned_gather(kind, 32, 0.3f, 0.2f, 1, 3);
        const RadianceCoefficients c = projection(s);
        const TranslationGradient g = translation_gradient(s);
        const std::vector<double> cos = cosine(projection);
        const double scale = std::hypot(double(g.channel[0].x), double(g.channel[0].y));
        CHECK(std::fabs(dot(cos, c.gradients.data()) - double(g.channel[0].x)) < 0.01 * scale);
        CHECK(std::fabs(dot(cos, c.gradients.data() + 108) - double(g.channel[0].y)) < 0.01 * scale);
    }
}

TEST_CASE("samples of another grid than that of the projection are refused") {
    const RadianceProjection projection(4, Rows::balanced, 10);
    CHECK_THROWS_AS(projection(turned_gather(Rows::balanced, 12, 0, 0, 0, 1)), std::invalid_argument);
    CHECK_THROWS_AS(projection(turned_gather(Rows::cosine, 10, 0, 0, 0, 1)), std::invalid_argument);
    CHECK_THROWS_AS(RadianceProjection(13, Rows::balanced, 10), std::invalid_argument);
}
