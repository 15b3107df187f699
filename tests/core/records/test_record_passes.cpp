// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// What all ways to fill a cache share: gathers whose result has a closed form, who gets a record, and which random
// numbers it depends on.

#include <doctest/doctest.h>

#include <cstring>
#include <vector>

#include "hemisphere/hemisphere.h"
#include "records/gather.h"
#include "records/record_passes.h"
#include "room.h"

using namespace eclat;

namespace {

Candidate candidate(Vec3 position, Vec3 normal, uint32_t key, float footprint = 0.01f) {
    Candidate c;
    c.position = position;
    c.normal = c.shading_normal = normal;
    c.offset = 1e-5f;
    c.footprint = footprint;
    c.key = key;
    return c;
}

/// On the floor of the closed room, a tenth of it apart.
std::vector<Candidate> on_the_floor(int count, uint32_t first_key = 0) {
    std::vector<Candidate> out;
    for (int i = 0; i < count; ++i)
        out.push_back(candidate({-0.8f + 0.2f * static_cast<float>(i), -1, 0.3f}, {0, 1, 0},
                                first_key + static_cast<uint32_t>(i)));
    return out;
}

IrradianceCacheOptions coarse() {
    IrradianceCacheOptions options;
    options.rows = 8;
    options.far_rows = 4;
    options.far_records = 100;
    options.threads = 2;
    return options;
}

Room furnace(float albedo, float emission) {
    std::array<float, 6> albedos, emissions;
    albedos.fill(albedo);
    emissions.fill(emission);
    return closed_room(albedos, emissions);
}

constexpr Stream stream{7};

}  // namespace

TEST_CASE("a gather in a furnace gives E = π L_e ρ / (1 − ρ), without the emission of the surfaces that its rays hit") {
    const Room room = furnace(0.5f, 2);
    Progress progress;
    const auto records = gather_records(room.world(), on_the_floor(9), {}, coarse(), stream, 16, progress);
    REQUIRE(records.size() == 9);
    double sum = 0;
    for (const IrradianceRecord& r : records) sum += (r.irradiance + r.excess).g / 9;
    CHECK(sum == doctest::Approx(pi * 2 * 0.5 / (1 - 0.5)).epsilon(0.01));
    CHECK(progress.rays > 9 * 16 * 50);
}

TEST_CASE("rays aimed at bright places change only the noise") {
    // A lamp close under the ceiling shines up: all light comes from one small spot.
    std::vector<Wall> walls{{{-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, 0.5f, 0},
                            {{-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, 0.5f, 0}};
    walls.push_back({{-0.03f, 0.95f, -0.03f}, {0, 0, 0.06f}, {0.06f, 0, 0}, 0, 100});
    const Room room = build_room(walls);
    IrradianceCacheOptions options = coarse();
    options.max_depth = 3;
    Progress progress;
    BrightPlaces bright;
    const BrightPlaces none;
    const auto at = [&](uint32_t key, const BrightPlaces& places) {
        const FarEnd none_far;
        const World world = room.world();
        return gather({world, none_far, places, options, stream, progress}, candidate({0.8f, -1, 0.3f}, {0, 1, 0}, key),
                      8);
    };
    constexpr uint32_t count = 300;
    const auto mean_and_deviation = [&](const BrightPlaces& places) {
        double sum = 0, squares = 0;
        for (uint32_t key = 0; key < count; ++key) {
            const IrradianceRecord r = at(key, places).record;
            const double E = (r.irradiance + r.excess).g;
            sum += E;
            squares += E * E;
        }
        const double mean = sum / count;
        return std::pair{mean, std::sqrt(squares / count - mean * mean)};
    };
    const auto [unaimed, noisy] = mean_and_deviation(none);
    for (uint32_t key = 1000; key < 1300; ++key) bright.add(at(key, none).sightings);
    REQUIRE_FALSE(bright.empty());
    const auto [aimed, quiet] = mean_and_deviation(bright);
    CHECK(quiet < 0.5 * noisy);
    CHECK(std::fabs(aimed - unaimed) < 5 * noisy / std::sqrt(double(count)));
}

TEST_CASE("most rays that meet backs of one-sided surfaces tell that a point is in a solid, unless a camera sees it") {
    // The room seen from outside: its walls face inwards.
    const Room room = furnace(0.5f, 1);
    Progress progress;
    const auto enclosed = [&](bool two_sided, bool seen = false, bool culled = false, bool lined = false) {
        std::vector<MeshArrays> meshes(1);
        meshes[0].positions = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                               {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
        // A block, its faces outwards.
        meshes[0].triangles = {{{0, 2, 1}}, {{0, 3, 2}}, {{4, 5, 6}}, {{4, 6, 7}}, {{0, 1, 5}}, {{0, 5, 4}},
                               {{3, 7, 6}}, {{3, 6, 2}}, {{0, 4, 7}}, {{0, 7, 3}}, {{1, 2, 6}}, {{1, 6, 5}}};
        if (lined)
            for (int i = 0; i < 12; ++i) {
                const auto [a, b, c] = meshes[0].triangles[i].v;
                meshes[0].triangles.push_back({{a, c, b}});
            }
        Material m = diffuse(0.5f, 0);
        m.two_sided = two_sided;
        m.back_culled = culled;
        const Geometry geometry(std::move(meshes), {m}, {});
        const Lights lights{LightInputs{}};
        const std::vector<uint32_t> emitters(24, not_emitting);
        const World world{geometry, lights, emitters};
        std::vector<Candidate> inside{candidate({0.2f, -0.5f, 0.1f}, {0, 1, 0}, 1)};
        inside[0].seen = seen;
        return gather_records(world, inside, {}, coarse(), stream, 8, progress)[0].enclosed > 0;
    };
    CHECK(enclosed(false));
    CHECK_FALSE(enclosed(true));
    CHECK_FALSE(enclosed(false, true));
    // Rays pass through culled backs, and yet they bound a solid; not where fronts line them inside, as in a room.
    CHECK(enclosed(false, false, true));
    CHECK_FALSE(enclosed(false, false, true, true));
    CHECK(gather_records(room.world(), on_the_floor(1), {}, coarse(), stream, 8, progress)[0].enclosed == 0);
}

TEST_CASE("one bounce under a depth of 3 and no more: E = π ρ L_e") {
    const Room room = furnace(0.5f, 2);
    IrradianceCacheOptions options = coarse();
    options.max_depth = 3;
    Progress progress;
    const auto records = gather_records(room.world(), on_the_floor(9), {}, options, stream, 16, progress);
    double sum = 0;
    // What its rays meet shines ρ / π times its own direct irradiance π L_e.
    for (const IrradianceRecord& r : records) sum += (r.irradiance + r.excess).g / 9;
    CHECK(sum == doctest::Approx(pi * 0.5 * 2).epsilon(0.02));
    CHECK(far_passes(options) == 0);
    options.max_depth = 2;
    const auto direct = gather_records(room.world(), on_the_floor(1), {}, options, stream, 16, progress);
    CHECK((direct[0].irradiance + direct[0].excess).g == 0);
}

TEST_CASE("a record knows its place, its distance and its bounds in pixels") {
    const Room room = furnace(0.5f, 1);
    IrradianceCacheOptions options = coarse();
    options.gradient_limit = false;
    options.metric = Metric::minimum;
    options.spacing = 0.4f;
    Progress progress;
    const auto at = [&](float footprint) {
        const std::vector<Candidate> wanted{candidate({0.1f, -1, 0.2f}, {0, 1, 0}, 3, footprint)};
        return gather_records(room.world(), wanted, {}, options, stream, 16, progress)[0];
    };
    const IrradianceRecord r = at(0.01f);
    CHECK(r.position == Vec3{0.1f, -1, 0.2f});
    CHECK(r.normal == Vec3{0, 1, 0});
    CHECK(r.least_radius == doctest::Approx(options.least_pixels * 0.01f));
    CHECK(r.largest_radius == doctest::Approx(options.largest_pixels * 0.01f));
    // The front wall is 0.8 away; rays are slanted.
    CHECK(r.distance > 0.8f);
    CHECK(r.distance < 0.9f);
    CHECK(r.radius == doctest::Approx(options.spacing * r.distance));
    CHECK(at(0.6f).radius == doctest::Approx(options.least_pixels * 0.6f));        // raised
    CHECK(at(0.001f).radius == doctest::Approx(options.largest_pixels * 0.001f));  // lowered
}

TEST_CASE("a panel that hangs close under the ceiling ends a record's validity, however few rays its gather has") {
    const Room room = build_room({{{-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, 0.5f, 0},             // ceiling
                                  {{0.3f, 0.99f, -1}, {0.7f, 0, 0}, {0, 0, 2}, 0.5f, 0}});  // panel, seen from below
    Progress progress;
    const Vec3 down{0, -1, 0};
    for (const uint32_t key : {1u, 2u, 3u, 4u}) {
        const std::vector<Candidate> wanted{candidate({0.1f, 1, 0}, down, key)};
        const auto r = gather_records(room.world(), wanted, {}, coarse(), stream, 4, progress)[0];
        const auto clearance = [&](Vec3 d) { return r.clearance[clearance_sector(Frame::around(down), d)]; };
        // A ray at 1.5° meets the panel where it is 0.01 under the ceiling, 0.38 away; its edge is 0.2 away.
        CHECK(clearance({1, 0, 0.1f}) > 0.2f);
        CHECK(clearance({1, 0, 0.1f}) < 0.2f * 1.17f);
        CHECK(r.distance == doctest::Approx(clearance({1, 0, 0.1f})).epsilon(0.01));
        CHECK(clearance({-1, 0, 0.1f}) == infinity);
    }
}

TEST_CASE("a record's validity ends before the corner of a house that stands between two of its rays") {
    Progress progress;
    for (int step = 0; step < 12; ++step) {
        const float phi = static_cast<float>(step) * 4 * pi / 180;
        const Vec3 ahead{std::cos(phi), 0, std::sin(phi)}, aside{-std::sin(phi), 0, std::cos(phi)};
        const Vec3 corner = ahead * 15;
        const Room room = build_room({{{-50, 0, -50}, {0, 0, 100}, {100, 0, 0}, 0.5f, 0},
                                      {corner, (ahead + aside) * 5, {0, 3, 0}, 0.5f, 0},
                                      {corner, (ahead - aside) * 5, {0, 3, 0}, 0.5f, 0}});
        const std::vector<Candidate> wanted{candidate({0, 0, 0}, {0, 1, 0}, static_cast<uint32_t>(step))};
        const auto r = gather_records(room.world(), wanted, {}, coarse(), stream, 8, progress)[0];
        CHECK(r.clearance[clearance_sector(Frame::around({0, 1, 0}), ahead)] < 15.01f);
    }
}

TEST_CASE("a record's validity ends before the near end of a wall that stands between two of its rays") {
    Progress progress;
    for (int step = 0; step < 12; ++step) {
        const float phi = static_cast<float>(step) * 4 * pi / 180;
        const Vec3 ahead{std::cos(phi), 0, std::sin(phi)}, aside{-std::sin(phi), 0, std::cos(phi)};
        const Room room = build_room({{{-50, 0, -50}, {0, 0, 100}, {100, 0, 0}, 0.5f, 0},
                                      {ahead * 15, (ahead + aside) * 10, {0, 3, 0}, 0.5f, 0}});
        const std::vector<Candidate> wanted{candidate({0, 0, 0}, {0, 1, 0}, static_cast<uint32_t>(step))};
        const auto r = gather_records(room.world(), wanted, {}, coarse(), stream, 8, progress)[0];
        CHECK(r.clearance[clearance_sector(Frame::around({0, 1, 0}), ahead)] < 15.01f);
        CHECK(r.clearance[clearance_sector(Frame::around({0, 1, 0}), ahead)] > 10);
    }
}

TEST_CASE("if the lower bound increases a radius, the gradient is reduced by the same factor") {
    const Room room = closed_room({0.5f, 0.5f, 0.9f, 0.1f, 0.5f, 0.5f}, {0, 1, 0, 0, 0, 0});
    IrradianceCacheOptions options = coarse();
    options.gradient_limit = false;
    options.metric = Metric::minimum;
    options.spacing = 0.4f;
    options.least_pixels = 4;
    Progress progress;
    const auto slope = [&](float footprint) {
        const std::vector<Candidate> wanted{candidate({-0.5f, -1, 0.2f}, {0, 1, 0}, 3, footprint)};
        const auto r = gather_records(room.world(), wanted, {}, options, stream, 16, progress)[0];
        return std::pair{r.translation.channel[1].x, options.spacing * r.distance / r.radius};
    };
    const auto [steep, kept] = slope(0.01f);
    const auto [shrunk, part] = slope(0.2f);
    CHECK(kept == doctest::Approx(1));
    REQUIRE(steep != 0);
    CHECK(part < 0.6f);
    CHECK(shrunk / steep == doctest::Approx(part).epsilon(0.08));  // what is nearer than the bound is kept off
}

TEST_CASE("a record depends on its key, its stream and the seed, not on who is gathered with it") {
    const Room room = closed_room({0.5f, 0.7f, 0.2f, 0.6f, 0.5f, 0.5f}, {0, 0, 3, 0, 0, 0});
    Progress progress;
    const auto wanted = on_the_floor(5);
    const auto gather = [&](std::span<const Candidate> some, const IrradianceCacheOptions& options, Stream s) {
        return gather_records(room.world(), some, {}, options, s, 6, progress);
    };
    const auto same = [](const IrradianceRecord& a, const IrradianceRecord& b) {
        return std::memcmp(&a, &b, sizeof a) == 0;
    };
    const IrradianceRecord alone = gather(std::span(wanted).subspan(3, 1), coarse(), stream)[0];
    CHECK(same(alone, gather(wanted, coarse(), stream)[3]));
    CHECK_FALSE(same(alone, gather(wanted, coarse(), Stream::far_records)[3]));
    IrradianceCacheOptions other = coarse();
    other.seed = 1;
    CHECK_FALSE(same(alone, gather(wanted, other, stream)[3]));
    CHECK_FALSE(same(alone, gather(on_the_floor(5, 1), coarse(), stream)[3]));
}

TEST_CASE("a pass gives records to those not served, and a second one finds none") {
    const Room room = furnace(0.5f, 1);
    const IrradianceCacheOptions options = coarse();
    SolvedCaches caches = empty_caches(options);
    RecordSolve solve{caches};
    Progress progress;
    // Far from each other, so that one pass against the frozen cache leaves nothing to do.
    const std::vector<Candidate> some{candidate({-0.6f, -1, 0}, {0, 1, 0}, 0), candidate({0.6f, -1, 0}, {0, 1, 0}, 1)};
    CHECK(unserved(caches.near, some, 1).size() == 2);
    CHECK(add_near(room.world(), some, options, solve, progress) == 2);
    CHECK(caches.near.records().size() == 2);
    CHECK(progress.done == 1);
    CHECK(add_near(room.world(), some, options, solve, progress) == 0);
    CHECK(caches.near.records().size() == 2);

    auto mixed = some;
    mixed.insert(mixed.begin() + 1, candidate({0, 1, 0}, {0, -1, 0}, 2));
    mixed.push_back(candidate({-0.6f, -1, 0}, {0, -1, 0}, 3));  // the other side
    const auto left = unserved(caches.near, mixed, 2);
    REQUIRE(left.size() == 2);
    CHECK(left[0].key == 2);
    CHECK(left[1].key == 3);
}

TEST_CASE("far records are thinned, coarse and read without turning") {
    const Room room = furnace(0.5f, 1);
    const IrradianceCacheOptions options = coarse();
    SolvedCaches caches = empty_caches(options);
    RecordSolve solve{caches};
    CHECK(caches.near.options().rotation_gradient);
    CHECK_FALSE(caches.far.options().rotation_gradient);
    Progress progress;
    const auto& world = room.world();
    // From the middle of a cube of two metres, what is met lies between 1 and 1.7 m away. Two lie within the sum of two least
    // radii of the first; one of these sees the other way. The last sees nothing, and is seen by nothing.
    const std::vector<Candidate> close{candidate({0, 0, 0}, {0, 1, 0}, 0), candidate({0.016f, 0, 0}, {0, 1, 0}, 1),
                                       candidate({0.005f, 0, 0}, {0, -1, 0}, 2), candidate({0.03f, 0, 0}, {0, 1, 0}, 3),
                                       candidate({0, -1, 0}, {0, -1, 0}, 4)};
    add_far(world, close, options, solve, progress);
    const auto& records = caches.far.records();
    REQUIRE(records.size() == 3);
    CHECK(records[1].normal == Vec3{0, -1, 0});
    CHECK(records[2].position == close[3].position);
    for (const IrradianceRecord& r : records) {
        CHECK(r.least_radius > 0.008f);
        CHECK(r.least_radius < 0.008f * 1.75f);
        CHECK(r.radius >= r.least_radius);
        CHECK(r.radius <= 0.16f * 1.75f);
    }
}

TEST_CASE("far candidates lie on the walls that rays meet, and rays of two parts are those of the whole") {
    const Room room = furnace(0.5f, 1);
    const auto seen = on_the_floor(9);
    Progress progress;
    const auto rays = [&](uint32_t first, uint32_t end) {
        return far_candidates(room.world(), seen, first, end, coarse(), progress);
    };
    const auto all = rays(0, 200), begin = rays(0, 80), rest = rays(80, 200);
    REQUIRE(all.size() == 200);  // a closed room
    REQUIRE(begin.size() + rest.size() == 200);
    for (size_t i = 0; i < 200; ++i) {
        const Candidate& c = all[i];
        CHECK(c.position == (i < 80 ? begin[i] : rest[i - 80]).position);
        CHECK(c.key == i);
        CHECK(dot(c.position, c.normal) == doctest::Approx(-1).epsilon(1e-5));  // inwards, at a distance of 1
    }
    SolvedCaches caches = empty_caches(coarse());
    RecordSolve solve{caches};
    solve_far(room.world(), {}, coarse(), solve, progress);
    CHECK(caches.far.records().empty());
    solve_far(room.world(), seen, coarse(), solve, progress);
    CHECK(caches.far.records().size() > 20);
    for (const IrradianceRecord& r : caches.far.records()) CHECK(dot(r.position, r.normal) < -0.999f);
}
