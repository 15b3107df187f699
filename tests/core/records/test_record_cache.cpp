// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The cache of records: fields that interpolation must reproduce, what it must refuse, lookups that find every record
// which a walk through all of them finds, and radii that neighbours clamp.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "hemisphere/hemisphere.h"
#include "records/record_cache.h"
#include "methods/irradiance_cache/irradiance_cache.h"
#include "leaning_normal.h"

using namespace eclat;

namespace {

// A field of irradiance that is linear in position and, for small turns, in the normal.
const Vec3 slope{0.7f, -0.4f, 0};
const Vec3 lean{0.5f, 0.3f, 0};
float field(Vec3 p, Vec3 n) { return 5 + dot(slope, p) + dot(lean, n); }

IrradianceRecord record_at(Vec3 p, Vec3 n, float radius) {
    IrradianceRecord r;
    r.position = p;
    r.normal = n;
    r.irradiance = Color(field(p, n), 2 * field(p, n), 1);
    // dE = lean · (n' − n) = (n × n') · (n × lean), since n' − n is at right angles to n.
    for (int c = 0; c < 2; ++c) {
        r.translation.channel[c] = slope * float(c + 1);
        r.rotation.channel[c] = cross(n, lean) * float(c + 1);
    }
    r.distance = r.radius = r.largest_radius = radius;
    r.least_radius = radius;
    r.clearance.fill(infinity);
    return r;
}

std::vector<IrradianceRecord> scattered(int count, float degrees) {
    Rng rng(31, 1);
    std::vector<IrradianceRecord> out;
    for (int i = 0; i < count; ++i) {
        const Vec3 p{4 * rng.next(), 4 * rng.next(), 0.02f * rng.next()};
        // Radii over two orders of magnitude: what a tree of one size would miss.
        out.push_back(record_at(p, leaning(rng, degrees), 0.02f * std::pow(100.0f, rng.next())));
    }
    return out;
}

RecordCache cache_of(const std::vector<IrradianceRecord>& records, CacheOptions options) {
    options.neighbor_clamping = false;
    RecordCache cache(options);
    // In two parts, as passes do it.
    const auto middle = records.size() / 2;
    cache.insert(std::span(records).first(middle), 1, 1);
    cache.insert(std::span(records).subspan(middle), 1, 1);
    return cache;
}

constexpr float spacing = 0.5f;

IrradianceRecord bare_record(Vec3 position, float distance, Color E, Vec3 normal = {0, 0, 1}) {
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
        out.push_back(bare_record(p, 0.4f + 0.4f * rng.next(), Color(linear_field(p))));
        out.back().translation.channel.fill({0.3f, -0.2f, 0});
    }
    return out;
}

}  // namespace

TEST_CASE("a linear field is reproduced, in position and normal, under both weights") {
    for (const Weight weight : {Weight::tabellion, Weight::ward}) {
        const RecordCache cache = cache_of(scattered(300, 4), {.weight = weight});
        Rng rng(32, 1);
        int served = 0;
        for (int i = 0; i < 2000; ++i) {
            const Vec3 p{4 * rng.next(), 4 * rng.next(), 0.02f * rng.next()};
            const Vec3 n = leaning(rng, 4), shading = leaning(rng, 8);  // as a bump would turn it
            const auto E = cache.interpolate(p, n, shading);
            if (!E) continue;
            ++served;
            // Normals are unit vectors, so that they are linear to the square of 12 degrees only. A bend loses what lies below
            // the shading normal.
            const float even = 0.5f * (1 + dot(n, shading));
            CHECK(E->r == doctest::Approx(even * field(p, shading)).epsilon(0.006));
            CHECK(E->g == doctest::Approx(2 * even * field(p, shading)).epsilon(0.006));
            CHECK(E->b == doctest::Approx(even).epsilon(1e-6));
        }
        CHECK(served > 1500);
    }
}

TEST_CASE("without gradients a cache is a weighted mean of its records' values") {
    const auto records = scattered(300, 4);
    const RecordCache cache = cache_of(records, {.rotation_gradient = false, .translation_gradient = false});
    const auto [low, high] = std::minmax_element(
        records.begin(), records.end(), [](const auto& a, const auto& b) { return a.irradiance.r < b.irradiance.r; });
    Rng rng(33, 1);
    for (int i = 0; i < 500; ++i) {
        const auto E = cache.interpolate({4 * rng.next(), 4 * rng.next(), 0}, {0, 0, 1}, {0, 0, 1});
        if (!E) continue;
        CHECK(E->r >= low->irradiance.r);
        CHECK(E->r <= high->irradiance.r);
    }
}

TEST_CASE("a lookup finds every record that reaches the point") {
    const auto records = scattered(500, 12);
    for (const Weight kind : {Weight::tabellion, Weight::ward})
        for (const float relaxation : {1.0f, 1.5f, 2.5f}) {
            CAPTURE(relaxation);
            const RecordCache cache = cache_of(records, {.weight = kind, .relaxation = relaxation});
            Rng rng(34, 1);
            for (int i = 0; i < 1000; ++i) {
                const Vec3 p{4 * rng.next(), 4 * rng.next(), 0.02f * rng.next()}, n = leaning(rng, 12);
                double weights = 0, strict = 0, radii = 0;
                for (const IrradianceRecord& r : records) {
                    const Footing footing{r.position, r.radius, r.normal, infinity};
                    const float w = weight(footing, p, n, kind, relaxation);
                    weights += w;
                    radii += w * r.radius;
                    strict += weight(footing, p, n, kind, 1);
                }
                float mean_radius = 0;
                CHECK(cache.interpolate(p, n, n, &mean_radius).has_value() == (weights > 0));
                if (weights > 0) CHECK(mean_radius == doctest::Approx(radii / weights).epsilon(1e-4));
                CHECK(cache.serves(p, n) == (strict > 0));
                CHECK(cache.density(p, n) == doctest::Approx(strict).epsilon(1e-4));
            }
        }
}

TEST_CASE("extrapolation is bounded below and above") {
    IrradianceRecord r = record_at({0, 0, 0}, {0, 0, 1}, 1);
    r.irradiance = Color(1.0f);
    r.translation.channel = {Vec3{100, 0, 0}, Vec3{-100, 0, 0}, Vec3{1, 0, 0}};
    const RecordCache cache = cache_of({r, r}, {});
    const auto E = cache.interpolate({0.5f, 0, 0}, {0, 0, 1}, {0, 0, 1});
    REQUIRE(E);
    CHECK(E->r == doctest::Approx(20));
    CHECK(E->g == doctest::Approx(0.05));
    CHECK(E->b == doctest::Approx(1.5));
    std::vector<IrradianceRecord> records{bare_record({}, 2, Color(1))};
    records[0].translation.channel.fill({-1000, 0, 0});
    RecordCache single;
    single.insert(records, spacing, 1);
    CHECK(single.interpolate({0.5f, 0, 0}, {0, 0, 1}, {0, 0, 1})->r == doctest::Approx(0.05f));
    CHECK(single.interpolate({-0.5f, 0, 0}, {0, 0, 1}, {0, 0, 1})->r == doctest::Approx(20));
}

TEST_CASE("clamped radii change no faster than distance, in any order of insertion") {
    std::vector<IrradianceRecord> records = scattered(200, 0);
    for (IrradianceRecord& r : records) r.least_radius = 0, r.largest_radius = infinity;
    const auto clamped = [](const std::vector<IrradianceRecord>& in) {
        RecordCache cache{CacheOptions{}};
        cache.insert(std::span(in).first(50), 0.5f, 1);
        cache.insert(std::span(in).subspan(50), 0.5f, 1);
        return cache;
    };
    const RecordCache cache = clamped(records);
    std::reverse(records.begin(), records.end());
    const RecordCache reversed = clamped(records);
    int shrunk = 0;
    const auto& out = cache.records();
    for (size_t i = 0; i < out.size(); ++i) {
        shrunk += out[i].radius < 0.499f * out[i].distance;
        CHECK(out[i].radius == reversed.records()[out.size() - 1 - i].radius);
        for (const IrradianceRecord& other : out)
            CHECK_FALSE(out[i].radius > (other.radius + 0.5f * length(out[i].position - other.position)) * 1.00001f);
    }
    CHECK(shrunk > 50);
}

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
            worst_without = std::max(
                worst_without, double(std::abs(without.interpolate(p, {0, 0, 1}, {0, 0, 1})->g - linear_field(p))));
        }
    CHECK(served > 150);
    CHECK(worst_without > 1e-2);
}

TEST_CASE("a field that bends is read without bias amid its records") {
    // On a regular lattice the ways to the records around a point nearly cancel, and a quadratic field is reproduced but for the
    // square of the mean way. By tangents alone it would be read 0.029 too high.
    const auto bent = [](Vec3 p) { return 3 + 0.2f * p.x - 0.5f * p.x * p.x - 0.3f * p.y * p.y + 0.2f * p.x * p.y; };
    std::vector<IrradianceRecord> records;
    for (float x = -2; x <= 2; x += 0.2f)
        for (float y = -2; y <= 2; y += 0.2f) {
            IrradianceRecord r = bare_record({x, y, 0}, 0.6f, Color(bent({x, y, 0})));
            for (Vec3& channel : r.translation.channel) channel = {0.2f - x + 0.2f * y, -0.6f * y + 0.2f * x, 0};
            records.push_back(r);
        }
    RecordCache cache;
    cache.insert(records, spacing, 1);
    double error = 0, worst = 0;
    int count = 0;
    for (float x = -0.9f; x < 0.9f; x += 0.07f)
        for (float y = -0.9f; y < 0.9f; y += 0.07f, ++count) {
            const auto E = cache.interpolate({x, y, 0}, {0, 0, 1}, {0, 0, 1});
            REQUIRE(E);
            error += double(E->g - bent({x, y, 0}));
            worst = std::max(worst, std::abs(double(E->g - bent({x, y, 0}))));
        }
    CHECK(std::abs(error / count) < 1e-4);
    CHECK(worst < 1e-3);
}

TEST_CASE("the rotation gradient answers to a turned normal") {
    // E falls by 0.5 per radian of turn about +y.
    std::vector<IrradianceRecord> records{bare_record({}, 2, Color(3))};
    records[0].rotation.channel.fill({0, -0.5f, 0});
    RecordCache cache;
    cache.insert(records, spacing, 1);
    const float a = 0.1f;
    const Vec3 n{std::sin(a), 0, std::cos(a)};  // turned about +y
    CHECK(cache.interpolate({}, n, n)->r == doctest::Approx(3 - 0.5f * std::sin(a)).epsilon(1e-5));
}

TEST_CASE("a bump bends irradiance as the integral over what lies above both normals") {
    // Radiance 1 + 0.8 x over the hemisphere of z: E = π, and ∫ x (1 + 0.8 x) = 0.8 · 2π / 3 is the gradient.
    const float slope = 0.8f;
    std::vector<IrradianceRecord> records{bare_record({}, 2, Color(pi))};
    records[0].rotation.channel.fill({0, slope * 2 * pi / 3, 0});
    RecordCache cache;
    cache.insert(records, spacing, 1);
    for (const float a : {-1.5f, -1.0f, -0.3f, 0.2f, 0.6f, 1.0f, 1.4f}) {
        CAPTURE(a);
        const Vec3 bump{std::sin(a), 0, std::cos(a)};
        double sum = 0;
        constexpr int rows = 400, columns = 800;
        for (int i = 0; i < rows; ++i)
            for (int k = 0; k < columns; ++k) {
                const double z = (i + 0.5) / rows, s = std::sqrt(1 - z * z), phi = 2 * M_PI * (k + 0.5) / columns;
                const Vec3 w{float(s * std::cos(phi)), float(s * std::sin(phi)), float(z)};
                sum += std::max(0.0f, dot(w, bump)) * (1 + slope * w.x);
            }
        CHECK(cache.interpolate({}, {0, 0, 1}, bump)->r ==
              doctest::Approx(sum * 2 * M_PI / (rows * columns)).epsilon(1e-3));
    }
}

TEST_CASE("a point that no record reaches is a miss and not dark") {
    RecordCache cache;
    CHECK_FALSE(cache.interpolate({}, {0, 0, 1}, {0, 0, 1}).has_value());
    const std::vector<IrradianceRecord> records{bare_record({}, 2, Color(1))};
    cache.insert(records, spacing, 1);
    CHECK(cache.interpolate({}, {0, 0, 1}, {0, 0, 1}).has_value());
    CHECK_FALSE(cache.interpolate({5, 0, 0}, {0, 0, 1}, {0, 0, 1}).has_value());
    CHECK_FALSE(cache.interpolate({}, {0, 0, -1}, {0, 0, -1}).has_value());
}

TEST_CASE("records are placed by a strict test and read by a relaxed one") {
    RecordCache cache;
    const std::vector<IrradianceRecord> records{bare_record({}, 2, Color(1))};
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
        records.push_back(bare_record({x, y, 0}, 0.01f + 2 * rng.next(), Color(1)));
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

TEST_CASE("records on both sides of a sheet leave each other their radii") {
    RecordCache cache;
    const IrradianceRecord front = bare_record({0, 0, 0}, 0.1f, Color(1));
    IrradianceRecord back = bare_record({0.05f, 0, 0}, 2, Color(1));
    back.normal = {0, 0, -1};
    cache.insert(std::vector{front, back}, spacing, 1);
    CHECK(cache.records()[1].radius == doctest::Approx(spacing * 2));
}

TEST_CASE("records disagree by chance where few rays brought the light of one and none that of the other") {
    std::vector<IrradianceRecord> records;
    for (float x : {0.0f, 0.3f}) records.push_back(bare_record({x, 0, 0}, 1, Color(0)));
    records[0].excess = Color(1);
    records[0].excess_noise = 1;
    records[0].own_noise = 0.35f;
    RecordCache cache;
    cache.insert(records, spacing, 1);
    CHECK(cache.shrink_where_records_disagree(0.02f, spacing, 1) == 0);
}

TEST_CASE("the worse of two records that disagree shrinks until its error is the tolerated one") {
    // E = 1 + x²: each knows its value and slope, so both err by the square of the distance; relative to what is there, that
    // is more where it is darker.
    const auto parabola = [](float x) {
        IrradianceRecord r = bare_record({x, 0, 0}, 2, Color(1 + x * x));
        r.largest_radius = r.radius;
        r.translation.channel.fill({2 * x, 0, 0});
        return r;
    };
    const auto shrunk = [&](std::vector<IrradianceRecord> records, float tolerance, float own_noise) {
        for (auto& r : records) r.own_noise = own_noise;
        RecordCache cache(CacheOptions{.neighbor_clamping = false});
        cache.insert(records, spacing, 1);
        const size_t count = cache.shrink_where_records_disagree(tolerance, spacing, 2);
        std::vector<float> radii{static_cast<float>(count)};
        for (const auto& r : cache.records()) radii.push_back(r.radius);
        return radii;
    };
    const float mean = 0.5f * (1 + 1.36f), unit = std::sqrt(1 + 0.01f * mean * mean);
    const auto two = shrunk({parabola(0), parabola(0.6f)}, 0.1f, 0);
    CHECK(two[0] == 1);
    CHECK(two[1] == 1);
    CHECK(two[2] == doctest::Approx(std::sqrt(0.1 * unit)).epsilon(1e-5));  // there x² is a tenth
    // What noise explains shrinks nobody, nor do records that agree or are tolerated to differ.
    CHECK(shrunk({parabola(0), parabola(0.6f)}, 0.1f, 0.2f)[0] == 0);
    CHECK(shrunk({parabola(0), parabola(0.6f)}, 0.4f, 0)[0] == 0);
    CHECK(shrunk({parabola(0), parabola(2.1f)}, 0.1f, 0)[0] == 0);  // out of reach
    const auto linear = shrunk(linear_records(), 0.001f, 0);
    CHECK(linear[0] == 0);
}

TEST_CASE("a record in a solid keeps others away, is not read and clamps nobody") {
    std::vector<IrradianceRecord> records{bare_record({}, 2, Color(1)), bare_record({0.5f, 0, 0}, 0.1f, Color(9))};
    records[1].enclosed = 1;
    RecordCache cache;
    records[0].largest_radius = 10;
    cache.insert(records, spacing, 1);
    CHECK(cache.interpolate({0.5f, 0, 0}, {0, 0, 1}, {0, 0, 1})->g == doctest::Approx(1));
    CHECK(cache.records()[0].radius == doctest::Approx(1));
    CHECK(cache.mean_luminance() == doctest::Approx(1));
    RecordCache alone;
    alone.insert(std::span(records).subspan(1), spacing, 1);
    CHECK(alone.serves({0.5f, 0, 0}, {0, 0, 1}));
    CHECK_FALSE(alone.interpolate({0.5f, 0, 0}, {0, 0, 1}, {0, 0, 1}).has_value());
}

TEST_CASE("a wall beside a record ends its validity in that direction only") {
    std::vector<IrradianceRecord> records{bare_record({}, 4, Color(1))};
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

TEST_CASE("the excess is read as a mean over neighbouring records") {
    const Vec3 up{0, 0, 1};
    const auto with_excess = [](Vec3 p, float excess, Vec3 normal) {
        IrradianceRecord r = bare_record(p, 1, Color(1), normal);
        r.least_radius = r.largest_radius = r.radius;
        r.excess = Color(excess);
        r.excess_noise = 1;
        return r;
    };
    const auto read = [&](const std::vector<IrradianceRecord>& records, Vec3 at) {
        RecordCache cache;
        cache.insert(records, spacing, 2);
        return cache.interpolate(at, up, up)->g;
    };
    CHECK(read({with_excess({}, 3, up)}, {}) == doctest::Approx(4));  // alone, all its own
    CHECK(read({with_excess({}, 3, up), with_excess({}, 0, up)}, {}) == doctest::Approx(2.5));
    // Two radii away it is shared though not interpolated; beyond four, on another side or behind a wall it is not.
    const float near = read({with_excess({}, 3, up), with_excess({1, 0, 0}, 0, up)}, {});
    CHECK(near > 2.5f);
    CHECK(near < 3.9f);
    CHECK(read({with_excess({}, 3, up), with_excess({2.1f, 0, 0}, 0, up)}, {}) == doctest::Approx(4));
    CHECK(read({with_excess({}, 3, up), with_excess({}, 0, -up)}, {}) == doctest::Approx(4));
    IrradianceRecord walled = with_excess({1, 0, 0}, 0, up);
    walled.clearance[clearance_sector(Frame::around(up), {-1, 0, 0})] = 0.5f;
    CHECK(read({with_excess({}, 3, up), walled}, {}) == doctest::Approx(4));
    // Over many equal records the sum stays: noise of one becomes a little of all.
    std::vector<IrradianceRecord> many;
    for (int x = 0; x < 24; ++x)
        for (int y = 0; y < 24; ++y)
            many.push_back(with_excess({0.4f * float(x), 0.4f * float(y), 0}, x == 12 && y == 12 ? 100.0f : 0, up));
    double sum = 0;
    float largest = 0;
    for (const IrradianceRecord& r : many) {
        const float excess = read(many, r.position) - 1;
        sum += excess;
        largest = std::max(largest, excess);
    }
    CHECK(sum == doctest::Approx(100).epsilon(0.01));
    CHECK(largest < 15);
}

TEST_CASE("excess that rises evenly is shared without a change, where radii do, too") {
    const Vec3 up{0, 0, 1};
    std::vector<IrradianceRecord> records;
    for (int x = 0; x < 25; ++x)
        for (int y = 0; y < 25; ++y) {
            const Vec3 p{0.4f * static_cast<float>(x), 0.4f * static_cast<float>(y), 0};
            IrradianceRecord r = bare_record(p, x < 12 ? 0.5f : 2, Color(1), up);
            r.least_radius = r.largest_radius = r.radius;
            r.excess = Color(1 + p.x);
            r.excess_noise = 1;
            records.push_back(r);
        }
    RecordCache cache;
    cache.insert(records, spacing, 2);
    // The mean would lie on the side of the wide records, whose neighbourhoods reach into the narrow ones.
    const uint32_t narrow = 11 * 25 + 12;
    CHECK(cache.shared_excess(narrow).g == doctest::Approx(1 + records[narrow].position.x).epsilon(0.05).scale(0));
}

TEST_CASE("irradiance is never below 0 beside a steep excess") {
    const Vec3 up{0, 0, 1};
    std::vector<IrradianceRecord> records;
    for (int x = 0; x < 12; ++x)
        for (int y = 0; y < 25; ++y) {
            IrradianceRecord r =
                bare_record({0.4f * static_cast<float>(x), 0.4f * static_cast<float>(y), 0}, 1, Color(1e-3f), up);
            r.least_radius = r.largest_radius = r.radius;
            r.excess = Color(x < 3 ? 0.0f : static_cast<float>(x * x));
            r.excess_noise = 1;
            records.push_back(r);
        }
    RecordCache cache;
    cache.insert(records, spacing, 2);
    float least = infinity;
    for (uint32_t i = 0; i < records.size(); ++i) {
        least = std::min(least, cache.shared_excess(i).g);
        CHECK(cache.interpolate(records[i].position, up, up)->g >= 0);
    }
    CHECK(least < -0.1f);  // the plane through the excess is
}

TEST_CASE(
    "a view is tried at each pixel once, at fewer where records are larger than pixels, at more where they may be "
    "smaller") {
    Camera camera;
    camera.width = 13, camera.height = 9;
    const auto tried = [&](float least_pixels) {
        IrradianceCacheOptions options;
        options.least_pixels = least_pixels;
        std::vector<std::pair<float, float>> all;
        for_each_lattice({&camera, 1}, options, [&](size_t, std::span<const Vec2> places, float) {
            for (Vec2 at : places) all.emplace_back(at.x, at.y);
        });
        std::sort(all.begin(), all.end());
        CHECK(std::adjacent_find(all.begin(), all.end()) == all.end());
        for (const auto& [x, y] : all) CHECK((x > 0 && x < 13 && y > 0 && y < 9));
        return all.size();
    };
    CHECK(tried(4) == 4 * 3);
    CHECK(tried(3.9f) == 7 * 5);
    CHECK(tried(2) == 7 * 5);
    CHECK(tried(1) == 13 * 9);
    // From the first centre to less than half a pixel beyond the last.
    CHECK(tried(0.5f) == 25 * 17);
    CHECK(tried(0.3f) == 50 * 34);
}
