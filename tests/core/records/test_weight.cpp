// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The two weights by their defining properties; angles and distances in closed form.

#include <doctest/doctest.h>

#include <cmath>

#include "base/frame.h"
#include "records/weight.h"
#include "sampling/rng.h"
#include "sampling/warp.h"
#include "leaning_normal.h"

using namespace eclat;

namespace {

constexpr Weight both[] = {Weight::tabellion, Weight::ward};

Footing record(float radius = 2) { return {{1, 2, 3}, radius, {0, 0, 1}, infinity}; }

Vec3 beside(float x) { return Vec3{1, 2, 3} + Vec3{x, 0, 0}; }
Vec3 tilted(double degrees) {
    const double a = degrees * 3.14159265358979 / 180;
    return {static_cast<float>(std::sin(a)), 0, static_cast<float>(std::cos(a))};
}

}  // namespace

TEST_CASE("a weight falls from the record to nothing at its radius, without a step") {
    for (Weight kind : both) {
        const Footing r = record();
        float last = weight(r, beside(0), r.normal, kind, 1);
        CHECK(last > 0);
        for (float x = 0.02f; x < 2; x += 0.02f) {
            const float w = weight(r, beside(x), r.normal, kind, 1);
            CHECK(w < last);
            last = w;
        }
        CHECK(weight(r, beside(1.9999f), r.normal, kind, 1) < 1e-3f);
        CHECK(weight(r, beside(1.9999f), r.normal, kind, 1) > 0);
        CHECK(weight(r, beside(2), r.normal, kind, 1) == 0);
    }
    CHECK(weight(record(), beside(0), {0, 0, 1}, Weight::tabellion, 1) == 1);
}

TEST_CASE("a normal that differs by 10° ends the validity") {
    for (Weight kind : both) {
        CHECK(weight(record(), beside(0), tilted(9.9), kind, 1) > 0);
        CHECK(weight(record(), beside(0), tilted(10.1), kind, 1) == 0);
        CHECK(weight(record(), beside(0), tilted(3), kind, 1) > weight(record(), beside(0), tilted(6), kind, 1));
        CHECK(weight(record(), beside(0), {0, 0, -1}, kind, 1) == 0);
    }
}

TEST_CASE("the split sphere as published: one error of distance and turn, and only what lies behind is refused") {
    Footing r = record();  // radius 2 = a R
    r.tolerance = 0.4f;    // a, so R = 5
    const auto published = [&](Vec3 p, Vec3 n) {
        const float e = length(p - r.position) / 5 + std::sqrt(1 - n.z);
        return e < 0.4f ? 0.4f / e - 1 : 0;
    };
    for (const double degrees : {0.0, 10.0, 20.0, 30.0})
        for (const float x : {0.1f, 0.5f, 1.0f, 1.9f}) {
            const Vec3 n = tilted(degrees);  // away from the record: not behind it
            CHECK(weight(r, beside(x), n, Weight::split_sphere, 1) ==
                  doctest::Approx(published(beside(x), n)).epsilon(1e-4));
        }
    CHECK(weight(r, beside(1) + Vec3{0, 0, 0.3f}, r.normal, Weight::split_sphere, 1) > 0);
    CHECK(weight(r, beside(1) - Vec3{0, 0, 0.3f}, r.normal, Weight::split_sphere, 1) == 0);
}

TEST_CASE("relaxation widens the radius and the tolerated turn") {
    for (Weight kind : both) {
        CHECK(weight(record(), beside(2.9f), {0, 0, 1}, kind, 1.5f) > 0);
        CHECK(weight(record(), beside(3.01f), {0, 0, 1}, kind, 1.5f) == 0);
        // 0.2 rad is the most.
        for (float relaxation : {1.5f, 3.0f}) {
            CHECK(weight(record(), beside(0), tilted(11.4), kind, relaxation) > 0);
            CHECK(weight(record(), beside(0), tilted(11.6), kind, relaxation) == 0);
        }
    }
}

TEST_CASE("points off the record's plane are not served, in front or behind") {
    for (Weight kind : both)
        for (float side : {-1.0f, 1.0f}) {
            CHECK(weight(record(), Vec3{1, 2, 3 + side * 0.02f}, {0, 0, 1}, kind, 1) > 0);
            CHECK(weight(record(), Vec3{1, 2, 3 + side * 0.04f}, {0, 0, 1}, kind, 1) == 0);
        }
}

TEST_CASE("the plane follows a curved surface, and an edge between two facets") {
    for (Weight kind : both)
        for (float degrees : {3.0f, 6.0f, 9.0f}) {
            // On a sphere of radius 2 / 3 the chord leaves the tangent plane by degrees / 2, the mean plane not at all.
            const float a = degrees * pi / 180, sphere = 2 / 3.0f;
            const Vec3 n{std::sin(a), 0, std::cos(a)};
            CHECK(weight(record(), Vec3{1, 2, 3} + (n - Vec3{0, 0, 1}) * sphere, n, kind, 1) > 0);
            // The record lies at the edge, the point down the next facet.
            const Vec3 down = Vec3{std::cos(a), 0, -std::sin(a)} * 0.15f;
            CHECK(weight(record(), Vec3{1, 2, 3} + down, n, kind, 1) > 0);
            CHECK(weight(record(), Vec3{1, 2, 3} + down + Vec3{0, 0, -0.15f}, n, kind, 1) == 0);
        }
}

TEST_CASE("the unit of length does not matter") {
    for (Weight kind : both)
        for (float scale : {0x1p-10f, 0x1p10f}) {
            const Footing small{{0, 0, 0}, 2, {0, 0, 1}, infinity}, large{{0, 0, 0}, 2 * scale, {0, 0, 1}, infinity};
            const Vec3 p{0.7f, -0.4f, 0.02f};
            const float w = weight(small, p, tilted(4), kind, 1);
            CHECK(w > 0);
            CHECK(weight(large, p * scale, tilted(4), kind, 1) == w);
        }
}

TEST_CASE("the distance, height and angle at which a weight ends increase with the relaxation") {
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
                CHECK(at({0, 0, side * 0.0074f}, up) > 0);
                CHECK(at({0, 0, side * 0.0076f}, up) == 0);
            }
            const auto turned = [&](float degrees) {
                const float a = degrees * pi / 180;
                return at({}, {std::sin(a), 0, std::cos(a)});
            };
            CHECK(turned(5) > 0);
            const float widest = relaxation == 1 ? 10 : 11.46f;
            CHECK(turned(0.999f * widest) < 0.01f);
            CHECK(turned(1.02f * widest) == 0);
            CHECK(turned(180) == 0);
        }
}

TEST_CASE("the unit of length does not matter at any place and turn") {
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

TEST_CASE("an ellipse: validity ends at its own radius along each axis, and at the small one off the plane") {
    // Twice as long along y.
    const Footing long_record{{1, 2, 3}, 0.5f, {0, 0, 1}, infinity, Vec3{0, std::sqrt(0.75f), 0}};
    for (const Weight kind : both) {
        const auto at = [&](Vec3 d) { return weight(long_record, long_record.position + d, {0, 0, 1}, kind, 1); };
        CHECK(at({0.499f, 0, 0}) > 0);
        CHECK(at({0.501f, 0, 0}) == 0);
        CHECK(at({0, 0.998f, 0}) > 0);
        CHECK(at({0, 1.002f, 0}) == 0);
        CHECK(at({0.2f, 0, 0}) == doctest::Approx(at({0, 0.4f, 0})).epsilon(1e-4));
        CHECK(at({0, 0, 0.0074f}) > 0);
        CHECK(at({0, 0, 0.0076f}) == 0);
    }
}

TEST_CASE("no record is read farther from its plane than lookups search, and eight weights at once are those of each") {
    Rng rng(5, 0);
    Footings footings;
    int read = 0;
    for (int round = 0; round < 20000; ++round) {
        const auto direction = [&] {
            const float u = rng.next();
            return square_to_uniform_sphere({u, rng.next()});
        };
        const Vec3 normal = direction();
        const float elongation = 1 + rng.next();
        Footing footing{direction(), 0.5f + rng.next(), normal, infinity};
        footing.stretch = Frame::around(normal).u * safe_sqrt(1 - 1 / sqr(elongation));
        footing.tolerance = 0.3f;
        const uint32_t lane = static_cast<uint32_t>(round) % Footings::count;
        footings.set(lane, footing);
        const float relaxation = 1 + 2 * rng.next();
        const Vec3 n = normalize(normal + direction() * (0.25f * rng.next()));
        // Near the plane, where weights begin to end.
        const Vec3 along = direction();
        const Vec3 p = footing.position + (along - normal * (dot(along, normal) * (1 - 0.3f * rng.next()))) *
                                              (footing.radius * relaxation * elongation * rng.next());
        for (Weight kind : {Weight::tabellion, Weight::ward, Weight::split_sphere}) {
            float weights[Footings::count];
            footings.weights(p, n, kind, relaxation, weights);
            const float w = weight(footing, p, n, kind, relaxation);
            REQUIRE(weights[lane] == w);
            if (w == 0) continue;
            ++read;
            const float reach = footing.radius * relaxation * elongation;
            CHECK(std::fabs(dot(p - footing.position, normal)) <= height_read(footing.radius, reach, kind));
        }
    }
    CHECK(read > 10000);  // the comparison is not of nothing with nothing
}
