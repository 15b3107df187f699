// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// What paths of gathers find at their hits: estimates of irradiance without bias, and the cells that average them.

#include "records/far_cells.h"

#include <doctest/doctest.h>

#include <span>
#include <utility>
#include <vector>

#include "records/record_passes.h"
#include "room.h"
#include "transport/paths.h"
#include "transport/point_irradiance.h"

using namespace eclat;

namespace {

CellSample sample(Vec3 position, Vec3 normal, float value, float distance = 1) {
    return {CellKey::at(position, normal, distance), Color(value, 2 * value, 0)};
}

std::vector<CellSample> repeated(const CellSample& one, int count) {
    return std::vector<CellSample>(static_cast<size_t>(count), one);
}

/// Places on a floor and the lengths of rays to them, and a sample of each.
std::pair<std::vector<std::pair<Vec3, float>>, std::vector<CellSample>> many_samples() {
    std::vector<std::pair<Vec3, float>> places;
    std::vector<CellSample> samples;
    for (uint32_t i = 0; i < 100000; ++i) {
        Rng rng(1, i);
        const Vec3 p{rng.next(), rng.next(), rng.next()};
        const float value = rng.next(), distance = 1 + 4 * rng.next();
        places.emplace_back(p, distance);
        samples.push_back(sample(p, {0, 1, 0}, value, distance));
    }
    return {places, samples};
}

/// A closed room with a lamp and coloured walls.
Room lit_room() { return closed_room({0.2f, 0.7f, 0.5f, 0.5f, 0.6f, 0.4f}, {0, 0, 0, 5, 0, 0}); }

/// Traces `count` rays that all hit the same point of the floor, and returns their results.
std::vector<PathResult> at_one_point(const World& world, bool estimate, uint32_t count) {
    std::vector<PathRay> rays;
    for (uint32_t i = 0; i < count; ++i)
        rays.push_back({{{0.1f, 0.5f, 0.2f}, 0, {0, -1, 0}, infinity}, Sampler(3, 0, i)});
    PathOptions options;
    options.emission_at_first_hit = false;
    options.light_set = LightSet::without_smooth_environment;
    options.estimate_irradiance = estimate;
    std::vector<PathResult> results(count);
    Progress progress;
    trace_paths(world, rays, options, results, progress);
    return results;
}

}  // namespace

TEST_CASE("the irradiance that one path finds is without bias, and leaves out what light samples find") {
    const Room room = lit_room();
    constexpr uint32_t count = 1 << 16;
    double sum = 0;
    for (const PathResult& r : at_one_point(room.world(), true, count)) {
        REQUIRE(r.irradiance);
        sum += r.irradiance->g;
    }
    PointIrradianceOptions options;
    options.component = Component::indirect;
    options.samples = count;
    Progress progress;
    const std::vector<PointNormal> point{{{0.1f, -1, 0.2f}, {0, 1, 0}}};
    const float truth = path_irradiance(room.world(), point, options, progress)[0].g;
    CHECK(sum / count == doctest::Approx(truth).epsilon(0.01));
}

TEST_CASE("what is found at the first vertex does not change the radiance") {
    const Room room = lit_room();
    const auto with = at_one_point(room.world(), true, 256), without = at_one_point(room.world(), false, 256);
    for (size_t i = 0; i < with.size(); ++i) {
        CHECK(with[i].radiance.r == doctest::Approx(without[i].radiance.r).epsilon(1e-4));
        CHECK_FALSE(without[i].irradiance);
    }
}

TEST_CASE("a cell gives the mean of its estimates once there are enough") {
    FarCells cells;
    const Vec3 p{0.3f, 0, 0.7f}, up{0, 1, 0};
    cells.add(repeated(sample(p, up, 1), 28), 2);
    CHECK_FALSE(cells.irradiance(p, up, 1));
    cells.add(repeated(sample(p, up, 9), 4), 2);
    const auto E = cells.irradiance(p, up, 1);
    REQUIRE(E);
    CHECK(E->r == doctest::Approx(2));
    CHECK(E->g == doctest::Approx(4));
    CHECK(E->b == 0);
}

TEST_CASE("cells tell apart sides of a sheet, distant places, and lengths of rays") {
    FarCells cells;
    const Vec3 p{0.3f, 0, 0.7f}, up{0, 1, 0};
    cells.add(repeated(sample(p, up, 1), 100), 1);
    CHECK(cells.irradiance(p, up, 1));
    CHECK_FALSE(cells.irradiance(p, -up, 1));
    CHECK_FALSE(cells.irradiance(p + Vec3{0.2f, 0, 0}, up, 1));
    CHECK_FALSE(cells.irradiance(p, up, 0.1f));
}

TEST_CASE("points of a wall on a border of a grid share cells, however they are rounded") {
    FarCells cells;
    const Vec3 up{0, 1, 0};
    for (const float y : {0.0f, 1e-7f, -1e-7f}) cells.add(repeated(sample({0.3f, y, 0.7f}, up, 1 + 1e6f * y), 20), 1);
    const auto E = cells.irradiance({0.3f, -2e-7f, 0.7f}, up, 1);
    REQUIRE(E);
    CHECK(E->r == doctest::Approx(1));
}

TEST_CASE("cells do not depend on the number of threads") {
    const auto [places, samples] = many_samples();
    FarCells one, many;
    one.add(samples, 1);
    many.add(samples, 4);
    size_t read = 0;
    for (const auto& [position, distance] : places) {
        const auto a = one.irradiance(position, {0, 1, 0}, distance),
                   b = many.irradiance(position, {0, 1, 0}, distance);
        REQUIRE(a.has_value() == b.has_value());
        if (!a) continue;
        ++read;
        CHECK(a->r == b->r);
    }
    CHECK(read > 1000);
}

TEST_CASE("cells that get the means of others are read like them, also as the means change") {
    const auto [places, samples] = many_samples();
    FarCells known, told;
    size_t sent = 0;
    for (const size_t first : {size_t(0), samples.size() / 2}) {
        const auto some = std::span(samples).subspan(first, samples.size() / 2);
        known.add(some, 1);
        const auto means = known.means_of(some);
        told.set(means);
        sent += means.size();
        for (const auto& [position, distance] : places) {
            const auto a = known.irradiance(position, {0, 1, 0}, distance),
                       b = told.irradiance(position, {0, 1, 0}, distance);
            REQUIRE(a.has_value() == b.has_value());
            if (a) CHECK(a->r == b->r);
        }
    }
    CHECK(sent > 0);
    CHECK(10 * sent < samples.size());
}

TEST_CASE("records of gathers that end in cells have the irradiance of records whose paths go on") {
    const Room room = lit_room();
    std::vector<Candidate> candidates;
    for (int i = 0; i < 300; ++i) {
        Candidate c;
        c.position = {-0.9f + 0.006f * static_cast<float>(i), -1, 0.3f};
        c.normal = c.shading_normal = {0, 1, 0};
        c.offset = 1e-5f;
        c.footprint = 0.002f;
        c.key = static_cast<uint32_t>(i);
        candidates.push_back(c);
    }
    IrradianceCacheOptions options;
    options.far_records = 0;
    options.disagreement = infinity;
    options.largest_pixels = 1.5f;
    SolvedCaches caches = empty_caches(options), again = empty_caches(options);
    Progress progress;
    RecordSolve solve{caches};
    solve.read_cells = true;
    // The first pass fills the cells, which the second pass reads.
    add_near(room.world(), std::span(candidates).first(60), options, solve, progress);
    const uint64_t before = progress.rays;
    const size_t first = caches.near.records().size();
    add_near(room.world(), std::span(candidates).subspan(60), options, solve, progress);
    const uint64_t rays = progress.rays - before;
    const auto traced = gather_records(room.world(), std::span(candidates).subspan(60), {}, options,
                                       Stream::point_gathers, options.rows, progress);
    double read = 0, truth = 0;
    const auto& records = caches.near.records();
    REQUIRE(records.size() - first > 50);
    for (size_t i = first; i < records.size(); ++i)
        read += (records[i].irradiance + records[i].excess).g / static_cast<double>(records.size() - first);
    for (const auto& r : traced) truth += (r.irradiance + r.excess).g / static_cast<double>(traced.size());
    CHECK(read == doctest::Approx(truth).epsilon(0.02));
    const uint64_t rays_without = (progress.rays - before - rays) * (records.size() - first) / traced.size();
    CHECK(10 * rays < 7 * rays_without);
}
