// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "records/spacing.h"

#include <doctest/doctest.h>

using namespace eclat;

namespace {

IrradianceRecord record() {
    IrradianceRecord r;
    r.irradiance = Color(2);
    r.curvature = 4;
    r.distance = 10;
    return r;
}

float length_of(IrradianceRecord r, float footprint, float mean, Metric metric = Metric::occlusion) {
    space(r, r.distance, footprint, mean, {metric, 0.8f, false});
    return r.distance;
}

}  // namespace

TEST_CASE("the relative squared error summed over a record's disc, in pixels, does not depend on curvature") {
    const float footprint = 0.01f;
    const auto summed = [&](float E, float curvature) {
        IrradianceRecord r = record();
        r.irradiance = Color(E);
        r.curvature = curvature;
        space(r, r.distance, footprint, 0, {Metric::occlusion, 0.5f, false});
        // Σ over pixels of (λ d² / 2E)², by rings.
        double sum = 0;
        for (int i = 0; i < 1000; ++i) {
            const double d = (i + 0.5) / 1000 * r.radius, error = curvature * d * d / (2 * E);
            sum += error * error * 2 * pi * d * (r.radius / 1000) / (footprint * footprint);
        }
        return sum;
    };
    CHECK(summed(2, 40) == doctest::Approx(summed(2, 4)).epsilon(1e-3));
    CHECK(summed(0.1f, 4) == doctest::Approx(summed(2, 4)).epsilon(1e-3));
}

TEST_CASE("all lengths scale together, and the unit of light does not matter") {
    const float once = length_of(record(), 0.01f, 1);
    for (const float scale : {0x1p-10f, 0x1p10f}) {
        IrradianceRecord r = record();
        r.distance *= scale;
        r.curvature /= scale * scale;
        CHECK(length_of(r, 0.01f * scale, 1) == doctest::Approx(once * scale));
        IrradianceRecord bright = record();
        bright.irradiance = Color(2 * scale);
        bright.curvature *= scale;
        CHECK(length_of(bright, 0.01f, scale) == doctest::Approx(once));
    }
}

TEST_CASE("near objects, the gradient and darkness bound the length") {
    IrradianceRecord r = record();
    r.distance = 0.05f;
    CHECK(length_of(r, 0.01f, 1) == 0.05f);
    r = record();
    r.curvature = 0;
    CHECK(length_of(r, 0.01f, 1) == 10);
    r = record();
    r.translation.channel = {Vec3{30, 40, 0}, Vec3{30, 40, 0}, Vec3{30, 40, 0}};
    space(r, r.distance, 0.01f, 1, {Metric::occlusion, 1, true});
    CHECK(r.distance == doctest::Approx(2 / 50.0f));
    r = record();
    r.irradiance = Color(1e-6f);
    CHECK(length_of(r, 0.01f, 3) > 10 * length_of(r, 0.01f, 0));
    CHECK(length_of(record(), 0.01f, 3) < 1.02f * length_of(record(), 0.01f, 0));
}

TEST_CASE("distances alone count for the split sphere, and where there are no pixels") {
    CHECK(length_of(record(), 0.01f, 1, Metric::minimum) == 10);
    CHECK(length_of(record(), 0.01f, 1, Metric::harmonic) == 10);
    CHECK(length_of(record(), 0, 1) == 10);
}

TEST_CASE("the radius is bounded, and a larger radius reduces the gradient") {
    IrradianceRecord r = record();
    r.translation.channel = {Vec3{3, 0, 0}, Vec3{3, 0, 0}, Vec3{3, 0, 0}};
    r.least_radius = 20;
    space(r, r.distance, 0, 0, {Metric::minimum, 0.5f, false});
    CHECK(r.radius == 20);
    CHECK(r.translation.channel[0].x == doctest::Approx(0.75f));
    r = record();
    r.largest_radius = 1;
    space(r, r.distance, 0, 0, {Metric::minimum, 0.5f, false});
    CHECK(r.radius == 1);
}

TEST_CASE("with the option `absolute`, the summed absolute error does not depend on curvature") {
    const float footprint = 0.01f;
    const auto summed = [&](float E, float curvature) {
        IrradianceRecord r = record();
        r.irradiance = Color(E);
        r.curvature = curvature;
        space(r, r.distance, footprint, 0, {Metric::occlusion, 0.5f, false, Balanced::absolute});
        // ∫ λ d² / 2E over the disc.
        return curvature / (2 * E) * pi * std::pow(r.radius, 4) / 2 / (footprint * footprint);
    };
    CHECK(summed(2, 40) == doctest::Approx(summed(2, 4)).epsilon(1e-3));
    CHECK(summed(0.1f, 4) == doctest::Approx(summed(2, 4)).epsilon(1e-3));
}

TEST_CASE("the long axis of an ellipse is at most the distance of obstacles") {
    const auto half_length = [](float obstacle, float least) {
        IrradianceRecord r = record();
        r.distance = obstacle;
        r.elongation = 2;
        r.least_radius = least;
        space(r, r.distance, 1, 0, {Metric::occlusion, 0.5f, false});  // curvature alone: 0.5 · (1 · 2 / 4)^(1/3)
        return r.radius * r.elongation;
    };
    const float width = 0.5f * std::cbrt(0.5f);
    CHECK(half_length(10, 0) == doctest::Approx(2 * width));
    CHECK(half_length(1, 0) == doctest::Approx(0.5f));
    CHECK(half_length(0.5f, 0) == doctest::Approx(0.25f));  // the obstacle bounds the circle as well
    CHECK(half_length(0.5f, 0.4f) == doctest::Approx(0.4f));
    CHECK(half_length(infinity, 0) == doctest::Approx(2 * width));
}

TEST_CASE("a record does not reach what it keeps its distance from, however wide the spacing") {
    for (const float spacing : {0.8f, 1.13f, 3.0f}) {
        IrradianceRecord r = record();
        space(r, 0.05f, 0.01f, 1, {Metric::occlusion, spacing, false});
        CHECK(r.radius == doctest::Approx(0.8f * 0.05f));
    }
}

TEST_CASE("ellipses are at most twice as long as wide") {
    CHECK(elongation({1, 1, 0}) == 1);
    CHECK(elongation({4, 1, 0}) == doctest::Approx(std::cbrt(4.0f)));
    CHECK(elongation({8, 1, 0}) == doctest::Approx(2));
    CHECK(elongation({80, 1, 0}) == 2);
    CHECK(elongation({1, 0, 0}) == 2);
    CHECK(elongation({0, 0, 0}) == 1);
}
