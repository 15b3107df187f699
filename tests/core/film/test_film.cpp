// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <doctest/doctest.h>

#include "film/film.h"

using namespace eclat;

TEST_CASE("a pixel sums its own samples, layer by layer") {
    Film film(4, 3);
    film.add(2, 1, 0, {Color(1, 2, 3), Color(0.5f), Color(0.25f), {0, 0, 1}, 4, false});
    film.add(2, 1, 1, {Color(2, 2, 2), Color(0.5f), Color(0.75f), {0, 0, 1}, 6, true});
    film.add(3, 1, 0, {Color(9), Color(9), Color(1), {1, 0, 0}, 1, false});
    const Film::Pixel& p = film.pixels()[1 * 4 + 2];
    CHECK(p.samples == 2);
    CHECK(p.radiance.r == 3);
    CHECK(p.radiance.b == 5);
    CHECK(p.direct.g == 1);
    CHECK(p.albedo.g == 1);
    CHECK(p.normal.z == 2);
    CHECK(p.distance == 10);
    CHECK(p.hits == 2);
    CHECK(p.cache_misses == 1);
    CHECK(film.pixels()[0].samples == 0);
    CHECK(film.bad_count() == 0);
}

TEST_CASE("samples whose gloss was cached, and those whose gloss was traced, are counted apart") {
    Film film(1, 1);
    for (uint32_t i = 0; i < 5; ++i) film.add(0, 0, i, {Color(1), {}, {}, {}, 1, false, i < 3, i >= 1});
    CHECK(film.pixels()[0].gloss_cached == 3);
    CHECK(film.pixels()[0].gloss_traced == 4);
}

TEST_CASE("a sample that hit nothing counts for the radiance but not for the depth") {
    Film film(1, 1);
    film.add(0, 0, 0, {Color(1), {}, {}, {}, 0, false});
    film.add(0, 0, 1, {Color(1), {}, {}, {}, 3, false});
    CHECK(film.pixels()[0].samples == 2);
    CHECK(film.pixels()[0].hits == 1);
    CHECK(film.pixels()[0].distance == 3);
}

TEST_CASE("samples that are not finite are counted and remembered, never added") {
    Film film(3, 2);
    film.add(1, 1, 0, {Color(1), {}, {}, {}, 1, false});
    film.add(1, 1, 7, {Color(infinity), {}, {}, {}, 1, false});
    film.add(2, 0, 9, {Color(0, infinity - infinity, 0), {}, {}, {}, 1, false});
    CHECK(film.pixels()[4].samples == 1);
    CHECK(film.pixels()[4].radiance.r == 1);
    CHECK(film.pixels()[2].samples == 0);
    REQUIRE(film.bad_samples().size() == 2);
    CHECK(film.bad_samples()[0].x == 1);
    CHECK(film.bad_samples()[0].y == 1);
    CHECK(film.bad_samples()[0].sample == 7);
    CHECK(film.bad_samples()[1].sample == 9);
    for (uint32_t i = 0; i < 100; ++i) film.add(0, 0, i, {Color(infinity), {}, {}, {}, 1, false});
    CHECK(film.bad_count() == 102);
    CHECK(film.bad_samples().size() < 20);  // some are enough to replay
}

TEST_CASE("films that are interleaved sum their samples, and number them evenly and oddly") {
    Film even(2, 1), odd(2, 1);
    even.add(0, 0, 0, {.radiance = Color(1), .distance = 2, .rough_albedo = Color(0.5f), .rough_normal = {0, 1, 0}});
    odd.add(0, 0, 0, {.radiance = Color(3), .distance = 4, .rough_albedo = Color(0.25f), .rough_normal = {0, 1, 0}});
    odd.add(1, 0, 0, {.radiance = Color(7), .cache_missed = true, .gloss_cached = true});
    even.add(1, 0, 2, {.radiance = Color(infinity)});
    odd.add(1, 0, 1, {.radiance = Color(infinity)});
    even.interleave(odd);
    const Film::Pixel &p = even.pixels()[0], &q = even.pixels()[1];
    CHECK(p.samples == 2);
    CHECK(p.radiance.g == 4);
    CHECK(p.rough_albedo.b == 0.75f);
    CHECK(p.rough_normal.y == 2);
    CHECK(p.distance == 6);
    CHECK(p.hits == 2);
    CHECK(q.samples == 1);
    CHECK(q.cache_misses == 1);
    CHECK(q.gloss_cached == 1);
    REQUIRE(even.bad_count() == 2);
    CHECK(even.bad_samples()[0].sample == 3);  // the odd film's second comes before the even film's third
    CHECK(even.bad_samples()[1].sample == 4);
}
