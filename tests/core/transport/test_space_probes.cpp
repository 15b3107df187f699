// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "transport/space_probes.h"

#include <doctest/doctest.h>

#include "harmonics/harmonics.h"
#include "room.h"

namespace eclat {
namespace {

constexpr double y00 = 0.28209479177387814;  // √(1 / 4π)

/// A closed cube of side 2 around the origin, all alike.
std::vector<Wall> cube(float albedo, float emission) {
    const float a = albedo, e = emission;
    return {{{-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, a, e}, {{-1, -1, 1}, {0, 2, 0}, {2, 0, 0}, a, e},
            {{-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, a, e}, {{-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, a, e},
            {{-1, -1, -1}, {0, 2, 0}, {0, 0, 2}, a, e}, {{1, -1, -1}, {0, 0, 2}, {0, 2, 0}, a, e}};
}

ProbeCoefficients probes_in(const Room& room, std::vector<Vec3> at, ProbeOptions options = {}) {
    Progress progress;
    return project_probes(room.world(), at, path_estimator(room.world(), {}), options, progress);
}

Room lamp_room(std::vector<PointLight> points) {
    const std::vector<Wall> walls{{{-1, -5, -1}, {0, 0, 2}, {2, 0, 0}, 0, 0}};
    std::vector<MeshArrays> meshes(1);
    meshes[0].positions = {walls[0].corner, walls[0].corner + walls[0].edge1, walls[0].corner + walls[0].edge2};
    meshes[0].triangles = {{{0, 1, 2}}};
    LightInputs lights;
    lights.points = std::move(points);
    return light_scene(
        std::make_unique<Geometry>(std::move(meshes), own_materials(walls), std::vector<std::unique_ptr<Texture>>{}),
        std::move(lights));
}

TEST_CASE("in a furnace only the mean is left: c_00 = L √4π") {
    // Walls that emit 1 and reflect half show 2 everywhere, half of it straight from lights.
    const Room room = build_room(cube(0.5f, 1));
    for (const auto& [component, radiance] :
         {std::pair{Component::total, 2.0}, {Component::direct, 1.0}, {Component::indirect, 1.0}}) {
        const auto found = probes_in(room, {{0.3f, -0.2f, 0.5f}}, {.component = component, .samples = 4096});
        CHECK(found.values[0].g == doctest::Approx(radiance / y00).epsilon(0.01));
        for (size_t i = 1; i < 9; ++i) CHECK(std::abs(found.values[i].g) < 0.06 * radiance);
        CHECK(found.dropped == 0);
    }
}

TEST_CASE("a point lamp has the harmonics of its direction, without noise") {
    PointLight lamp;
    lamp.position = {1, 2, -2};
    lamp.intensity = Color(9, 18, 4.5f);
    const Room room = lamp_room({lamp});
    const auto found = probes_in(room, {{0, 0, 0}}, {.samples = 16});
    double harmonics[9];
    spherical_harmonics(3, {1 / 3.0, 2 / 3.0, -2 / 3.0}, harmonics);
    for (size_t i = 0; i < 9; ++i) {
        CHECK(found.values[i].r == doctest::Approx(harmonics[i]).epsilon(1e-5).scale(1));
        CHECK(found.values[i].g == doctest::Approx(2 * harmonics[i]).epsilon(1e-5).scale(1));
        CHECK(std::abs(found.errors[i].r) < 1e-6f);
    }
}

TEST_CASE("a lamp of a square centimetre is sampled, not found by luck") {
    // 1 cm² at 2 m, facing the probe: 2.5e-5 sr, which one of 500,000 uniform directions hits.
    const Room room = build_room({{{-0.005f, 2, -0.005f}, {0.01f, 0, 0}, {0, 0, 0.01f}, 0, 1000}});
    const auto found = probes_in(room, {{0, 0, 0}}, {.samples = 64});
    const double expected = 1000 * 1e-4 / 4;
    CHECK(found.values[0].r == doctest::Approx(expected * y00).epsilon(1e-3));
    CHECK(found.values[1].r == doctest::Approx(expected * std::sqrt(3.0) * y00).epsilon(1e-3));  // Y_1,−1 ~ y
    CHECK(std::abs(found.values[3].r) < 1e-5);
}

TEST_CASE("a wall close to the probe has little noise") {
    // A square of side 2 a at the distance h: its solid angle is 4 asin(a² / (a² + h²)), and the irradiance of what faces
    // it four times that of a corner.
    const double a = 1, h = 0.01, s = a / std::sqrt(a * a + h * h);
    const Room room = build_room({{{-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 0, 1}});
    const auto found = probes_in(room, {{0, float(h), 0}}, {.samples = 4096});
    CHECK(found.values[0].r == doctest::Approx(4 * std::asin(a * a / (a * a + h * h)) * y00).epsilon(0.005));
    CHECK(found.values[1].r == doctest::Approx(-4 * s * std::atan(s) * std::sqrt(3.0) * y00).epsilon(0.02));
}

TEST_CASE("the stated errors are those of the mean of the samples") {
    const Room room = build_room({{{-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 0, 1}});
    const std::vector<Vec3> at(200, Vec3(0, 0.7f, 0));
    const auto found = probes_in(room, at, {.samples = 64});
    double mean = 0, square = 0, stated = 0;
    for (size_t p = 0; p < at.size(); ++p) mean += found.values[9 * p].r / double(at.size());
    for (size_t p = 0; p < at.size(); ++p) {
        square += sqr(found.values[9 * p].r - mean) / double(at.size());
        stated += sqr(found.errors[9 * p].r) / double(at.size());
    }
    CHECK(std::sqrt(stated) > 0.5 * std::sqrt(square));
    CHECK(std::sqrt(stated) < 4 * std::sqrt(square));  // halves are less even than the whole sequence
}

TEST_CASE("probes have the same bits on one thread and on two, and stop when asked") {
    const Room room = build_room(cube(0.5f, 1));
    const std::vector<Vec3> at{{0, 0, 0}, {0.5f, 0, 0}, {0, 0.5f, 0}, {0, 0, 0.5f}};
    const auto one = probes_in(room, at, {.samples = 100, .threads = 1});
    const auto two = probes_in(room, at, {.samples = 100, .threads = 2});
    for (size_t i = 0; i < one.values.size(); ++i)
        for (int k = 0; k < 3; ++k) CHECK(one.values[i][k] == two.values[i][k]);
    Progress progress;
    progress.cancelled = true;
    CHECK_THROWS_AS(project_probes(room.world(), at, path_estimator(room.world(), {}), {}, progress), Cancelled);
}

TEST_CASE("radiance that is not finite is dropped and counted") {
    const Room room = build_room(cube(0, 1));
    const Estimator broken = [](std::span<const PathRay>, std::span<PathResult> results, Progress&) {
        results.front().radiance = Color(NAN);
    };
    Progress progress;
    const std::vector<Vec3> at(1);
    const auto found = project_probes(room.world(), at, broken, {.samples = 10}, progress);
    CHECK(found.dropped == 2);  // one in each half
    CHECK(is_finite(found.values[0]));
}

}  // namespace
}  // namespace eclat
