// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "records/estimated_error.h"

#include <doctest/doctest.h>

using namespace eclat;

namespace {

constexpr Vec3 up{0, 0, 1};

/// A record of a field that bends by the curvature along both axes, without noise.
IrradianceRecord record(Vec3 position, float curvature, float noise = 0) {
    IrradianceRecord r;
    r.position = position;
    r.normal = up;
    r.irradiance = Color(2);
    r.distance = r.radius = 1;
    r.curvature = curvature;
    r.own_noise = noise;
    r.clearance.fill(infinity);
    return r;
}

RecordCache cache_of(std::initializer_list<IrradianceRecord> records) {
    RecordCache cache;
    cache.insert(std::vector<IrradianceRecord>(records), 1, 1);
    return cache;
}

/// Y(E) of the records above, with the floor of the measure of error.
const float judged = std::sqrt(sqr(2.0f) + sqr(0.2f));

}  // namespace

TEST_CASE(
    "the estimated error is what extrapolation leaves out: half of the curvature times the square of the distance") {
    const RecordCache cache = cache_of({record({}, 3)});
    CHECK(*estimated_error(cache, {}, up) == 0);
    CHECK(*estimated_error(cache, {0.5f, 0, 0}, up) == doctest::Approx(0.5 * 3 * 0.25 / judged));
    CHECK(!estimated_error(cache, {5, 0, 0}, up));
}

TEST_CASE("along the long axis of its ellipse, a record errs as much only farther away") {
    IrradianceRecord r = record({}, 3);
    r.elongation = 2;
    const Frame frame = Frame::around(up);
    const RecordCache cache = cache_of({r});
    const float along = *estimated_error(cache, frame.u * 0.8f, up),
                across = *estimated_error(cache, frame.v * 0.4f, up);
    CHECK(along == doctest::Approx(across));
}

TEST_CASE("noise counts relative to the light, and many records have less of it") {
    const float one = *estimated_error(cache_of({record({}, 0, 0.1f)}), {}, up);
    CHECK(one == doctest::Approx(0.1 * 2 / judged));
    const float four = *estimated_error(
        cache_of({record({}, 0, 0.1f), record({}, 0, 0.1f), record({}, 0, 0.1f), record({}, 0, 0.1f)}), {}, up);
    CHECK(four == doctest::Approx(one / 2));
    IrradianceRecord bright = record({}, 0, 0.1f);
    bright.excess = Color(2);
    CHECK(*estimated_error(cache_of({bright}), {}, up) == doctest::Approx(0.1 * 4 / std::sqrt(16 + 0.04)));
}

TEST_CASE("a cache without light has no error") {
    IrradianceRecord dark = record({}, 0);
    dark.irradiance = {};
    CHECK(*estimated_error(cache_of({dark}), {}, up) == 0);
}
