// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Solid angles and uniform directions of triangles, against closed forms and the map's Jacobian.

#include <doctest/doctest.h>

#include "sampling/rng.h"
#include "sampling/spherical_triangle.h"

using namespace eclat;

namespace {

Vec3 direction(Rng& rng) {
    for (;;) {
        const Vec3 v{2 * rng.next() - 1, 2 * rng.next() - 1, 2 * rng.next() - 1};
        if (length(v) > 0.1f && length(v) < 1) return normalize(v);
    }
}

/// A triangle from directions to its corners.
SphericalTriangle around(Vec3 a, Vec3 b, Vec3 c) {
    return SphericalTriangle::seen(Vec3d(a), Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a));
}

/// Girard's theorem: the angles' excess over π.
double excess(Vec3 a, Vec3 b, Vec3 c) {
    const auto angle = [](Vec3 at, Vec3 p, Vec3 q) {
        const Vec3 u = p - at * dot(p, at), v = q - at * dot(q, at);
        return std::atan2(double(length(cross(u, v))), double(dot(u, v)));
    };
    return angle(a, b, c) + angle(b, c, a) + angle(c, a, b) - double(pi);
}

}  // namespace

TEST_CASE("an octant is an eighth of the sphere in any orientation") {
    const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
    CHECK(around(x, y, z).solid_angle == doctest::Approx(pi / 2));
    CHECK(around(y, x, z).solid_angle == doctest::Approx(pi / 2));
    CHECK(std::isnan(around(x, y, Vec3()).solid_angle));
}

TEST_CASE("solid angles agree with the excess of the angles, directions are uniform and inside") {
    Rng rng(1, 2);
    int tried = 0;
    for (int i = 0; i < 400; ++i) {
        const Vec3 a = direction(rng), b = direction(rng), c = direction(rng);
        const SphericalTriangle t = around(a, b, c);
        if (t.solid_angle < 0.05f || t.volume < 0.02f) continue;
        ++tried;
        CHECK(t.solid_angle == doctest::Approx(excess(a, b, c)).epsilon(1e-4));
        const float side = dot(a, cross(b, c)) > 0 ? 1 : -1;
        const Vec2 u{0.1f + 0.8f * rng.next(), 0.1f + 0.8f * rng.next()};
        const Vec3 w(t.sample(u));
        CHECK(length(w) == doctest::Approx(1).epsilon(1e-5));
        CHECK(side * dot(w, cross(a, b)) > -1e-5f);
        CHECK(side * dot(w, cross(b, c)) > -1e-5f);
        CHECK(side * dot(w, cross(c, a)) > -1e-5f);
        // A finite difference sees the map as smooth only away from hairpin bends of obtuse triangles.
        const float h = 1e-2f;
        const Vec3d dx = t.sample({u.x + h, u.y}) - t.sample({u.x - h, u.y});
        const Vec3d dy = t.sample({u.x, u.y + h}) - t.sample({u.x, u.y - h});
        CHECK(length(cross(dx, dy)) / (4 * h * h) == doctest::Approx(t.solid_angle).epsilon(0.06));
    }
    CHECK(tried > 200);
}

TEST_CASE("corners of the square go to the triangle's corners") {
    const Vec3 a = normalize({1, 0.2f, 0.1f}), b = normalize({0.1f, 1, 0.3f}), c = normalize({0, 0.1f, 1});
    const SphericalTriangle t = around(a, b, c);
    CHECK(length(t.sample({0, 1}) - Vec3d(a)) < 1e-5f);
    CHECK(length(t.sample({0.3f, 0}) - Vec3d(b)) < 1e-5f);
    CHECK(length(t.sample({1, 1}) - Vec3d(c)) < 1e-5f);
}

TEST_CASE("directions are uniform over a triangle that fills almost half of all directions") {
    // The cap within 60° of the zenith, and its eastern half, are whole; floats lost the spread at a height of 10⁻⁵.
    for (const double height : {1e-1, 1e-3, 1e-5, 1e-7, 1e-9}) {
        CAPTURE(height);
        const SphericalTriangle t = SphericalTriangle::seen({-1, -1, height}, {3, 0, 0}, {0, 3, 0});
        CHECK(t.solid_angle <= 2 * M_PI * (1 + 1e-12));
        constexpr int n = 20000;
        double upper = 0, east = 0;
        Rng rng(3, 4);
        for (int i = 0; i < n; ++i) {
            const Vec3d w = t.sample({rng.next(), rng.next()});
            REQUIRE(std::isfinite(w.x + w.y + w.z));
            REQUIRE(w.z > 0);
            if (w.z > 0.5) upper += 1.0 / n;
            if (w.x > 0 && w.z > 0.5) east += 1.0 / n;
        }
        CHECK(upper == doctest::Approx(M_PI / t.solid_angle).epsilon(0.02));
        CHECK(east == doctest::Approx(M_PI / 2 / t.solid_angle).epsilon(0.02));
    }
}

TEST_CASE("a triangle that is seen edge-on keeps its solid angle and its directions") {
    // From beside the triangle, at a height h: the solid angle is h times ∫∫ dx dy / r³ to first order.
    const auto seen_from_beside = [](double h) { return SphericalTriangle::seen({1, -1, h}, {0, 2, 0}, {2, 1, 0}); };
    const double per_height = seen_from_beside(1e-3).solid_angle / 1e-3;
    for (const double height : {1e-4, 1e-6, 1e-8, 1e-10}) {
        CAPTURE(height);
        const SphericalTriangle t = seen_from_beside(height);
        CHECK(t.solid_angle / height == doctest::Approx(per_height).epsilon(1e-5));
        Rng rng(5, 6);
        for (int i = 0; i < 1000; ++i) {
            const Vec3d w = t.sample({rng.next(), rng.next()});
            const double x = w.x * height / w.z, y = w.y * height / w.z;  // where it meets the plane
            REQUIRE(x > 1 - 1e-4);
            REQUIRE(x < 3 + 1e-4);
            REQUIRE(std::abs(y) < 1 + 1e-4);
        }
    }
}
