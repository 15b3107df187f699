// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Interpolation between records: fields that it must reproduce, and what it must refuse.

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "cache/hemisphere.h"
#include "cache/irradiance_cache.h"
#include "sampling/rng.h"

using namespace eclat;

namespace {

constexpr float spacing = 0.5f;

IrradianceRecord record(Vec3 position, float distance, Color E, Vec3 normal = {0, 0, 1}) {
    IrradianceRecord r{};
    r.position = position;
    r.normal = normal;
    r.irradiance = E;
    r.distance = distance;
    r.radius = spacing * distance;
    r.clearance.fill(infinity);
    return r;
}

float linear_field(Vec3 p) { return 2 + 0.3f * p.x - 0.2f * p.y; }

/// Records on the plane z = 0 that know E and its gradient exactly.
std::vector<IrradianceRecord> linear_records() {
    std::vector<IrradianceRecord> out;
    Rng rng(21, 0);
    for (int i = 0; i < 200; ++i) {
        const float x = rng.next() * 2 - 1, y = rng.next() * 2 - 1;
        const Vec3 p{x, y, 0};
        out.push_back(record(p, 0.4f + 0.4f * rng.next(), Color(linear_field(p))));
        out.back().translation.channel.fill({0.3f, -0.2f, 0});
    }
    return out;
}

}  // namespace

TEST_CASE("a linear field is reproduced by exact gradients, and not without them") {
    RecordCache with;
    with.insert(linear_records(), spacing, 1);
    CacheOptions off;
    off.translation_gradient = false;
    RecordCache without(off);
    without.insert(linear_records(), spacing, 1);
    double worst_without = 0;
    int served = 0;
    for (float x = -0.9f; x < 0.9f; x += 0.13f)
        for (float y = -0.9f; y < 0.9f; y += 0.13f) {
            const Vec3 p{x, y, 0};
            const auto E = with.interpolate(p, {0, 0, 1}, {0, 0, 1});
            if (!E) continue;
            ++served;
            CHECK(E->g == doctest::Approx(linear_field(p)).epsilon(1e-5));
            worst_without =
                std::max(worst_without, double(std::abs(without.interpolate(p, {0, 0, 1}, {0, 0, 1})->g - linear_field(p))));
        }
    CHECK(served > 150);
    CHECK(worst_without > 1e-2);
}

TEST_CASE("the rotation gradient answers to a turned normal") {
    // E falls by 0.5 per radian of turn about +y.
    std::vector<IrradianceRecord> records{record({}, 2, Color(3))};
    records[0].rotation.channel.fill({0, -0.5f, 0});
    RecordCache cache;
    cache.insert(records, spacing, 1);
    const float a = 0.1f;
    const Vec3 n{std::sin(a), 0, std::cos(a)};  // turned about +y
    CHECK(cache.interpolate({}, {0, 0, 1}, n)->r == doctest::Approx(3 - 0.5f * std::sin(a)).epsilon(1e-5));
}

TEST_CASE("extrapolation stays positive and plausible") {
    std::vector<IrradianceRecord> records{record({}, 2, Color(1))};
    records[0].translation.channel.fill({-1000, 0, 0});
    RecordCache cache;
    cache.insert(records, spacing, 1);
    CHECK(cache.interpolate({0.5f, 0, 0}, {0, 0, 1}, {0, 0, 1})->r == doctest::Approx(0.05f));
    CHECK(cache.interpolate({-0.5f, 0, 0}, {0, 0, 1}, {0, 0, 1})->r == doctest::Approx(20));
}

TEST_CASE("where no record reaches there is a miss, not darkness") {
    RecordCache cache;
    CHECK_FALSE(cache.interpolate({}, {0, 0, 1}, {0, 0, 1}).has_value());
    const std::vector<IrradianceRecord> records{record({}, 2, Color(1))};
    cache.insert(records, spacing, 1);
    CHECK(cache.interpolate({}, {0, 0, 1}, {0, 0, 1}).has_value());
    CHECK_FALSE(cache.interpolate({5, 0, 0}, {0, 0, 1}, {0, 0, 1}).has_value());
    CHECK_FALSE(cache.interpolate({}, {0, 0, -1}, {0, 0, -1}).has_value());
}

TEST_CASE("records are placed by a strict test and read by a relaxed one") {
    RecordCache cache;
    const std::vector<IrradianceRecord> records{record({}, 2, Color(1))};
    cache.insert(records, spacing, 1);
    CHECK(cache.serves({0.99f, 0, 0}, {0, 0, 1}));
    CHECK_FALSE(cache.serves({1.01f, 0, 0}, {0, 0, 1}));
    CHECK(cache.density({1.01f, 0, 0}, {0, 0, 1}) == 0);
    CHECK(cache.interpolate({1.9f, 0, 0}, {0, 0, 1}, {0, 0, 1}).has_value());
    CHECK_FALSE(cache.interpolate({2.01f, 0, 0}, {0, 0, 1}, {0, 0, 1}).has_value());
}

TEST_CASE("no radius exceeds a neighbour's by more than the distance between them") {
    Rng rng(22, 0);
    std::vector<IrradianceRecord> records;
    for (int i = 0; i < 400; ++i) {
        const float x = rng.next(), y = rng.next();
        records.push_back(record({x, y, 0}, 0.01f + 2 * rng.next(), Color(1)));
    }
    RecordCache cache;
    // In two passes, as a cache is filled.
    cache.insert(std::span(records).first(150), spacing, 1);
    cache.insert(std::span(records).subspan(150), spacing, 2);
    const auto& clamped = cache.records();
    REQUIRE(clamped.size() == 400);
    int changed = 0;
    for (const auto& a : clamped) {
        float least = a.distance;
        for (const auto& b : clamped) {
            const float d = length(a.position - b.position);
            CHECK(a.radius <= b.radius + spacing * d + 1e-6f);
            least = std::min(least, b.distance + d);
        }
        CHECK(a.radius == doctest::Approx(spacing * least).epsilon(1e-6));
        changed += a.radius < spacing * a.distance;
    }
    CHECK(changed > 100);
}

TEST_CASE("a wall beside a record ends its validity in that direction only") {
    std::vector<IrradianceRecord> records{record({}, 4, Color(1))};
    const Frame frame = Frame::around(records[0].normal);
    records[0].clearance[clearance_sector(frame, {1, 0, 0})] = 0.3f;
    RecordCache cache;
    cache.insert(records, spacing, 1);
    CHECK(cache.serves({0.29f, 0, 0}, {0, 0, 1}));
    CHECK_FALSE(cache.serves({0.31f, 0, 0}, {0, 0, 1}));
    CHECK_FALSE(cache.interpolate({0.31f, 0, 0}, {0, 0, 1}, {0, 0, 1}).has_value());
    CHECK(cache.serves({-1, 0, 0}, {0, 0, 1}));
    CHECK(cache.serves({0, 1, 0}, {0, 0, 1}));
}
