// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The cache of records: weights that end at zero and know no unit, fields that are linear, and lookups that find every
// record which a walk through all of them finds.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "cache/irradiance_cache.h"
#include "sampling/rng.h"
#include "sampling/warp.h"

using namespace eclat;

namespace {

/// A normal that leans against +z by up to `degrees`.
Vec3 leaning(Rng& rng, float degrees) {
    const float u = rng.next(), v = rng.next();
    return square_to_uniform_cone({u, v}, 1 - std::cos(degrees * pi / 180));
}

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
            // Normals are unit vectors, so that they are linear to the square of 12 degrees only.
            CHECK(E->r == doctest::Approx(field(p, shading)).epsilon(0.004));
            CHECK(E->g == doctest::Approx(2 * field(p, shading)).epsilon(0.004));
            CHECK(E->b == doctest::Approx(1).epsilon(1e-6));
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

TEST_CASE("a weight falls to zero at the border of validity, in position, height and normal") {
    const Vec3 up{0, 0, 1};
    const Footing record{{1, 2, 3}, 0.5f, up, infinity};
    for (const Weight kind : {Weight::tabellion, Weight::ward})
        for (const float relaxation : {1.0f, 1.5f}) {
            const auto at = [&](Vec3 d, Vec3 n) { return weight(record, record.position + d, n, kind, relaxation); };
            const float reach = 0.5f * relaxation;
            CHECK(at({}, up) >= at({0.1f * reach, 0, 0}, up));
            CHECK(at({0.1f * reach, 0, 0}, up) > at({0.5f * reach, 0, 0}, up));
            CHECK(at({0.999f * reach, 0, 0}, up) > 0);
            CHECK(at({0.999f * reach, 0, 0}, up) < 2e-3f);
            CHECK(at({1.001f * reach, 0, 0}, up) == 0);
            // Behind and before alike: nothing that is not nearly in the plane.
            for (const float side : {-1.0f, 1.0f}) {
                CHECK(at({0, 0, side * 0.2f * reach}, up) > 0);
                CHECK(at({0, 0, side * 0.3f * reach}, up) == 0);
            }
            const auto turned = [&](float degrees) {
                const float a = degrees * pi / 180;
                return at({}, {std::sin(a), 0, std::cos(a)});
            };
            CHECK(turned(5) > 0);
            CHECK(turned(9.99f * relaxation) < 0.01f);
            CHECK(turned(10.2f * relaxation) == 0);
            CHECK(turned(180) == 0);
        }
}

TEST_CASE("weights know no unit of length") {
    Rng rng(35, 1);
    for (const float scale : {0x1p-20f, 0x1p20f, 1000.0f, 0.001f})
        for (int i = 0; i < 300; ++i) {
            const Footing record{{rng.next(), rng.next(), rng.next()}, 0.5f, leaning(rng, 20), infinity};
            const Vec3 p = record.position + Vec3{rng.next() - 0.5f, rng.next() - 0.5f, 0.2f * (rng.next() - 0.5f)},
                       n = leaning(rng, 20);
            const Footing scaled{record.position * scale, record.radius * scale, record.normal, infinity};
            for (const Weight kind : {Weight::tabellion, Weight::ward})
                CHECK(weight(scaled, p * scale, n, kind, 1.3f) ==
                      doctest::Approx(weight(record, p, n, kind, 1.3f)).epsilon(1e-3).scale(1e-3));
        }
}

TEST_CASE("extrapolation stops short of darkness and of twenty times the value") {
    IrradianceRecord r = record_at({0, 0, 0}, {0, 0, 1}, 1);
    r.irradiance = Color(1.0f);
    r.translation.channel = {Vec3{100, 0, 0}, Vec3{-100, 0, 0}, Vec3{1, 0, 0}};
    const RecordCache cache = cache_of({r, r}, {});
    const auto E = cache.interpolate({0.5f, 0, 0}, {0, 0, 1}, {0, 0, 1});
    REQUIRE(E);
    CHECK(E->r == doctest::Approx(20));
    CHECK(E->g == doctest::Approx(0.05));
    CHECK(E->b == doctest::Approx(1.5));
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
