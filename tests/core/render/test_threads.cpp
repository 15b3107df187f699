// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A whole solve and render of a small scene built from arrays: the same bits on one thread, on two and in any order of
// tiles, and the right answer where there is a closed form. Under ThreadSanitizer (tools/check --full) this is what
// drives the threads.

#include <doctest/doctest.h>

#include <array>
#include <cstring>
#include <memory>
#include <utility>
#include <vector>

#include "methods/irradiance_cache/irradiance_cache.h"
#include "render/render.h"
#include "room.h"

using namespace eclat;

namespace {

Camera camera_in_room() {
    Camera c{};
    c.right = {1, 0, 0};
    c.up = {0, 1, 0};
    c.backward = {0, 0, 1};
    c.position = {0.1f, 0, 0.8f};
    c.width = 72;  // tiles of 32 do not divide it
    c.height = 40;
    c.half_width = 0.9f;
    c.half_height = 0.5f;
    return c;
}

IrradianceCacheOptions small_solve(int threads) {
    IrradianceCacheOptions options;
    options.rows = 6;
    options.far_rows = 3;
    options.far_records = 50;
    options.seed = 5;
    options.threads = threads;
    return options;
}

RenderRange all_pixels(const Camera& camera, uint32_t samples, int threads) {
    RenderRange range;
    range.end_sample = samples;
    range.x1 = camera.width;
    range.y1 = camera.height;
    range.seed = 5;
    range.threads = threads;
    return range;
}

bool same_bits(const Film& a, const Film& b) {
    for (size_t i = 0; i < a.pixels().size(); ++i) {
        const Film::Pixel &p = a.pixels()[i], &q = b.pixels()[i];
        if (std::memcmp(&p.radiance, &q.radiance, sizeof p.radiance) != 0 ||
            std::memcmp(&p.direct, &q.direct, sizeof p.direct) != 0 || p.cache_misses != q.cache_misses)
            return false;
    }
    return a.pixels().size() == b.pixels().size();
}

}  // namespace

TEST_CASE("several cameras share one cache, which has the same bits on one thread and on two") {
    const Room room = closed_room({0.5f, 0.7f, 0.2f, 0.6f, 0.5f, 0.5f}, {0, 0, 3, 0, 0, 0});
    Camera left = camera_in_room(), right = left;
    right.position = right.position + right.right * 0.05f;
    const auto solved = [&](std::vector<Camera> cameras, int threads) {
        Progress progress;
        SolvedCaches caches;
        solve_irradiance_cache(room.world(), cameras, small_solve(threads), caches, progress);
        CHECK(progress.done == progress.total);
        return caches.near.records();
    };
    const auto one = solved({left, right}, 1), two = solved({left, right}, 2);
    REQUIRE(one.size() == two.size());
    for (size_t i = 0; i < one.size(); ++i) {
        CHECK(one[i].position == two[i].position);
        CHECK(std::memcmp(&one[i].irradiance, &two[i].irradiance, sizeof one[i].irradiance) == 0);
    }
    // The second camera sees nearly the same, so it wants few further records.
    const auto alone = solved({left}, 1).size(), other = solved({right}, 1).size();
    CHECK(one.size() >= std::max(alone, other));
    CHECK(one.size() < 3 * (alone + other) / 4);
}

TEST_CASE("records and picture have the same bits on one thread and on two, and in any order of tiles") {
    const Room room = closed_room({0.5f, 0.7f, 0.2f, 0.6f, 0.5f, 0.5f}, {0, 0, 3, 0, 0, 0});
    const Camera camera = camera_in_room();
    Progress progress;
    SolvedCaches one;
    solve_irradiance_cache(room.world(), {&camera, 1}, small_solve(1), one, progress);
    SolvedCaches two;
    solve_irradiance_cache(room.world(), {&camera, 1}, small_solve(2), two, progress);
    REQUIRE(one.near.records().size() > 20);
    for (auto caches : {std::pair{&one.near, &two.near}, std::pair{&one.far, &two.far}}) {
        const auto &a = caches.first->records(), &b = caches.second->records();
        REQUIRE(a.size() == b.size());
        for (size_t i = 0; i < a.size(); ++i) {
            CHECK(a[i].position == b[i].position);
            CHECK(std::memcmp(&a[i].irradiance, &b[i].irradiance, sizeof a[i].irradiance) == 0);
            CHECK(std::memcmp(&a[i].rotation, &b[i].rotation, sizeof a[i].rotation) == 0);
            CHECK(std::memcmp(&a[i].translation, &b[i].translation, sizeof a[i].translation) == 0);
            CHECK(a[i].radius == b[i].radius);
        }
    }

    PathOptions paths;
    paths.cache = read_near(one);
    paths.light_set = LightSet::without_smooth_environment;
    const auto picture = [&](int threads, std::vector<uint32_t> order) {
        auto film = std::make_unique<Film>(camera.width, camera.height);
        RenderRange range = all_pixels(camera, 2, threads);
        range.tile_order = std::move(order);
        render(camera, path_estimator(room.world(), paths), range, *film, progress);
        return film;
    };
    const auto first = picture(1, {});
    CHECK(first->bad_count() == 0);
    CHECK(same_bits(*first, *picture(2, {})));
    CHECK(same_bits(*first, *picture(2, {5, 2, 4, 0, 1, 3})));

    RenderRange other_seed = all_pixels(camera, 2, 1);
    other_seed.seed = 6;
    Film changed(camera.width, camera.height);
    render(camera, path_estimator(room.world(), paths), other_seed, changed, progress);
    CHECK_FALSE(same_bits(*first, changed));  // the comparison sees a difference
}

TEST_CASE("a closed room of equal walls: L = L_e / (1 − ρ), by paths and through the cache") {
    const float rho = 0.5f, emission = 2;
    std::array<float, 6> albedo, emissions;
    albedo.fill(rho);
    emissions.fill(emission);
    const Room room = closed_room(albedo, emissions);
    const Camera camera = camera_in_room();
    Progress progress;
    SolvedCaches caches;
    solve_irradiance_cache(room.world(), {&camera, 1}, small_solve(2), caches, progress);
    for (bool cached : {false, true}) {
        CAPTURE(cached);
        PathOptions paths;
        if (cached) paths.cache = read_near(caches);
        Film film(camera.width, camera.height);
        render(camera, path_estimator(room.world(), paths), all_pixels(camera, 4, 2), film, progress);
        double sum = 0;
        for (const Film::Pixel& p : film.pixels()) sum += p.radiance.g / static_cast<float>(p.samples);
        CHECK(sum / static_cast<double>(film.pixels().size()) == doctest::Approx(emission / (1 - rho)).epsilon(0.01));
    }
}

TEST_CASE("a solve and a render end when they are cancelled") {
    const Room room = closed_room({0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f}, {1, 0, 0, 0, 0, 0});
    const Camera camera = camera_in_room();
    Progress progress;
    progress.cancelled = true;
    SolvedCaches caches;
    CHECK_THROWS_AS(solve_irradiance_cache(room.world(), {&camera, 1}, small_solve(2), caches, progress), Cancelled);
    Film film(camera.width, camera.height);
    CHECK_THROWS_AS(render(camera, path_estimator(room.world(), {}), all_pixels(camera, 1, 2), film, progress),
                    Cancelled);
}
