// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Where surfaces exchange light, beside what lies far away and exchanges none.

#include "transport/busy_places.h"

#include <doctest/doctest.h>

#include "room.h"

using namespace eclat;

namespace {

/// Adds a room of 4 × 3 × 5 m at `at`.
void add_room(std::vector<Wall>& quads, Vec3 at) {
    const Vec3 x{4, 0, 0}, y{0, 3, 0}, z{0, 0, 5};
    for (const Wall& wall : std::vector<Wall>{{at, x, y, 0.7f, 0},
                                              {at + z, x, y, 0.7f, 0},
                                              {at, x, z, 0.7f, 0},
                                              {at + y, x, z, 0.7f, 0},
                                              {at, y, z, 0.7f, 0},
                                              {at + x, y, z, 0.7f, 0}})
        quads.push_back(wall);
}

bool covers(const Ball& ball, Vec3 room) {
    return length(ball.center - room - Vec3{2, 1.5f, 2.5f}) < 2 && ball.radius > 3 && ball.radius < 8;
}

}  // namespace

TEST_CASE("a room alone is one place with all of the scene") {
    std::vector<Wall> quads;
    add_room(quads, {});
    CHECK(busy_places(*build_room(quads).geometry).empty());
}

TEST_CASE("rooms are places on a ground of a square kilometre, and beside stray parts") {
    for (const bool ground : {true, false}) {
        std::vector<Wall> quads;
        add_room(quads, {});
        add_room(quads, {200, 0, 100});
        if (ground) quads.push_back({{-500, -0.5f, -500}, {1000, 0, 0}, {0, 0, 1000}, 0.2f, 0});
        if (!ground) quads.push_back({{0, 0, 3000}, {1, 0, 0}, {0, 1, 0}, 0.2f, 0});
        const auto places = busy_places(*build_room(quads).geometry);
        REQUIRE(places.size() == 2);
        const bool first = covers(places[0], {});
        CHECK((first || covers(places[1], {})));
        CHECK(covers(places[first ? 1 : 0], {200, 0, 100}));
    }
}
