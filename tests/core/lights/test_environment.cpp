// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The environment's image: orientation, the bilinear interpolant, and a density that is exactly its luminance.

#include <doctest/doctest.h>

#include <initializer_list>
#include <stdexcept>

#include "lights/environment.h"
#include "running_mean.h"
#include "sampling/rng.h"

using namespace eclat;

namespace {

constexpr std::array<float, 9> identity = {1, 0, 0, 0, 1, 0, 0, 0, 1};
constexpr std::array<float, 9> turned = {0, 0, 1, 0.6f, 0.8f, 0, -0.8f, 0.6f, 0};

/// Mostly dark, with a bright texel and noise over many orders.
std::vector<float> night(uint32_t width, uint32_t height) {
    std::vector<float> rgb(size_t(width) * height * 3, 0);
    Rng rng(4, width);
    for (size_t i = 0; i + 2 < rgb.size(); i += 3) {
        if (rng.next() < 0.5f) continue;
        for (int c = 0; c < 3; ++c) rgb[i + c] = std::pow(rng.next(), 4.0f);
    }
    const size_t star = (size_t(height / 3) * width + width / 2) * 3;
    rgb[star] = rgb[star + 1] = rgb[star + 2] = 500;
    return rgb;
}

/// Midpoint quadrature over the sphere, in coordinates other than the image's.
template <class F>
double integrate(F&& f) {
    const int rows = 700, columns = 1400;
    double sum = 0;
    for (int j = 0; j < rows; ++j) {
        const double x = 1 - 2 * (j + 0.5) / rows, r = std::sqrt(1 - x * x);
        for (int i = 0; i < columns; ++i) {
            const double phi = 2 * M_PI * (i + 0.5) / columns;
            sum += f(Vec3{float(x), float(r * std::cos(phi)), float(r * std::sin(phi))});
        }
    }
    return sum * 4 * M_PI / (double(rows) * columns);
}

}  // namespace

TEST_CASE("orientation: the image's centre is −z, its right half +x, its first row +y") {
    // Texels 0..7 in red; rows 0..3 in green.
    std::vector<float> rgb;
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 8; ++x) rgb.insert(rgb.end(), {float(x), float(y), 0});
    }
    const EnvironmentImage e(rgb, 8, 4, identity);
    CHECK(e.radiance({0, 0, -1}).r == doctest::Approx(3.5));
    CHECK(e.radiance({1, 0, 0}).r == doctest::Approx(5.5));
    CHECK(e.radiance({-1, 0, 0}).r == doctest::Approx(1.5));
    CHECK(e.radiance({0, 0, 1}).r == doctest::Approx(3.5));  // between the last column and the first
    CHECK(e.radiance({0, 1, 0}).g == 0);
    CHECK(e.radiance({0, -1, 0}).g == 3);
    CHECK(e.radiance({0, 0, -1}).g == doctest::Approx(1.5));
    // to_world takes −z of the image to −x of the world.
    const EnvironmentImage rotated(rgb, 8, 4, turned);
    CHECK(rotated.radiance({-1, 0, 0}).r == doctest::Approx(3.5));
    CHECK(rotated.radiance({0, 0.8f, 0.6f}).g == 0);
}

TEST_CASE("the density integrates to one and is zero only where the radiance is") {
    for (const auto& [width, height] : {std::pair{1u, 3u}, {3u, 1u}, {2u, 2u}, {16u, 8u}, {64u, 32u}}) {
        CAPTURE(width);
        const EnvironmentImage e(night(width, height), width, height, turned);
        double missed = 0;
        const double total = integrate([&](Vec3 w) {
            const EnvironmentImage::Lookup at = e.lookup(w);
            if (at.pdf_solid_angle == 0) missed += luminance(at.radiance);
            return at.pdf_solid_angle;
        });
        // The quadrature sees the star's flanks with steps of a quarter of a degree.
        CHECK(total == doctest::Approx(1).epsilon(2e-3));
        CHECK(missed == 0);
        CHECK(e.integral().g == doctest::Approx(integrate([&](Vec3 w) { return e.radiance(w).g; })).epsilon(2e-3));
    }
}

TEST_CASE("samples have the density and radiance of their direction and integrate radiance and irradiance") {
    for (const auto& [width, height] : {std::pair{2u, 2u}, {16u, 8u}, {64u, 32u}}) {
        CAPTURE(width);
        const EnvironmentImage e(night(width, height), width, height, turned);
        const Vec3 n = normalize({0.3f, -0.5f, 0.8f});
        RunningMean luminance_mean, red, irradiance;
        int differing = 0;
        Rng rng(5, width);
        for (int i = 0; i < 200000; ++i) {
            const LightSample s = e.sample({rng.next(), rng.next()});
            REQUIRE(s.pdf_solid_angle > 0);
            const EnvironmentImage::Lookup seen = e.lookup(s.wi);
            differing += std::abs(seen.pdf_solid_angle / s.pdf_solid_angle - 1) > 1e-3f ||
                         std::abs(seen.radiance.g - s.radiance.g) > 1e-3f * s.radiance.g;
            luminance_mean.add(luminance(s.radiance) / s.pdf_solid_angle);
            red.add(s.radiance.r / s.pdf_solid_angle);
            irradiance.add(s.radiance.g * std::max(0.0f, dot(s.wi, n)) / s.pdf_solid_angle);
        }
        // Rounding may carry a direction over a row's border or into the flank of the star.
        CHECK(differing < 200);
        CHECK(luminance_mean.agrees(luminance(e.integral())));
        CHECK(red.agrees(e.integral().r));
        const double expected = integrate([&](Vec3 w) { return e.radiance(w).g * std::max(0.0f, dot(w, n)); });
        CHECK(irradiance.mean() ==
              doctest::Approx(expected).epsilon(5 * irradiance.standard_error() / expected + 2e-3));
        // Only the variation of sin θ in a row is left as noise, and that is small in high images.
        if (height == 32) CHECK(luminance_mean.standard_error() * std::sqrt(200000) < 0.1 * luminance_mean.mean());
    }
}

TEST_CASE("frequencies of directions follow the density") {
    const EnvironmentImage e(night(8, 4), 8, 4, identity);
    // Expected share of each octant and of bands in between, by quadrature.
    const auto bin = [](Vec3 w) { return (w.x > 0) + 2 * (w.y > 0) + 4 * (w.z > 0) + 8 * (std::abs(w.y) > 0.5f); };
    std::array<double, 16> expected{}, count{};
    integrate([&](Vec3 w) {
        expected[bin(w)] += e.pdf_solid_angle(w) * 4 * M_PI / (700.0 * 1400);
        return 0.0;
    });
    Rng rng(6, 6);
    const int n = 400000;
    for (int i = 0; i < n; ++i) count[bin(e.sample({rng.next(), rng.next()}).wi)] += 1;
    for (int b = 0; b < 16; ++b) {
        CHECK(std::abs(count[b] / n - expected[b]) < 5 * std::sqrt(expected[b] / n) + 1e-3);
    }
}

TEST_CASE("a constant environment is sampled uniformly; a black one is not") {
    const EnvironmentImage e(std::vector<float>{2, 3, 4}, 1, 1, identity);
    CHECK(e.sample({0.2f, 0.7f}).pdf_solid_angle == uniform_sphere_pdf_solid_angle());
    CHECK(e.radiance({0, 1, 0}).b == 4);
    CHECK(e.integral().r == doctest::Approx(8 * pi));
    const EnvironmentImage flat(std::vector<float>(4 * 2 * 3, 1), 4, 2, turned);
    CHECK(flat.pdf_solid_angle({1, 0, 0}) == uniform_sphere_pdf_solid_angle());
    // Black but not constant cannot be: the least positive texel is enough.
    std::vector<float> dim(4 * 2 * 3, 0);
    dim[5] = 1e-38f;
    CHECK(EnvironmentImage(dim, 4, 2, identity).sample({0.5f, 0.5f}).pdf_solid_angle > 0);
}

TEST_CASE("poles and seams are finite") {
    const EnvironmentImage e(night(16, 8), 16, 8, identity);
    for (const Vec3 w : {Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{1e-8f, 1, 0}, Vec3{0, 0, 1}, Vec3{-0.0f, 0, 1}}) {
        CHECK(is_finite(e.radiance(w)));
        CHECK(std::isfinite(e.pdf_solid_angle(w)));
    }
    for (const float a : {0.0f, below_one}) {
        for (const float b : {0.0f, 0.5f, below_one}) CHECK(is_finite(e.sample({a, b}).wi));
    }
}

TEST_CASE("bad images are refused with the place") {
    CHECK_THROWS_WITH_AS(EnvironmentImage(std::vector<float>{1, 1, 1, 1, -1, 1}, 2, 1, identity),
                         "environment: radiance must be finite and not negative, got -1.000000 at row 0, column 1",
                         std::invalid_argument);
    CHECK_THROWS_AS(EnvironmentImage(std::vector<float>{1, 1, NAN}, 1, 1, identity), std::invalid_argument);
    CHECK_THROWS_AS(EnvironmentImage(std::vector<float>{1, 1}, 1, 1, identity), std::invalid_argument);
    CHECK_THROWS_AS(EnvironmentImage({}, 0, 0, identity), std::invalid_argument);
    CHECK_THROWS_WITH_AS(EnvironmentImage(std::vector<float>{1, 1, 1}, 1, 1, {2, 0, 0, 0, 1, 0, 0, 0, 1}),
                         "environment: to_world must be a rotation", std::invalid_argument);
}
