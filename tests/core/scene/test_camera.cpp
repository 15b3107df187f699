// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <doctest/doctest.h>

#include <cmath>

#include "running_mean.h"
#include "scene/camera.h"

using namespace eclat;

namespace {

/// At (1, 2, 3), looking along −x, up along +z: 80 × 40 pixels, horizontal field of view 90°.
Camera camera() {
    Camera c{};
    c.right = {0, 1, 0};
    c.up = {0, 0, 1};
    c.backward = {1, 0, 0};
    c.position = {1, 2, 3};
    c.width = 80;
    c.height = 40;
    c.half_width = 1;
    c.half_height = 0.5f;
    return c;
}

void check_direction(Vec3 w, Vec3 expected) {
    CHECK(length(w) == doctest::Approx(1).epsilon(1e-6));
    CHECK(length(w - normalize(expected)) < 1e-6f);
}

}  // namespace

TEST_CASE("the middle of the picture looks backwards from backward, its corners along the field of view") {
    const Camera c = camera();
    CHECK(c.ray(40, 20, {}).origin == c.position);
    check_direction(c.ray(40, 20, {}).direction, {-1, 0, 0});
    check_direction(c.ray(80, 20, {}).direction, {-1, 1, 0});    // right edge: 45°
    check_direction(c.ray(0, 0, {}).direction, {-1, -1, 0.5f});  // the top-left corner is left and up
}

TEST_CASE("the principal point is shifted by fractions of the picture") {
    Camera c = camera();
    c.shift = {0.25f, 0};
    check_direction(c.ray(20, 20, {}).direction, {-1, 0, 0});
    c.shift = {0, 0.25f};
    check_direction(c.ray(40, 10, {}).direction, {-1, 0, 0});
}

TEST_CASE("a pixel is as wide as the distance between the rays of its edges") {
    const Camera c = camera();
    const Vec3 a = c.ray(40, 20, {}).direction, b = c.ray(41, 20, {}).direction;
    const float distance = 7;
    CHECK(c.pixel_size_at(distance) == doctest::Approx(distance * std::abs(b.y / b.x - a.y / a.x)).epsilon(1e-5));
}

TEST_CASE("all rays of a pixel through a lens meet in the plane of focus, and leave from a disc") {
    Camera c = camera();
    c.aperture_radius = 0.3f;
    c.focus_distance = 5;
    const Vec3 pinhole = camera().ray(13, 31, {}).direction;
    const Vec3 focus = c.position + pinhole * (5 / -pinhole.x);
    RunningMean radius2;
    for (int i = 0; i < 16; ++i)
        for (int j = 0; j < 16; ++j) {
            const Ray ray = c.ray(13, 31, {(static_cast<float>(i) + 0.5f) / 16, (static_cast<float>(j) + 0.5f) / 16});
            const Vec3 on_lens = ray.origin - c.position;
            CHECK(on_lens.x == 0);
            CHECK(length(on_lens) < 0.3f);
            radius2.add(length_squared(on_lens));
            const Vec3 at_focus = ray.origin + ray.direction * ((c.position.x - 5 - ray.origin.x) / ray.direction.x);
            CHECK(length(at_focus - focus) < 1e-5f);
        }
    CHECK(radius2.mean() == doctest::Approx(0.3 * 0.3 / 2).epsilon(0.01));  // uniform in area
}

TEST_CASE("orthographic rays are parallel, and pixels are equally large at any distance") {
    Camera c = camera();
    c.orthographic = true;
    c.half_width = 4;
    c.half_height = 2;
    const Ray ray = c.ray(80, 0, {});
    check_direction(ray.direction, {-1, 0, 0});
    CHECK(length(ray.origin - Vec3{1, 6, 5}) < 1e-6f);
    CHECK(c.pixel_size_at(1) == c.pixel_size_at(100));
    CHECK(c.pixel_size_at(1) == doctest::Approx(0.1));
}
