// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "transport/path_guide.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "room.h"
#include "sampling/mis.h"

using namespace eclat;

namespace {

/// A room with a floor of the given material, which is lit by way of its ceiling: a small lamp shines at that from close by.
Room indirectly_lit_room(const Material& floor) {
    auto walls = closed_walls({0.7f, 0.8f, 0.3f, 0.3f, 0.3f, 0.3f}, {});
    walls.push_back({{0.5f, 0.9f, 0.5f}, {0, 0, 0.1f}, {0.1f, 0, 0}, 0, 400});
    // It is seen from above only.
    std::vector<Material> materials = own_materials(walls, false);
    materials[0] = floor;
    return build_room(walls, materials);
}

std::vector<PointNormal> places_on_floor() {
    std::vector<PointNormal> places;
    for (int z = 0; z < 8; ++z)
        for (int x = 0; x < 8; ++x)
            places.push_back({{-0.875f + 0.25f * float(x), -1, -0.875f + 0.25f * float(z)}, {0, 1, 0}});
    return places;
}

PathGuide guide_of(const Room& room, std::span<const PointNormal> places, int threads = 0) {
    Progress progress;
    return {room.world(), places, PathOptions{}, threads, progress};
}

struct Traced {
    double mean = 0, variance = 0;
    double error = 0;  // standard error of the mean

    double difference_in_errors(const Traced& o) const { return std::fabs(mean - o.mean) / std::hypot(error, o.error); }
};

/// The radiance of the floor.
Traced traced(const Room& room, const PathOptions& options) {
    constexpr uint32_t count = 200000;
    std::vector<PathRay> rays;
    for (uint32_t i = 0; i < count; ++i)
        rays.push_back({{{0.3f, -0.2f, 0.1f}, 0, normalize(Vec3{-0.3f, -0.8f, -0.1f})}, Sampler(5, i, 0)});
    std::vector<PathResult> results(count);
    Progress progress;
    trace_paths(room.world(), rays, options, results, progress);
    double sum = 0, squares = 0;
    for (const PathResult& r : results) {
        const double x = r.radiance.g;
        sum += x;
        squares += x * x;
    }
    const double mean = sum / count, variance = squares / count - mean * mean;
    return {mean, variance, std::sqrt(variance / count)};
}

PathOptions gathering(const PathGuide* guide) {
    PathOptions options;
    // No cache answers, so that paths go on everywhere.
    options.cache = [](const SurfacePoint&, float) { return std::optional<Color>(); };
    options.gather_first = true;
    if (guide != nullptr) options.aim = [guide](std::span<SurfacePoint* const> points) { guide->aim(points); };
    return options;
}

}  // namespace

TEST_CASE("guided paths find the same light as others, with less noise") {
    const Room room = indirectly_lit_room(diffuse(0.7f, 0));
    const auto places = places_on_floor();
    const PathGuide guide = guide_of(room, places);
    REQUIRE(guide.size() == places.size());
    const Traced plain = traced(room, PathOptions{}), guided = traced(room, gathering(&guide));
    CAPTURE(plain.mean);
    CAPTURE(guided.mean);
    CAPTURE(plain.variance);
    CAPTURE(guided.variance);
    CHECK(plain.difference_in_errors(guided) < 4);
    CHECK(guided.variance < 0.5 * plain.variance);
}

TEST_CASE("guided paths of a varnish find the same light as others") {
    for (const float alpha : {0.0f, 0.3f}) {
        const Room room = indirectly_lit_room(varnish(0.7f, alpha));
        const auto places = places_on_floor();
        const PathGuide guide = guide_of(room, places);
        const Traced plain = traced(room, PathOptions{}), guided = traced(room, gathering(&guide));
        CAPTURE(alpha);
        CAPTURE(plain.mean);
        CAPTURE(guided.mean);
        CHECK(plain.difference_in_errors(guided) < 4);
    }
}

TEST_CASE("light that a ray finds is weighted against a sample of all lights where the ray begins") {
    // Cosine-distributed rays and light samples at the floor add up to the direct irradiance.
    const Room room = closed_room({0.5f, 0, 0, 0, 0, 0}, {0, 1, 0, 0, 0, 0});
    const SurfacePoint from = bare_point(room.world(), {{0.2f, -1, 0.3f}, {0, 1, 0}});
    constexpr uint32_t count = 20000;
    std::vector<PathRay> rays;
    for (uint32_t i = 0; i < count; ++i) {
        Sampler sampler(3, 0, i);
        const Vec3 w = square_to_cosine_hemisphere(sampler.next_2d());
        rays.push_back({from.ray(from.frame.to_world(w)), sampler, cosine_hemisphere_pdf_solid_angle(w)});
    }
    std::vector<PathResult> weighted(count), whole(count);
    Progress progress;
    trace_paths(room.world(), rays, PathOptions{}, weighted, progress);
    for (PathRay& ray : rays) ray.pdf = 0;
    trace_paths(room.world(), rays, PathOptions{}, whole, progress);
    double found = 0, all = 0, sampled = 0;
    for (uint32_t i = 0; i < count; ++i) {
        found += weighted[i].emitted.g * static_cast<double>(pi) / count;
        all += whole[i].emitted.g * static_cast<double>(pi) / count;
        Sampler sampler(4, 0, i);
        const float u = sampler.next_1d();
        const LightSample light = room.world().lights.sample(from.position, u, sampler.next_2d(), LightSet::all);
        const float cosine = dot(light.wi, from.normal), density = cosine * inv_pi;
        if (cosine > 0)
            sampled += static_cast<double>(light.radiance.g * cosine / light.pdf_solid_angle *
                                           power_heuristic(light.pdf_solid_angle, density)) /
                       count;
    }
    CHECK(found < 0.8 * all);
    CHECK(found + sampled == doctest::Approx(all).epsilon(0.01));
}

TEST_CASE("a guide is the same on any number of threads") {
    const Room room = indirectly_lit_room(diffuse(0.7f, 0));
    const auto places = places_on_floor();
    const PathGuide one = guide_of(room, places, 1), two = guide_of(room, places, 2);
    CHECK(traced(room, gathering(&one)).mean == traced(room, gathering(&two)).mean);
}

TEST_CASE("guides without places, on surfaces turned elsewhere or in the dark leave directions alone") {
    const Room room = indirectly_lit_room(diffuse(0.7f, 0)),
               dark = closed_room({0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f}, {});
    const std::vector<PointNormal> none, on_wall{{{-1, 0, 0}, {1, 0, 0}}};
    const double unguided = traced(room, gathering(nullptr)).mean;
    for (const auto& places : {none, on_wall}) {
        const PathGuide guide = guide_of(room, places);
        CHECK(traced(room, gathering(&guide)).mean == unguided);
    }
    const PathGuide unlit = guide_of(dark, places_on_floor());
    CHECK(traced(dark, gathering(&unlit)).mean == 0);
    CHECK(traced(room, gathering(&unlit)).mean == doctest::Approx(unguided).epsilon(1e-3));
}

TEST_CASE("places far away and places with broken normals aim nothing") {
    const Room room = indirectly_lit_room(diffuse(0.7f, 0));
    const double unguided = traced(room, gathering(nullptr)).mean;
    // Two places 1 mm from each other, a metre and more from all that is seen.
    const std::vector<PointNormal> far{{{-0.9f, -1, -0.9f}, {0, 1, 0}}, {{-0.899f, -1, -0.9f}, {0, 1, 0}}};
    const PathGuide distant = guide_of(room, far);
    CHECK(traced(room, gathering(&distant)).mean == unguided);
    const std::vector<PointNormal> broken{{{0, -1, 0}, {1e20f, 1e20f, 1e20f}}, {{0.1f, -1, 0}, {0, 1, 0}}};
    const PathGuide partly = guide_of(room, broken);
    CHECK(std::isfinite(traced(room, gathering(&partly)).mean));
}

TEST_CASE("a cancelled guide ends at once") {
    const Room room = indirectly_lit_room(diffuse(0.7f, 0));
    Progress progress;
    progress.cancelled = true;
    CHECK_THROWS_AS(PathGuide(room.world(), places_on_floor(), PathOptions{}, 0, progress), Cancelled);
}
