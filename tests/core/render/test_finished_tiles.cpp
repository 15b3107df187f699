// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <doctest/doctest.h>

#include "render/finished_tiles.h"

using namespace eclat;

namespace {

Film numbered(int width, int height, float first) {
    Film film(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) film.add(x, y, 0, {Color(first + float(10 * y + x)), {}, {}, {}, 1, false});
    return film;
}

}  // namespace

TEST_CASE("a tile is a copy of its rectangle, and is taken once") {
    FinishedTiles tiles;
    const Film film = numbered(5, 4, 0);
    tiles.add(film, 3, 2, 5, 4);
    tiles.add(film, 0, 0, 3, 2);
    const auto taken = tiles.take();
    REQUIRE(taken.size() == 2);
    CHECK(taken[0].x == 0);
    CHECK(taken[0].y == 0);
    CHECK(taken[1].x == 3);
    CHECK(taken[1].y == 2);
    REQUIRE(taken[1].film.width() == 2);
    REQUIRE(taken[1].film.height() == 2);
    CHECK(taken[0].film.pixels()[4].radiance.r == 11);
    CHECK(taken[1].film.pixels()[0].radiance.r == 23);
    CHECK(taken[1].film.pixels()[3].radiance.r == 34);
    CHECK(tiles.take().empty());
}

TEST_CASE("a tile that nobody took is replaced by the newer one") {
    FinishedTiles tiles;
    tiles.add(numbered(2, 2, 0), 0, 0, 2, 2);
    tiles.add(numbered(2, 2, 100), 0, 0, 2, 2);
    const auto taken = tiles.take();
    REQUIRE(taken.size() == 1);
    CHECK(taken[0].film.pixels()[0].radiance.r == 100);
}
