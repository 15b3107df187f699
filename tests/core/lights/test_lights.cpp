// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Points, spots and suns by their closed forms; all lights as one set; photons; scale; tens of thousands of emitters.

#include <doctest/doctest.h>

#include <cstring>
#include <initializer_list>
#include <stdexcept>

#include "lights/light.h"
#include "running_mean.h"
#include "sampling/rng.h"

using namespace eclat;

namespace {

constexpr std::array<float, 9> identity = {1, 0, 0, 0, 1, 0, 0, 0, 1};

EnvironmentImage sky() {
    std::vector<float> rgb(16 * 8 * 3);
    Rng rng(1, 5);
    for (float& x : rgb) x = rng.next() * 3;
    return EnvironmentImage(rgb, 16, 8, identity);
}

std::vector<EmitterTriangle> lamp(float scale = 1) {
    // A square of 1 × 1 that faces down, and a brighter triangle that shines to both sides.
    const auto at = [&](float x, float y, float z) { return Vec3{x, y, z} * scale; };
    const Value dim{.constant = Color(2, 3, 4)}, bright{.constant = Color(10.0f)};
    return {{.p0 = at(0, 0, 3), .p1 = at(0, 1, 3), .p2 = at(1, 1, 3), .emission = dim, .triangle_id = 17},
            {.p0 = at(0, 0, 3), .p1 = at(1, 1, 3), .p2 = at(1, 0, 3), .emission = dim, .triangle_id = 18},
            {.p0 = at(2, 0, 1), .p1 = at(2, 0.1f, 1), .p2 = at(2, 0, 1.2f), .emission = bright, .two_sided = true}};
}

/// One light of each kind in a scene of radius 4; lengths times `scale`.
LightInputs everything(const std::vector<EmitterTriangle>& triangles, float scale = 1) {
    const Color strength = Color(5, 4, 3) * (scale * scale);
    return {
        .triangles = triangles,
        .points = {{Vec3{0.5f, -1, 2} * scale, strength}},
        .spots = {SpotLight(Vec3{-1, 1, 2} * scale, {0.2f, 0, -1}, strength, 20, 35, SpotLight::Falloff::smooth)},
        .profiles = {ProfileLight(Vec3{1, 0.5f, 2.5f} * scale, {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, -1}}, strength,
                                  {{0, 60, 180}, {0, 90, 360}, {1, 1, 1, 0.5f, 0.8f, 0.5f, 0.1f, 0.1f, 0.1f}})},
        .directionals = {DirectionalLight({0, 0.2f, -1}, Color(1.5f), 0),
                         DirectionalLight({0.5f, 0, -1}, Color(2.5f), 3)},
        .environment = sky(),
        .scene_center = Vec3{0.5f, 0.5f, 1} * scale,
        .scene_radius = 4 * scale};
}

double degrees(double x) { return x * M_PI / 180; }

/// Irradiance at `at` by light sampling: the green channel.
RunningMean irradiance(const Lights& lights, Vec3 at, Vec3 normal, int samples, LightSet set = LightSet::all) {
    RunningMean mean;
    Rng rng(11, 3);
    for (int i = 0; i < samples; ++i) {
        const float u_light = rng.next();
        const LightSample s = lights.sample(at, u_light, {rng.next(), rng.next()}, set);
        const float cosine = std::max(0.0f, dot(s.wi, normal));
        mean.add(s.pdf_solid_angle > 0 ? s.radiance.g * cosine / s.pdf_solid_angle : 0);
    }
    return mean;
}

bool same_bits(float a, float b) { return std::memcmp(&a, &b, sizeof a) == 0; }
bool same_bits(Vec3 a, Vec3 b) { return same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.z, b.z); }

}  // namespace

TEST_CASE("a point light falls off with the square of the distance") {
    const Lights lights({.points = {{{1, 2, 3}, Color(8, 4, 2)}}});
    const LightSample s = lights.sample({1, 2, 1}, 0.4f, {0.1f, 0.2f});
    CHECK(s.delta);
    CHECK(s.wi.z == 1);
    CHECK(s.distance == 2);
    CHECK(s.radiance.r / s.pdf_solid_angle == 2);
    CHECK(lights.total_power().g == doctest::Approx(16 * pi));
    CHECK(lights.sample({1, 2, 3}, 0.4f, {0.1f, 0.2f}).pdf_solid_angle == 0);
}

TEST_CASE("spots: full inside, nothing outside, the named ramps between, and their flux by quadrature") {
    using Falloff = SpotLight::Falloff;
    for (const Falloff falloff : {Falloff::linear, Falloff::smooth}) {
        for (const auto& [inner, outer] :
             {std::pair{20.0f, 40.0f}, {0.0f, 90.0f}, {0.2f, 0.3f}, {10.0f, 10.0f}, {60.0f, 180.0f}}) {
            CAPTURE(outer);
            const SpotLight spot({0, 0, 5}, {0, 0, -2}, Color(3.0f), inner, outer, falloff);
            const auto truth = [&](double angle) {
                if (angle <= inner) return 1.0;
                if (angle >= outer) return 0.0;
                if (falloff == Falloff::linear) return (outer - angle) / (outer - inner);
                const double end = std::cos(degrees(outer));
                return std::pow((std::cos(degrees(angle)) - end) / (std::cos(degrees(inner)) - end), 2);
            };
            double flux = 0;
            const int steps = 2000;
            for (int i = 0; i < steps; ++i) {
                const double angle = outer * (i + 0.5) / steps * 1.02, rad = degrees(angle);
                if (angle < 180) flux += truth(angle) * 2 * M_PI * std::sin(rad) * degrees(outer) / steps * 1.02;
                if (i % 50 != 0 || angle > 179 || std::abs(angle - inner) < 1e-3 * outer) continue;
                const LightSample s = spot.sample({float(2 * std::sin(rad)), 0, float(5 - 2 * std::cos(rad))});
                CHECK(s.radiance.g == doctest::Approx(0.75 * truth(angle)).epsilon(2e-3));
            }
            CHECK(spot.power().r == doctest::Approx(3 * flux).epsilon(2e-3));
        }
    }
}

TEST_CASE("a directional light arrives from where it comes; a sun's disc gives its irradiance") {
    const Lights parallel({.directionals = {DirectionalLight({0, -3, 0}, Color(7.0f), 0)}});
    const LightSample s = parallel.sample({}, 0, {});
    CHECK(s.wi.y == 1);
    CHECK(s.delta);
    CHECK(std::isinf(s.distance));
    CHECK(s.radiance.b / s.pdf_solid_angle == 7);
    CHECK(is_black(parallel.environment({0, 1, 0})));
    CHECK(parallel.environment_pdf_solid_angle({0, 1, 0}) == 0);

    for (const float radius : {0.2665f, 5.0f, 60.0f}) {
        CAPTURE(radius);
        const Lights sun({.directionals = {DirectionalLight({1, -1, 0}, Color(7.0f), radius)}});
        const Vec3 towards = normalize({-1, 1, 0});
        CHECK(irradiance(sun, {}, towards, 20000).agrees(7));
        const auto tilted = [&](double angle) {
            const Frame f = Frame::around(towards);
            return f.to_world({float(std::sin(degrees(angle))), 0, float(std::cos(degrees(angle)))});
        };
        const double cap = 2 * M_PI * (1 - std::cos(degrees(radius)));
        CHECK(sun.environment(tilted(0.999 * radius)).g ==
              doctest::Approx(7 / (M_PI * std::pow(std::sin(degrees(radius)), 2))).epsilon(1e-5));
        CHECK(sun.environment_pdf_solid_angle(tilted(0.999 * radius)) == doctest::Approx(1 / cap).epsilon(1e-4));
        CHECK(is_black(sun.environment(tilted(1.001 * radius))));
    }
}

TEST_CASE("all lights together give the sum of their irradiances") {
    const std::vector<EmitterTriangle> triangles = lamp();
    const Vec3 at{0.2f, 0.1f, 0}, normal = normalize({0.1f, 0.2f, 1});
    const LightInputs all = everything(triangles);
    const int samples = 300000;
    const Lights only[] = {Lights({.triangles = triangles}),
                           Lights({.points = all.points}),
                           Lights({.spots = all.spots}),
                           Lights({.profiles = all.profiles}),
                           Lights({.directionals = all.directionals}),
                           Lights({.environment = all.environment})};
    double sum = 0, error = 0, without = 0;
    for (int i = 0; i < 6; ++i) {
        const RunningMean mean = irradiance(only[i], at, normal, samples);
        CHECK(mean.mean() > 0);
        sum += mean.mean();
        error += mean.standard_error() * mean.standard_error();
        if (i < 5) without = sum;
    }
    const Lights lights(all);
    const RunningMean together = irradiance(lights, at, normal, samples);
    error = std::sqrt(error + together.standard_error() * together.standard_error());
    CHECK(std::abs(together.mean() - sum) < 5 * error);
    const RunningMean sampled = irradiance(lights, at, normal, samples, LightSet::without_smooth_environment);
    CHECK(std::abs(sampled.mean() - without) < 5 * error);
}

TEST_CASE("densities are those of sampling for each kind and set, with the choice of the light") {
    const std::vector<EmitterTriangle> triangles = lamp();
    const Lights lights(everything(triangles));
    const Vec3 at{0.2f, 0.1f, 0};
    for (const LightSet set : {LightSet::all, LightSet::without_smooth_environment}) {
        Rng rng(12, 1);
        double of_deltas = 0, counted = 0;
        int sky_samples = 0;
        for (int i = 0; i < 20000; ++i) {
            const float u_light = rng.next();
            const LightSample s = lights.sample(at, u_light, {rng.next(), rng.next()}, set);
            if (s.pdf_solid_angle == 0) continue;
            if (s.delta) {
                of_deltas += 1 / s.pdf_solid_angle;
            } else if (std::isinf(s.distance)) {
                const Lights::Infinite seen = lights.infinite(s.wi, set);
                CHECK(seen.pdf_solid_angle == doctest::Approx(s.pdf_solid_angle).epsilon(1e-3));
                CHECK(seen.radiance.g == doctest::Approx(s.radiance.g).epsilon(1e-3));
                ++sky_samples;
            } else {
                const uint32_t emitter = s.triangle == 17 ? 0 : s.triangle == 18 ? 1 : 2;
                CHECK(lights.pdf_solid_angle(emitter, at, at + s.wi * s.distance, set) ==
                      doctest::Approx(s.pdf_solid_angle).epsilon(1e-3));
                CHECK_FALSE(lights.emitted(emitter, {0.3f, 0.3f}, -s.wi).g != s.radiance.g);
            }
            ++counted;
        }
        CHECK(sky_samples > 1000);
        // Point, spot (which does shine here), profile and parallel light: four deltas, each counted once in the mean.
        CHECK(of_deltas / 20000 == doctest::Approx(4).epsilon(0.08));
    }
    // The image is left out, the sun's disc stays.
    const Vec3 sun = normalize({-0.5f, 0, 1}), elsewhere{0, 1, 0};
    CHECK(is_black(lights.environment(elsewhere, LightSet::without_smooth_environment)));
    CHECK(lights.environment_pdf_solid_angle(elsewhere, LightSet::without_smooth_environment) == 0);
    CHECK(lights.environment(sun, LightSet::without_smooth_environment).g > 100);
    CHECK(lights.environment(sun).g > lights.environment(sun, LightSet::without_smooth_environment).g);
}

TEST_CASE("samples that are taken together have the bits of samples that are taken one by one") {
    const auto triangles = lamp();
    for (const Lights& lights : {Lights(everything(triangles)), Lights({.triangles = triangles}), Lights()})
        for (const LightSet set : {LightSet::all, LightSet::without_smooth_environment}) {
            std::vector<LightQuery> queries;
            Rng rng(23, 4);
            for (int i = 0; i < 1001; ++i)  // no multiple of the number that is processed at once
                queries.push_back({{rng.next(), rng.next(), rng.next()}, rng.next(), {rng.next(), rng.next()}});
            std::vector<LightSample> samples(queries.size());
            lights.sample(queries, set, samples);
            for (size_t i = 0; i < queries.size(); ++i) {
                const LightSample one = lights.sample(queries[i].position, queries[i].u_light, queries[i].u, set);
                REQUIRE(same_bits(samples[i].wi, one.wi));
                REQUIRE(same_bits(samples[i].pdf_solid_angle, one.pdf_solid_angle));
                REQUIRE(same_bits(samples[i].radiance.g, one.radiance.g));
            }
        }
}

TEST_CASE("no light at all, and lights that are black") {
    const std::vector<EmitterTriangle> black = {
        {.p0 = {0, 0, 0}, .p1 = {1, 0, 0}, .p2 = {0, 1, 0}, .emission = Value{.constant = Color(0.0f)}}};
    for (const Lights& lights : {Lights(), Lights({.triangles = black, .points = {{{0, 0, 1}, Color(0.0f)}}})}) {
        CHECK(lights.dark());
        CHECK(lights.sample({1, 2, 3}, 0.5f, {0.5f, 0.5f}).pdf_solid_angle == 0);
        CHECK(is_black(lights.emit(0.5f, {0.5f, 0.5f}, {0.5f, 0.5f}).power));
        CHECK(is_black(lights.environment({0, 0, 1})));
    }
    CHECK(Lights({.triangles = black}).pdf_solid_angle(0, {0, 0, 1}, {0.2f, 0.2f, 0}) == 0);
}

TEST_CASE("invalid lights are refused") {
    using Falloff = SpotLight::Falloff;
    CHECK_THROWS_WITH_AS(SpotLight({}, {0, 0, 1}, Color(1.0f), 30, 20, Falloff::smooth),
                         "spot light: expected 0 <= inner angle <= outer angle <= 180 degrees, got 30.000000 and "
                         "20.000000",
                         std::invalid_argument);
    CHECK_THROWS_AS(SpotLight({}, {0, 0, 0}, Color(1.0f), 10, 20, Falloff::smooth), std::invalid_argument);
    CHECK_THROWS_AS(DirectionalLight({0, 0, 0}, Color(1.0f), 0), std::invalid_argument);
    CHECK_THROWS_AS(DirectionalLight({0, 0, 1}, Color(1.0f), 90), std::invalid_argument);
    CHECK_THROWS_WITH_AS(Lights({.points = {{{}, Color(1.0f)}, {{}, Color(-1, 0, 0)}}}),
                         "lights: point light 1: power must be finite and not negative, got -12.566371, 0.000000, "
                         "0.000000",
                         std::invalid_argument);
    std::vector<EmitterTriangle> triangles = lamp();
    triangles[1].emission.constant = Color(NAN);
    CHECK_THROWS_AS(Lights({.triangles = triangles}), std::invalid_argument);
}

TEST_CASE("photons carry the total power, and each light's irradiance to a disc around the centre") {
    const std::vector<EmitterTriangle> triangles = lamp();
    const LightInputs all = everything(triangles);
    const auto probe = [&](LightInputs inputs) {
        inputs.scene_center = all.scene_center;
        inputs.scene_radius = all.scene_radius;
        const Lights lights(inputs);
        // A disc below the lamps, facing up, small beside the distances, so that its irradiance is that of its centre.
        const Vec3 at{0.3f, 0.3f, 0};
        const float radius = 0.15f;
        RunningMean flux, received;
        Rng rng(13, 1);
        for (int i = 0; i < 400000; ++i) {
            const float u_light = rng.next();
            const Vec2 u_position{rng.next(), rng.next()};
            const PhotonSample p = lights.emit(u_light, u_position, {rng.next(), rng.next()});
            flux.add(p.power.g);
            const float t = (at.z - p.origin.z) / p.direction.z;
            const bool hits = t > 0 && p.direction.z < 0 && length(p.origin + p.direction * t - at) < radius;
            received.add(hits ? p.power.g / (pi * radius * radius) : 0);
        }
        CHECK(flux.agrees(lights.total_power().g));
        const RunningMean expected = irradiance(lights, at, {0, 0, 1}, 400000);
        // One per cent for the disc's extent.
        const double error = 5 * std::hypot(received.standard_error(), expected.standard_error());
        CHECK(std::abs(received.mean() - expected.mean()) < error + 0.01 * expected.mean());
        CHECK(received.mean() > 0);
        return flux;
    };
    SUBCASE("triangles") { probe({.triangles = triangles}); }
    SUBCASE("points") { probe({.points = all.points}); }
    SUBCASE("spots") {
        probe({.spots = {SpotLight({0, 0, 3}, {0, 0, -1}, Color(3.0f), 5, 50, SpotLight::Falloff::linear)}});
    }
    SUBCASE("suns") { probe({.directionals = all.directionals}); }
    SUBCASE("sky") { probe({.environment = all.environment}); }
    SUBCASE("all, and all photons nearly alike") {
        const RunningMean flux = probe(all);
        CHECK(flux.standard_error() * std::sqrt(400000.0) < 0.7 * flux.mean());  // 0.5 by power alone
    }
}

TEST_CASE("photons of infinite lights start outside of the scene's sphere and can reach all of it") {
    const LightInputs all = everything({});
    const Lights lights({.directionals = all.directionals,
                         .environment = all.environment,
                         .scene_center = all.scene_center,
                         .scene_radius = all.scene_radius});
    Rng rng(14, 1);
    for (int i = 0; i < 1000; ++i) {
        const float u_light = rng.next();
        const Vec2 u_position{rng.next(), rng.next()};
        const PhotonSample p = lights.emit(u_light, u_position, {rng.next(), rng.next()});
        const Vec3 to = all.scene_center - p.origin;
        CHECK(length(to) > 4);
        CHECK(length(cross(to, p.direction)) <= 4 * 1.0001f);
        CHECK(dot(to, p.direction) > 0);
    }
}

TEST_CASE("a scene of 2^k times the size has the same bits, up to the scale") {
    const std::vector<EmitterTriangle> triangles = lamp();
    const Lights lights(everything(triangles));
    for (const float scale : {0x1p-20f, 0x1p-10f, 0x1p10f, 0x1p20f}) {
        CAPTURE(scale);
        const std::vector<EmitterTriangle> other_triangles = lamp(scale);
        const Lights scaled(everything(other_triangles, scale));
        Rng rng(15, 1);
        for (int i = 0; i < 3000; ++i) {
            const Vec3 at{rng.next(), rng.next(), 2.9f * rng.next()};
            const float u_light = rng.next();
            const Vec2 u{rng.next(), rng.next()}, v{rng.next(), rng.next()};
            const LightSample a = lights.sample(at, u_light, u), b = scaled.sample(at * scale, u_light, u);
            CHECK_FALSE(!same_bits(a.wi, b.wi));
            CHECK_FALSE(!same_bits(a.distance * scale, b.distance));
            CHECK_FALSE(!same_bits(a.radiance.g, b.radiance.g));
            CHECK_FALSE(!same_bits(a.pdf_solid_angle, b.pdf_solid_angle));
            const PhotonSample p = lights.emit(u_light, u, v), q = scaled.emit(u_light, u, v);
            CHECK_FALSE(!same_bits(p.origin * scale, q.origin));
            CHECK_FALSE(!same_bits(p.direction, q.direction));
            CHECK_FALSE(!same_bits(p.power.r * scale * scale, q.power.r));
        }
    }
}

TEST_CASE("fifty thousand emitters: the mean is their sum, each can be picked") {
    // A field of small triangles at z = 2 of very different radiance, a few of them textured black or bright.
    std::vector<EmitterTriangle> triangles;
    Rng rng(16, 1);
    const std::vector<uint8_t> image = {0, 0, 0, 255};
    const Texture texture(ImageView{4, 1, 1, image.data(), nullptr}, {.nearest = true});
    double expected = 0;
    const Vec3 at{0.1f, 0.2f, 0};
    for (int i = 0; i < 50000; ++i) {
        const Vec3 p{8 * rng.next() - 4, 8 * rng.next() - 4, 2};
        const float size = 0.004f, radiance = std::pow(rng.next(), 8.0f) * 100;
        EmitterTriangle t{.p0 = p,
                          .p1 = p + Vec3{0, size, 0},
                          .p2 = p + Vec3{size, 0, 0},
                          .emission = Value{.constant = Color(radiance)}};
        float shown = radiance;
        if (i % 10 == 0) {
            t.emission = Value{.constant = Color(10.0f), .texture = &texture};
            const float u = i % 20 == 0 ? 0.1f : 0.8f;
            t.uv0 = t.uv1 = t.uv2 = {u, 0.5f};
            shown = i % 20 == 0 ? 0 : 10;
        }
        const Vec3 d = p + Vec3{size / 3, size / 3, 0} - at;
        expected += double(shown) * size * size / 2 * d.z * d.z / sqr(dot(d, d));
        triangles.push_back(t);
    }
    const Lights lights({.triangles = triangles});
    CHECK(irradiance(lights, at, {0, 0, 1}, 300000).agrees(expected));
    for (uint32_t i = 0; i < triangles.size(); i += 7) {
        const bool shines = !is_black(lights.emitted(i, {0.3f, 0.3f}, {0, 0, -1}));
        const float pdf = lights.pdf_solid_angle(i, at, triangles[i].p0);
        if (shines) CHECK_FALSE(!(pdf > 0));
    }
}
