// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// What gathers aim at: densities that integrate to 1 and are those of the directions drawn, and which places are kept.

#include "records/bright_places.h"

#include <doctest/doctest.h>

#include <vector>

#include "sampling/rng.h"
#include "sampling/warp.h"

using namespace eclat;

namespace {

const Vec3 up{0, 0, 1};

BrightPlaces three_places() {
    BrightPlaces places;
    // Two of them so close together that their cones overlap.
    const std::vector<Sighting> sightings{
        {{1.05f, 0.05f, 2.05f}, 3, 6}, {{1.15f, 0.05f, 2.05f}, 1, 6}, {{-2.05f, 1.05f, 0.55f}, 5, 6}};
    places.add(sightings);
    return places;
}

}  // namespace

TEST_CASE("the density of aimed directions integrates to 1 and is what they have") {
    const AimedCones cones = three_places().seen_from({}, up);
    REQUIRE_FALSE(cones.empty());
    Rng rng(41, 1);
    // 1 / pdf averages to the solid angle of the cones' union, however chances are shared; by even directions as well.
    int outside = 0;
    double from_cones = 0, even = 0, integral = 0;
    constexpr int count = 400000;
    for (int i = 0; i < count; ++i) {
        const Vec3 w = cones.sample(rng.next(), {rng.next(), rng.next()});
        const float drawn = cones.pdf_solid_angle(w);
        outside += !(drawn > 0);  // by rounding, at a rim
        if (drawn > 0) from_cones += 1 / drawn / count;
        const float pdf = cones.pdf_solid_angle(square_to_uniform_sphere({rng.next(), rng.next()}));
        even += (pdf > 0 ? 4 * pi : 0.0) / count;
        integral += pdf * 4 * pi / count;
    }
    CHECK(outside < count / 10000);
    CHECK(integral == doctest::Approx(1).epsilon(0.08));
    CHECK(from_cones == doctest::Approx(even).epsilon(0.08));
}

TEST_CASE("sightings in one cell are one place; places below the horizon or closer than a cell are left to the grid") {
    BrightPlaces places;
    const std::vector<Sighting> same{
        {{0.01f, 0.02f, 1.01f}, 1, 6}, {{0.05f, 0.06f, 1.05f}, 3, 6}, {{0.01f, 0.02f, -1.01f}, 1, 6}};
    places.add(same);
    CHECK(places.size() == 2);
    CHECK(places.seen_from({}, up).pdf_solid_angle({0, 0, -1}) == 0);
    CHECK(places.seen_from({}, -up).pdf_solid_angle({0, 0, -1}) > 0);
    CHECK(places.seen_from({0, 0, 1}, up).empty());
    CHECK(BrightPlaces().seen_from({}, up).empty());
    // No more than are worth their while: the brightest stay.
    std::vector<Sighting> many;
    for (int i = 0; i < 1000; ++i) many.push_back({{float(i), 0, 5}, i == 700 ? 100.0f : 1.0f, 6});
    places.add(many);
    CHECK(places.size() == 64);
    CHECK_FALSE(places.seen_from({700, 0, 4.5f}, up).empty());
}

TEST_CASE("the width of a cell is a share of the distance of the hit, whatever else is in the scene") {
    // The same lamp, once beside a sighting a thousand times as far away: two sightings 4 cm apart stay two places where they
    // were met from one metre, and are one where they were met from a kilometre.
    const auto lamps = [](float distance) {
        return std::vector<Sighting>{{{0.51f, 0.51f, 0.51f}, 1, distance}, {{0.55f, 0.51f, 0.51f}, 1, distance}};
    };
    BrightPlaces near, far;
    near.add(std::vector<Sighting>{{{2000, 0, 0}, 1, 1000}});
    near.add(lamps(1));
    CHECK(near.size() == 3);
    far.add(lamps(1000));
    CHECK(far.size() == 1);
    // What touches the point is left to the grid.
    far.add(lamps(0));
    CHECK(far.size() == 1);
}
