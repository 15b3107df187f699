// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Irradiance from photons against closed forms: even light on a plane, at a wall, in a corner, at a free edge, beside a
// thin wall; light that falls off; a sphere.

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "methods/photon_map/density.h"
#include "methods/photon_map/photon_maps.h"
#include "methods/photon_map/trace_photons.h"
#include "room.h"
#include "running_mean.h"
#include "sampling/rng.h"

using namespace eclat;

namespace {

constexpr float E = 5;

/// Photons of even irradiance E on the rectangle from `corner`, one in each cell of a grid of `cell` a side.
void add_even(std::vector<Photon>& photons, Vec3 corner, Vec3 edge1, Vec3 edge2, float cell) {
    const Vec3 n = normalize(cross(edge1, edge2));
    const int columns = int(length(edge1) / cell + 0.5f), rows = int(length(edge2) / cell + 0.5f);
    const float power = E * length(edge1) * length(edge2) / float(columns * rows);
    Rng rng(5, uint32_t(photons.size()));
    for (int i = 0; i < columns; ++i)
        for (int j = 0; j < rows; ++j) {
            const float u = (float(i) + rng.next()) / float(columns), v = (float(j) + rng.next()) / float(rows);
            photons.push_back({corner + edge1 * u + edge2 * v, Color(power), n, n, 1});
        }
}

Room room() { return closed_room({0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f}, {0, 0, 0, 0, 0, 0}); }

/// Floor and two walls of that room in even light.
PhotonMap even_corner() {
    std::vector<Photon> photons;
    add_even(photons, {-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, 0.008f);
    add_even(photons, {-1, -1, -1}, {0, 2, 0}, {0, 0, 2}, 0.008f);
    add_even(photons, {-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, 0.008f);
    return PhotonMap(std::move(photons), 1, 0);
}

struct Error {
    double mean = 0, largest = 0;
};

/// Relative to `truth`, over points.
Error error(const World& world, const PhotonMap& map, const std::vector<Vec3>& points, Vec3 n,
            const DensityOptions& options, const std::function<double(Vec3)>& truth) {
    Error out;
    Progress progress;
    for (const Vec3& p : points) {
        const auto e = estimate_irradiance(world, map, DensityPoint(p, n, 1e-5f), options, progress);
        const double relative = e.irradiance.g / truth(p) - 1;
        out.mean += relative / double(points.size());
        out.largest = std::max(out.largest, std::fabs(relative));
    }
    return out;
}

double even(Vec3) { return E; }

constexpr Vec3 up{0, 1, 0};

}  // namespace

TEST_CASE("each kernel reconstructs uniform light on a plane, at a wall and in a corner") {
    const Room box = room();
    const PhotonMap map = even_corner();
    std::vector<Vec3> open, wall, corner;
    for (int i = 0; i < 30; ++i) {
        const float t = -0.6f + 0.04f * float(i), d = 0.002f + 0.006f * float(i % 10);
        open.push_back({t, -1, 0.3f * t});
        wall.push_back({-1 + d, -1, t});
        corner.push_back({-1 + d, -1, -1 + 0.003f * float(i / 10) + 0.7f * d});
    }
    for (const Kernel kernel : {Kernel::uniform, Kernel::cone, Kernel::epanechnikov}) {
        DensityOptions options;
        options.nearest = 300;  // a radius of 0.08
        options.kernel = kernel;
        CAPTURE(int(kernel));
        CHECK(std::fabs(error(box.world(), map, open, up, options, even).mean) < 0.01);
        CHECK(error(box.world(), map, open, up, options, even).largest < 0.06);
        CHECK(std::fabs(error(box.world(), map, wall, up, options, even).mean) < 0.015);
        CHECK(error(box.world(), map, wall, up, options, even).largest < 0.09);
        CHECK(std::fabs(error(box.world(), map, corner, up, options, even).mean) < 0.02);
        CHECK(error(box.world(), map, corner, up, options, even).largest < 0.12);
        // What it is for: without it a wall takes up to half of the light away, a corner three quarters.
        options.boundary = false;
        CHECK(error(box.world(), map, open, up, options, even).largest < 0.06);
        CHECK(error(box.world(), map, wall, up, options, even).mean < -0.15);
        CHECK(error(box.world(), map, corner, up, options, even).mean < -0.3);
    }
}

TEST_CASE("at a free edge the disc ends where the surface does") {
    const Room table = build_room({{{-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 0.5f, 0}});
    std::vector<Photon> photons;
    add_even(photons, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 0.008f);
    const PhotonMap map(std::move(photons), 1, 0);
    DensityOptions options;
    options.nearest = 300;
    std::vector<Vec3> edge, corner;
    for (int i = 0; i < 20; ++i) {
        edge.push_back({-0.5f + 0.05f * float(i), 0, 1 - 0.003f * float(i)});
        corner.push_back({1 - 0.002f * float(i), 0, 1 - 0.003f * float(i)});
    }
    CHECK(std::fabs(error(table.world(), map, edge, up, options, even).mean) < 0.015);
    CHECK(std::fabs(error(table.world(), map, corner, up, options, even).mean) < 0.02);
}

TEST_CASE("a wall of one millimetre separates light and darkness on one floor") {
    // Both floors are one plane; the wall's two faces stand between them.
    const Room rooms = build_room({{{-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 0.5f, 0},
                                   {{0, 0, -1}, {0, 0, 2}, {0, 1, 0}, 0.5f, 0},
                                   {{0.001f, 0, -1}, {0, 1, 0}, {0, 0, 2}, 0.5f, 0}});
    std::vector<Photon> photons;
    add_even(photons, {-1, 0, -1}, {0, 0, 2}, {1, 0, 0}, 0.008f);
    const PhotonMap map(std::move(photons), 1, 0);
    DensityOptions options;
    options.nearest = 300;
    Progress progress;
    for (const float d : {0.0005f, 0.004f, 0.03f, 0.1f}) {
        for (int i = 0; i < 20; ++i) {
            const DensityPoint dark({0.001f + d, 0, -0.5f + 0.05f * float(i)}, up, 1e-6f);
            CHECK(estimate_irradiance(rooms.world(), map, dark, options, progress).irradiance.g == 0);
        }
        std::vector<Vec3> lit;
        for (int i = 0; i < 20; ++i) lit.push_back({-d, 0, -0.5f + 0.05f * float(i)});
        CHECK(std::fabs(error(rooms.world(), map, lit, up, options, even).mean) < 0.02);
    }
}

TEST_CASE("what stands over a floor, or lies beside it without photons, does not change its light") {
    const float height = 0.01f;  // less than the disc reaches up
    const Wall floor{{-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 0.5f, 0},
        table{{-1, height, -1}, {0, 0, 2}, {1, 0, 0}, 0.5f, 0};
    Material mirror = diffuse(1, 0);
    mirror.kind = MaterialKind::conductor;
    mirror.parameters.assign(parameter_names(mirror.kind).size(), mirror.parameters[0]);
    std::vector<Vec3> points;
    for (int i = 0; i < 40; ++i) points.push_back({-0.5f + 0.025f * float(i), 0, 0.1f});
    std::vector<Photon> photons;
    add_even(photons, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 0.008f);
    const PhotonMap map(photons, 1, 0);
    DensityOptions options;
    options.nearest = 300;  // a radius of 0.08
    for (const Material& material : {diffuse(0.5f, 0), mirror}) {
        const Room rooms = build_room({floor, table}, {diffuse(0.5f, 0), material});
        CHECK(std::fabs(error(rooms.world(), map, points, up, options, even).mean) < 0.015);
    }
    // A floor that ends at a mirror.
    const Wall white{{-1, 0, -1}, {0, 0, 2}, {1, 0, 0}, 0.5f, 0}, beside{{0, 0, -1}, {0, 0, 2}, {1, 0, 0}, 0.5f, 0};
    const Room rooms = build_room({white, beside}, {diffuse(0.5f, 0), mirror});
    photons.clear();
    add_even(photons, {-1, 0, -1}, {0, 0, 2}, {1, 0, 0}, 0.008f);
    const PhotonMap half(photons, 1, 0);
    for (Vec3& p : points) p.x = -0.001f * float(&p - points.data()) - 0.001f;
    CHECK(std::fabs(error(rooms.world(), half, points, up, options, even).mean) < 0.02);
}

TEST_CASE("under a point light irradiance is I cos³ / h² on a wide plane") {
    Room floor = build_room({{{-8, 0, -8}, {0, 0, 16}, {16, 0, 0}, 0.5f, 0}});
    const double height = 1, intensity = 3;
    LightInputs inputs;
    inputs.points = {{{0, float(height), 0}, Color(float(intensity))}};
    inputs.scene_radius = floor.geometry->radius();
    floor.lights = Lights(std::move(inputs));
    Progress progress;
    const uint64_t paths = 400000;
    const PhotonMap map(trace_photons(floor.world(), {0, paths}, {.stored = {.direct = true}}, progress), paths, 0);
    const auto truth = [&](Vec3 p) {
        const double d2 = double(p.x) * p.x + double(p.z) * p.z + height * height;
        return intensity * height / (d2 * std::sqrt(d2));
    };
    std::vector<Vec3> points;
    Rng rng(2, 2);
    for (int i = 0; i < 100; ++i) points.push_back({2 * rng.next() - 1, 0, 2 * rng.next() - 1});
    for (const Kernel kernel : {Kernel::uniform, Kernel::cone, Kernel::epanechnikov}) {
        DensityOptions options;
        options.nearest = 200;
        options.kernel = kernel;
        const Error e = error(floor.world(), map, points, up, options, truth);
        CHECK(std::fabs(e.mean) < 0.01);
        CHECK(e.largest < 0.25);  // 200 photons: 7 %, less by Sobol's points, more by the kernel's weights
    }
    // A bounded radius: fewer photons than wanted lie in it, which must not show in the mean.
    DensityOptions bounded;
    bounded.nearest = 100000;
    bounded.radius = 0.05f;
    CHECK(std::fabs(error(floor.world(), map, points, up, bounded, truth).mean) < 0.02);
}

TEST_CASE("precomputed irradiance that is read at the nearest point has the right mean, even with few photons") {
    const Room floor = build_room({{{-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 0.5f, 0}});
    Rng rng(6, 6);
    const auto scattered_photons = [&](int count) {
        std::vector<Photon> photons;
        for (int i = 0; i < count; ++i)
            photons.push_back({{2 * rng.next() - 1, 0, 2 * rng.next() - 1}, Color(E * 4 / float(count)), up, up, 2});
        return photons;
    };
    PhotonMaps maps;
    maps.global = PhotonMap(scattered_photons(60000), 1, 0);
    maps.reading.global.nearest = 10;
    maps.reading.global.radius = 1;
    Progress progress;
    maps.precompute(floor.world(), scattered_photons(15000), 0, progress);
    REQUIRE(maps.irradiance.records().size() == 15000);
    RunningMean mean;
    for (int i = 0; i < 20000; ++i) {
        const DensityPoint at({2 * rng.next() - 1, 0, 2 * rng.next() - 1}, up, 1e-5f);
        const auto E_far = far_irradiance(floor.world(), maps, at, 1, -1, progress);
        REQUIRE(E_far.has_value());
        mean.add(E_far->g);
    }
    // Neighbouring places share photons: about 6000 estimates of ten photons each are independent.
    CHECK(mean.mean() == doctest::Approx(E).epsilon(5 * 1.2 / std::sqrt(10 * 6000)));
    CHECK(!far_irradiance(floor.world(), maps, {{0, 0, 0}, up, 1e-5f}, 1e-3f, -1, progress).has_value());  // too near
}

TEST_CASE("radii of progressive passes decrease so that variance and bias vanish [KnausZwicker11]") {
    CHECK(progressive_radius(0, 0.7f) == 1);
    CHECK(progressive_radius(1, 0.7f) == doctest::Approx(std::sqrt(1.7 / 2)));
    // r² goes with i^(α − 1).
    const double ratio = progressive_radius(2000, 0.7f) / progressive_radius(1000, 0.7f);
    CHECK(ratio * ratio == doctest::Approx(std::pow(2, -0.3)).epsilon(1e-3));
}

TEST_CASE("a progressive estimate takes all photons in a part of the first pass's disc") {
    const Room box = room();
    const PhotonMap map = even_corner();
    std::vector<Photon> few;
    add_even(few, {-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, 0.04f);
    const PhotonMap first(few, 1, 0);
    DensityOptions options;
    options.nearest = 30;  // of the first map: a radius of 0.12
    options.first_map = &first;
    options.part_of_radius = 0.5f;
    Progress progress;
    const auto e = estimate_irradiance(box.world(), map, {{0.1f, -1, 0.2f}, up, 1e-5f}, options, progress);
    CHECK(e.radius == doctest::Approx(0.06).epsilon(0.15));
    CHECK(e.irradiance.g == doctest::Approx(E).epsilon(0.05));
}
