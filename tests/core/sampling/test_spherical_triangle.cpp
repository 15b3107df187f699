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
    CHECK(SphericalTriangle::around(x, y, z).solid_angle == doctest::Approx(pi / 2));
    CHECK(SphericalTriangle::around(y, x, z).solid_angle == doctest::Approx(pi / 2));
    CHECK(std::isnan(SphericalTriangle::around(x, y, normalize(Vec3())).solid_angle));
}

TEST_CASE("solid angles agree with the excess of the angles, directions are uniform and inside") {
    Rng rng(1, 2);
    int tried = 0;
    for (int i = 0; i < 400; ++i) {
        const Vec3 a = direction(rng), b = direction(rng), c = direction(rng);
        const SphericalTriangle t = SphericalTriangle::around(a, b, c);
        if (t.solid_angle < 0.05f || t.volume < 0.02f) continue;
        ++tried;
        CHECK(t.solid_angle == doctest::Approx(excess(a, b, c)).epsilon(1e-4));
        const float side = dot(a, cross(b, c)) > 0 ? 1 : -1;
        const Vec2 u{0.1f + 0.8f * rng.next(), 0.1f + 0.8f * rng.next()};
        const Vec3 w = t.sample(u);
        CHECK(length(w) == doctest::Approx(1).epsilon(1e-5));
        CHECK(side * dot(w, cross(a, b)) > -1e-5f);
        CHECK(side * dot(w, cross(b, c)) > -1e-5f);
        CHECK(side * dot(w, cross(c, a)) > -1e-5f);
        // A finite difference sees the map as smooth only away from hairpin bends of obtuse triangles.
        const float h = 1e-2f;
        const Vec3 dx = t.sample({u.x + h, u.y}) - t.sample({u.x - h, u.y});
        const Vec3 dy = t.sample({u.x, u.y + h}) - t.sample({u.x, u.y - h});
        CHECK(length(cross(dx, dy)) / (4 * h * h) == doctest::Approx(t.solid_angle).epsilon(0.06));
    }
    CHECK(tried > 200);
}

TEST_CASE("corners of the square go to the triangle's corners") {
    const Vec3 a = normalize({1, 0.2f, 0.1f}), b = normalize({0.1f, 1, 0.3f}), c = normalize({0, 0.1f, 1});
    const SphericalTriangle t = SphericalTriangle::around(a, b, c);
    CHECK(length(t.sample({0, 1}) - a) < 1e-5f);
    CHECK(length(t.sample({0.3f, 0}) - b) < 1e-5f);
    CHECK(length(t.sample({1, 1}) - c) < 1e-5f);
}

TEST_CASE("a triangle that fills almost half of all directions, or is seen edge-on, stays finite") {
    for (const float height : {1e-1f, 1e-3f, 1e-5f, 1e-7f}) {
        const auto corner = [&](float x, float y) { return normalize({x, y, height}); };
        const SphericalTriangle t = SphericalTriangle::around(corner(-1, -1), corner(2, -1), corner(-1, 2));
        CHECK(t.solid_angle <= 2 * pi * 1.0001f);
        Rng rng(3, 4);
        for (int i = 0; i < 1000; ++i) {
            const Vec3 w = t.sample({rng.next(), rng.next()});
            CHECK(is_finite(w));
            CHECK(w.z > -1e-4f);
        }
    }
}
