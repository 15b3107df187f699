// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Each map of the unit square against its density: by the Jacobian, taken with finite differences.

#include <doctest/doctest.h>

#include "base/vec.h"
#include "sampling/warp.h"

using namespace eclat;

namespace {

constexpr float step = 2e-3f;

/// Area that a map gives to a small square around u, over the square's own.
template <class Map>
float stretch_3d(Map&& map, Vec2 u) {
    const Vec3 dx = map(Vec2{u.x + step, u.y}) - map(Vec2{u.x - step, u.y});
    const Vec3 dy = map(Vec2{u.x, u.y + step}) - map(Vec2{u.x, u.y - step});
    return length(cross(dx, dy)) / (4 * step * step);
}

template <class Map>
float stretch_2d(Map&& map, Vec2 u) {
    return stretch_3d(
        [&](Vec2 v) {
            const Vec2 p = map(v);
            return Vec3{p.x, p.y, 0};
        },
        u);
}

/// Points off the seams of all maps (the diagonals of the square).
template <class F>
void at_interior_points(F&& f) {
    for (int j = 0; j < 9; ++j) {
        for (int i = 0; i < 10; ++i) {
            const Vec2 u{(i + 0.5f) / 10, (j + 0.5f) / 9};
            if (std::abs(u.x - u.y) > 0.02f && std::abs(u.x + u.y - 1) > 0.02f) f(u);
        }
    }
}

}  // namespace

TEST_CASE("sine and cosine of an eighth of a turn are those of the library") {
    for (int i = -1000; i <= 1000; ++i) {
        const float x = static_cast<float>(i) * (pi / 4 / 1000);
        const SineCosine at = sine_and_cosine(x);
        CHECK(std::abs(at.sine - std::sin(double(x))) < 6e-8 + 6e-8 * std::abs(x));
        CHECK(std::abs(at.cosine - std::cos(double(x))) < 1.2e-7);
    }
}

TEST_CASE("the concentric disc is uniform in area and inside the circle") {
    at_interior_points([](Vec2 u) {
        CHECK(stretch_2d(square_to_concentric_disk, u) * concentric_disk_pdf_area() ==
              doctest::Approx(1).epsilon(2e-3));
    });
    for (const Vec2 u : {Vec2{0, 0}, Vec2{0, below_one}, Vec2{below_one, 0}, Vec2{0.5f, 0}, Vec2{0.25f, 0.75f}}) {
        const Vec2 d = square_to_concentric_disk(u);
        CHECK(d.x * d.x + d.y * d.y <= 1 + 1e-6f);
    }
    CHECK(square_to_concentric_disk({0.5f, 0.5f}).x == 0);
}

TEST_CASE("the cosine hemisphere's Jacobian is its density") {
    at_interior_points([](Vec2 u) {
        const Vec3 w = square_to_cosine_hemisphere(u);
        CHECK(length(w) == doctest::Approx(1).epsilon(1e-6));
        const float product = stretch_3d(square_to_cosine_hemisphere, u) * cosine_hemisphere_pdf_solid_angle(w);
        CHECK(product == doctest::Approx(1).epsilon(5e-3));
    });
    CHECK(cosine_hemisphere_pdf_solid_angle({0, 0.8f, -0.6f}) == 0);
    CHECK(square_to_cosine_hemisphere({0, 0.5f}).z >= 0);
}

TEST_CASE("cones of any width are uniform, the sun's too") {
    for (const float drop : {2.0f, 1.0f, 0.3f, 1.08e-5f}) {
        CAPTURE(drop);
        const auto map = [&](Vec2 u) { return square_to_uniform_cone(u, drop); };
        at_interior_points([&](Vec2 u) {
            const Vec3 w = map(u);
            CHECK(length(w) == doctest::Approx(1).epsilon(1e-6));
            CHECK(length_squared(w - Vec3{0, 0, 1}) <= 2 * drop * 1.0001f);
            CHECK(stretch_3d(map, u) * uniform_cone_pdf_solid_angle(drop) == doctest::Approx(1).epsilon(5e-3));
        });
    }
    CHECK(uniform_cone_pdf_solid_angle(2) == doctest::Approx(uniform_sphere_pdf_solid_angle()));
    CHECK(uniform_hemisphere_pdf_solid_angle(square_to_uniform_hemisphere({0.3f, 0.1f})) ==
          uniform_cone_pdf_solid_angle(1));
    CHECK(square_to_uniform_sphere({0.5f, 0.01f}).z < -0.8f);
}

TEST_CASE("the triangle's map is uniform and its weights are barycentric") {
    at_interior_points([](Vec2 u) {
        const Vec2 b = square_to_triangle(u);
        CHECK(b.x >= 0);
        CHECK(b.y >= 0);
        CHECK(b.x + b.y <= 1);
        CHECK(stretch_2d(square_to_triangle, u) * triangle_pdf_area(0.5f) == doctest::Approx(1).epsilon(1e-3));
    });
}

TEST_CASE("a linear density is inverted, also where an end is 0 and where squares would overflow") {
    for (const Vec2 ends :
         {Vec2{1, 1}, Vec2{0, 1}, Vec2{1, 0}, Vec2{0.2f, 3}, Vec2{1e30f, 2e30f}, Vec2{1e-30f, 4e-30f}}) {
        CAPTURE(ends.x);
        CAPTURE(ends.y);
        for (float u = 0.05f; u < 1; u += 0.1f) {
            const float x = unit_to_linear(u, ends.x, ends.y);
            const float slope =
                (unit_to_linear(u + 1e-2f, ends.x, ends.y) - unit_to_linear(u - 1e-2f, ends.x, ends.y)) / 2e-2f;
            CHECK(slope * linear_pdf(x, ends.x, ends.y) == doctest::Approx(1).epsilon(0.02));
        }
        CHECK(unit_to_linear(0, ends.x, ends.y) == 0);
        CHECK(unit_to_linear(below_one, ends.x, ends.y) < 1);
    }
    CHECK(unit_to_linear(0.25f, 0, 0) == 0.25f);
}
