// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "lights/environment_split.h"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "lights/environment.h"
#include "sampling/sampler.h"

using namespace eclat;

namespace {

constexpr uint32_t width = 256, height = 128;

/// Radiance by the polar angle θ and the azimuth φ.
std::vector<float> image(const std::function<float(double, double)>& radiance) {
    std::vector<float> out;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            const float L = radiance(M_PI * (y + 0.5) / height, 2 * M_PI * (x + 0.5) / width);
            out.insert(out.end(), {L, 0.5f * L, 0.25f * L});
        }
    return out;
}

float limit_of(const std::function<float(double, double)>& radiance) {
    return smooth_limit(image(radiance), width, height);
}

/// A sun of a few texels around (θ, φ) in a sky of 0.3.
std::function<float(double, double)> sun_at(double theta, double phi, float radiance, double radius = 0.03) {
    return [=](double t, double p) {
        const double cosine = std::cos(t) * std::cos(theta) + std::sin(t) * std::sin(theta) * std::cos(p - phi);
        return cosine > std::cos(radius) ? radiance : 0.3f;
    };
}

EnvironmentImage environment(const std::vector<float>& rgb) {
    return EnvironmentImage(rgb, width, height, {1, 0, 0, 0, 1, 0, 0, 0, 1});
}

}  // namespace

TEST_CASE("smooth skies have no sharp part") {
    CHECK(limit_of([](double, double) { return 1.0f; }) == infinity);
    CHECK(limit_of([](double, double) { return 0.0f; }) == infinity);
    CHECK(limit_of([](double t, double) { return t < M_PI / 2 ? 1.0f : 0.0f; }) == infinity);  // a horizon
    CHECK(limit_of([](double t, double p) { return float(2 + std::cos(t) + std::sin(t) * std::cos(p)); }) == infinity);
    CHECK(limit_of([](double t, double) { return float(1 + 20 * std::exp(-t * t / 0.1)); }) ==
          infinity);  // a wide glow
}

TEST_CASE("a sun belongs to the sharp part at any position, and the sky around it does not") {
    for (const double theta : {0.0, 0.01, 0.3, 1.5, M_PI})
        for (const double phi : {0.0, 1.0, 6.28}) {
            const float limit = limit_of(sun_at(theta, phi, 20000));
            CHECK(limit > 0.3f * luminance(Color(1, 0.5f, 0.25f)));
            CHECK(limit < 100);
        }
}

TEST_CASE("the limit is a radiance: it scales with the image") {
    const float one = limit_of(sun_at(0.6, 1, 2000));
    auto bright = image(sun_at(0.6, 1, 2000));
    for (float& x : bright) x *= 1024;
    CHECK(smooth_limit(bright, width, height) == doctest::Approx(1024 * one).epsilon(1e-4));
}

TEST_CASE("a lamp on a black sky belongs completely to the sharp part") {
    CHECK(limit_of([](double t, double p) { return t > 1 && t < 1.02 && p > 1 && p < 1.03 ? 5.0f : 0.0f; }) < 1e-6f);
}

TEST_CASE("images with one row, one column or one texel") {
    for (const auto& [w, h] : {std::pair{1u, 1u}, {8u, 1u}, {1u, 8u}}) {
        std::vector<float> rgb(size_t(3) * w * h, 1.0f);
        CHECK(smooth_limit(rgb, w, h) == infinity);
        rgb[0] = rgb[1] = rgb[2] = 100;
        CHECK(smooth_limit(rgb, w, h) == infinity);  // texels are wider than a gather's cells
    }
}

TEST_CASE("the smooth and the sharp part are not negative and add up to the image, between texels too") {
    const EnvironmentImage all = environment(image(sun_at(0.6, 1, 20000)));
    const auto sharp = all.sharp_part();
    REQUIRE(sharp.has_value());
    float most = 0;
    for (uint32_t i = 0; i < 20000; ++i) {
        Sampler sampler(7, i, 0);
        Vec3 w = square_to_uniform_sphere(sampler.next_2d());
        if (i % 2) w = sharp->sample(sampler.next_2d()).wi;
        const Color whole = all.radiance(w), a = all.smooth_radiance(w), b = sharp->radiance(w);
        for (int c = 0; c < 3; ++c) {
            CHECK(a[c] >= 0);
            CHECK(b[c] >= 0);
            CHECK(a[c] + b[c] == doctest::Approx(whole[c]).epsilon(1e-5));
        }
        most = std::max(most, luminance(a));
    }
    CHECK(most <= 1.001f * smooth_limit(image(sun_at(0.6, 1, 20000)), width, height));
}
