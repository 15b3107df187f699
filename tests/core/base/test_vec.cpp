// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Vectors and colours: what every formula above them takes for granted.

#include <doctest/doctest.h>

#include "base/color.h"
#include "base/vec.h"
#include "sampling/rng.h"

using namespace eclat;

TEST_CASE("cross product: right-handed, at right angles to both, as long as the parallelogram is large") {
    CHECK(cross({1, 0, 0}, {0, 1, 0}) == Vec3{0, 0, 1});
    Rng rng(1, 2);
    for (int i = 0; i < 1000; ++i) {
        const Vec3 a{rng.next() - 0.5f, rng.next() - 0.5f, rng.next() - 0.5f};
        const Vec3 b{rng.next() - 0.5f, rng.next() - 0.5f, rng.next() - 0.5f};
        const Vec3 c = cross(a, b);
        CHECK(std::abs(dot(c, a)) < 1e-7f);
        CHECK(std::abs(dot(c, b)) < 1e-7f);
        const float area2 = length_squared(a) * length_squared(b) - sqr(dot(a, b));
        CHECK(length_squared(c) == doctest::Approx(area2).epsilon(1e-3).scale(1e-3));
        CHECK(length(normalize(a)) == doctest::Approx(1).epsilon(1e-6));
    }
}

TEST_CASE("the root of a rounding error below zero is 0 and not NaN") {
    CHECK(safe_sqrt(-1e-9f) == 0);
    CHECK(safe_sqrt(4) == 2);
    CHECK(clamp(3, 0, 1) == 1);
    CHECK(clamp(-3, 0, 1) == 0);
    CHECK(lerp(2, 6, 0.25f) == 3);
}

TEST_CASE("components that are not finite are reported") {
    for (int i = 0; i < 3; ++i) {
        Color c(1);
        c[i] = infinity;
        CHECK_FALSE(is_finite(c));
        c[i] = infinity - infinity;
        CHECK_FALSE(is_finite(c));
        CHECK_FALSE(is_finite(Vec3{c.r, c.g, c.b}));
    }
    CHECK(is_finite(Color(1e30f)));
}

TEST_CASE("luminance of Rec. 709: white is 1, and green weighs most") {
    CHECK(luminance(Color(1)) == doctest::Approx(1).epsilon(1e-6));
    CHECK(luminance({0, 1, 0}) == doctest::Approx(0.7152));
    CHECK(luminance({1, 0, 0}) == doctest::Approx(0.2126));
    CHECK(max_component(Color(1, 3, 2)) == 3);
    CHECK(mean(Color(1, 3, 2)) == doctest::Approx(2));
    CHECK(is_black(Color(0)));
    CHECK_FALSE(is_black(Color(0, 0, 1e-30f)));
}
