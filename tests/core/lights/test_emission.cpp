// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Photons: what the lights emit, collected in the cells of a plane, is the irradiance that the textbook gives there;
// the sum of what they carry is the power in closed form.

#include <doctest/doctest.h>

#include <array>
#include <functional>
#include <vector>

#include "lights/light.h"
#include "running_mean.h"
#include "sampling/rng.h"

using namespace eclat;

namespace {

constexpr std::array<float, 9> identity = {1, 0, 0, 0, 1, 0, 0, 0, 1};
constexpr float scene_radius = 4;

// The cells lie in the plane z = 0, face +z, and all of them in the scene's sphere around the origin.
constexpr int side = 4;
constexpr double half_width = 2, cell = 2 * half_width / side;

using Irradiance = std::function<double(double x, double y)>;

/// Mean of `f` over cell (i, j), by the midpoint rule.
double cell_mean(const Irradiance& f, int i, int j) {
    constexpr int n = 12;
    double sum = 0;
    for (int a = 0; a < n; ++a)
        for (int b = 0; b < n; ++b)
            sum += f(-half_width + (i + (a + 0.5) / n) * cell, -half_width + (j + (b + 0.5) / n) * cell);
    return sum / (n * n);
}

/// `tolerance`: of the power that the lights say, exact but for textures.
void check_emission(LightInputs inputs, double power, const Irradiance& irradiance, double tolerance = 1e-5) {
    inputs.scene_radius = scene_radius;
    const Lights lights(inputs);
    CHECK(lights.total_power().g == doctest::Approx(power).epsilon(tolerance));

    RunningMean carried;
    std::array<RunningMean, side * side> received;
    Rng rng(21, 1);
    for (int i = 0; i < 200000; ++i) {
        const float u_light = rng.next();
        const Vec2 u_position{rng.next(), rng.next()};
        const PhotonSample p = lights.emit(u_light, u_position, {rng.next(), rng.next()});
        REQUIRE(length(p.direction) == doctest::Approx(1).epsilon(1e-5));
        carried.add(p.power.g);
        const float t = -p.origin.z / p.direction.z;
        const Vec3 at = p.origin + p.direction * t;
        const int x = static_cast<int>(std::floor((at.x + half_width) / cell)),
                  y = static_cast<int>(std::floor((at.y + half_width) / cell));
        const bool lands = t > 0 && p.direction.z < 0 && x >= 0 && x < side && y >= 0 && y < side;
        for (int c = 0; c < side * side; ++c)
            received[c].add(lands && c == y * side + x ? p.power.g / (cell * cell) : 0);
    }
    CHECK(std::abs(carried.mean() - power) <= 5 * carried.standard_error() + 1e-3 * power);
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            CAPTURE(x);
            CAPTURE(y);
            const RunningMean& cell_received = received[y * side + x];
            const double expected = cell_mean(irradiance, x, y);
            CHECK(std::abs(cell_received.mean() - expected) <= 5 * cell_received.standard_error() + 1e-3 * expected);
        }
}

/// Irradiance by a triangle whose point with weights (b, c) of its second and third vertex shines `radiance(b, c)` to
/// the side below it, or to both.
Irradiance under(const EmitterTriangle& t, std::function<double(double, double)> radiance) {
    struct Spot {
        Vec3 at;
        double radiance;
    };
    constexpr int n = 60;
    std::vector<Spot> spots;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n - i; ++j)
            for (const double third : {1.0 / 3, 2.0 / 3}) {
                const double b = (i + third) / n, c = (j + third) / n;
                if (b + c >= 1) continue;
                spots.push_back({t.p0 * float(1 - b - c) + t.p1 * float(b) + t.p2 * float(c), radiance(b, c)});
            }
    const Vec3 normal = cross(t.p1 - t.p0, t.p2 - t.p0);
    const double area = 0.5 * length(normal), part = area / (n * n);
    const Vec3 unit = normalize(normal);
    return [=, two_sided = t.two_sided](double x, double y) {
        double sum = 0;
        for (const Spot& s : spots) {
            const Vec3 d = s.at - Vec3{float(x), float(y), 0};
            const double d2 = dot(d, d), facing = -dot(d, unit);
            if (d.z > 0 && (facing > 0 || two_sided)) sum += s.radiance * part * d.z * std::abs(facing) / (d2 * d2);
        }
        return sum;
    };
}

EmitterTriangle lamp() {
    return {.p0 = {-0.5f, -0.8f, 1.5f},
            .p1 = {0.2f, 0.9f, 2},
            .p2 = {1.4f, -0.3f, 1.2f},
            .emission = Value{.constant = Color(3.0f)}};
}

double area(const EmitterTriangle& t) { return 0.5 * length(cross(t.p1 - t.p0, t.p2 - t.p0)); }

double radians(double degrees) { return degrees * M_PI / 180; }

}  // namespace

TEST_CASE("photons of emissive triangles, one-sided and two-sided") {
    EmitterTriangle t = lamp();
    for (const bool two_sided : {false, true}) {
        CAPTURE(two_sided);
        t.two_sided = two_sided;
        const std::vector<EmitterTriangle> triangles = {t};
        check_emission({.triangles = triangles}, 3 * M_PI * area(t) * (two_sided ? 2 : 1),
                       under(t, [](double, double) { return 3.0; }));
    }
}

TEST_CASE("photons of a textured triangle leave where the texture shines") {
    // Radiance grows along u from 0 to 2 by the filter's ramp between two texels.
    const std::vector<float> image = {0, 2};
    const Texture ramp(ImageView{2, 1, 1, nullptr, image.data()}, {.wrap_u = Wrap::clamp, .wrap_v = Wrap::clamp});
    EmitterTriangle t = lamp();
    t.emission = Value{.constant = Color(1.5f), .texture = &ramp};
    t.uv0 = {0.25f, 0.5f};
    t.uv1 = {0.75f, 0.5f};
    t.uv2 = {0.25f, 0.5f};
    const std::vector<EmitterTriangle> triangles = {t};
    // A linear function's mean over a triangle is that of its corners: (0 + 3 + 0) / 3.
    check_emission({.triangles = triangles}, 1.0 * M_PI * area(t), under(t, [](double b, double) { return 3 * b; }),
                   0.05);
}

/// The irradiance of the plane z = 0 by the intensity of a point light.
auto by_intensity_from(Vec3 at, std::function<double(Vec3)> intensity) {
    return [=](double x, double y) {
        const Vec3 d = Vec3{float(x), float(y), 0} - at;
        const double r = length(d);
        return intensity(d / float(r)) * -d.z / (r * r * r);
    };
}

TEST_CASE("photons of points and spots") {
    const Vec3 at{0.4f, -0.6f, 1.7f};
    const auto by_intensity = [&](std::function<double(Vec3)> intensity) { return by_intensity_from(at, intensity); };
    SUBCASE("point") {
        check_emission({.points = {{at, Color(2, 5, 1)}}}, 20 * M_PI, by_intensity([](Vec3) { return 5.0; }));
    }
    const Vec3 axis = normalize({-0.3f, 0.4f, -1});
    SUBCASE("spot, linear in the angle") {
        const double a = radians(15), b = radians(50);
        // 2π ∫ ramp sin θ dθ = 2π (1 − (sin b − sin a) / (b − a)).
        const double power = 5 * 2 * M_PI * (1 - (std::sin(b) - std::sin(a)) / (b - a));
        check_emission({.spots = {SpotLight(at, axis, Color(5.0f), 15, 50, SpotLight::Falloff::linear)}}, power,
                       by_intensity([=](Vec3 w) {
                           const double angle = std::acos(std::min(1.0f, dot(w, axis)));
                           return 5 * std::min(1.0, std::max(0.0, (b - angle) / (b - a)));
                       }));
    }
    SUBCASE("spot, glTF's") {
        const double a = std::cos(radians(15)), b = std::cos(radians(50));
        // The squared ramp in cosine has the mean 1/3 over its zone.
        check_emission({.spots = {SpotLight(at, axis, Color(5.0f), 15, 50, SpotLight::Falloff::smooth)}},
                       5 * 2 * M_PI * (1 - a + (a - b) / 3), by_intensity([=](Vec3 w) {
                           const double x = std::min(1.0, std::max(0.0, (double(dot(w, axis)) - b) / (a - b)));
                           return 5 * x * x;
                       }));
    }
}

TEST_CASE("photons of a measured luminaire, whose intensity varies in both angles") {
    const Vec3 at{0.4f, -0.6f, 1.7f}, pole = normalize({-0.3f, 0.4f, -1});
    const Frame frame = Frame::around(pole);
    // I = (2 + θ/90) (1 + φ/720) over a full turn, which is linear in both angles, so that coarse nodes hold it exactly; its
    // jump at φ = 0 is part of the test.
    const auto value = [](double polar, double azimuth) { return (2 + polar / 90) * (1 + azimuth / 720); };
    IntensityTable table{{0, 40, 90, 120}, {0, 70, 200, 360}, {}};
    for (const float p : table.polar)
        for (const float a : table.azimuth) table.values.push_back(float(value(p, a)));
    const auto intensity = [=](Vec3 w) {
        const double x = dot(w, frame.u), y = dot(w, frame.v), z = dot(w, pole);
        double polar = std::atan2(std::hypot(x, y), z) * 180 / M_PI, azimuth = std::atan2(y, x) * 180 / M_PI;
        if (azimuth < 0) azimuth += 360;
        return polar <= 120 ? 5 * value(polar, azimuth) : 0.0;
    };
    // ∫ (2 + θ/90°) sin θ dθ to 120° is 2 · 1.5 + (sin b − b cos b) · 2/π, and the mean of the other factor over a turn is 1.25.
    const double b = radians(120);
    const double power = 5 * 2 * M_PI * 1.25 * (3 + (std::sin(b) - b * std::cos(b)) * 2 / M_PI);
    const ProfileLight light(at, {frame.u, frame.v, pole}, Color(5.0f), table);
    check_emission({.profiles = {light}}, power, by_intensity_from(at, intensity));
    // Illuminance is I cos / d² at any point.
    const Vec3 directions[] = {normalize(pole + frame.v * 0.2f), normalize(pole + frame.u * 0.7f + frame.v * 0.1f),
                               normalize(pole * 0.2f - frame.v), frame.u * -1.0f};
    for (const Vec3 w : directions) {
        const LightSample s = Lights({.profiles = {light}}).sample(at + w * 3.0f, 0.5f, {0.5f, 0.5f});
        CHECK(s.radiance.g / s.pdf_solid_angle == doctest::Approx(intensity(w) / 9).epsilon(1e-4));
    }
    CHECK(light.sample(at - pole * 2.0f).pdf_solid_angle == 0);
    CHECK_THROWS_AS(ProfileLight(at, {frame.u, frame.v, pole}, Color(1.0f), {{0, 90}, {0, 0}, {1, 1, 1, 1}}),
                    std::invalid_argument);
    CHECK_THROWS_AS(ProfileLight(at, {frame.u, frame.v, pole}, Color(1.0f), {{0, 90}, {0, 360}, {1, 1, 1}}),
                    std::invalid_argument);
}

TEST_CASE("photons of suns, without extent and with") {
    const Vec3 travels = normalize({0.5f, -0.3f, -1});
    for (const double radius : {0.0, 0.2665, 20.0}) {
        CAPTURE(radius);
        const DirectionalLight sun(travels, Color(7.0f), float(radius));
        // Radiance 7 / (π sin²), over the solid angle 2π (1 − cos), through a disc as large as the scene.
        const double fluxes = radius > 0 ? 2 / (1 + std::cos(radians(radius))) : 1;
        check_emission({.directionals = {sun}}, 7 * fluxes * M_PI * scene_radius * scene_radius,
                       [&](double, double) { return -7 * travels.z; });
    }
}

TEST_CASE("photons of environments: constant, and bright on one side") {
    SUBCASE("constant") {
        const EnvironmentImage sky(std::vector<float>{2, 3, 4}, 1, 1, identity);
        check_emission({.environment = sky}, 3 * 4 * M_PI * M_PI * scene_radius * scene_radius,
                       [](double, double) { return 3 * M_PI; });
    }
    SUBCASE("image") {
        std::vector<float> rgb(32 * 16 * 3);
        Rng rng(22, 1);
        for (size_t i = 0; i < rgb.size(); ++i) rgb[i] = (i / 3 % 32 < 8 ? 10.0f : 0.5f) * rng.next();
        const EnvironmentImage sky(rgb, 32, 16, identity);
        double irradiance = 0, flux = 0;
        constexpr int n = 400;
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < 2 * n; ++j) {
                const double z = -1 + (i + 0.5) * 2 / n, phi = M_PI * (j + 0.5) / n, s = std::sqrt(1 - z * z);
                const double L = sky.radiance({float(s * std::cos(phi)), float(s * std::sin(phi)), float(z)}).g;
                flux += L * 4 * M_PI / (2.0 * n * n);
                irradiance += L * std::max(z, 0.0) * 4 * M_PI / (2.0 * n * n);
            }
        check_emission(
            {.environment = sky}, flux * M_PI * scene_radius * scene_radius, [&](double, double) { return irradiance; },
            2e-3);
    }
}
