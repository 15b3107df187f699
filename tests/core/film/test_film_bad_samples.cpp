// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <doctest/doctest.h>

#include <cmath>

#include "film/film.h"

namespace eclat {

TEST_CASE("the first sample that is not finite is reported by position, whatever the order of the samples") {
    const FilmSample bad{.radiance = Color(NAN), .direct = {}, .albedo = {}, .normal = {}};
    Film forwards(4, 4), backwards(4, 4);
    for (int i = 0; i < 20; ++i) {
        forwards.add(i % 4, i / 4 % 4, static_cast<uint32_t>(i / 16), bad);
        const int j = 19 - i;
        backwards.add(j % 4, j / 4 % 4, static_cast<uint32_t>(j / 16), bad);
    }
    CHECK(forwards.bad_count() == 20);
    REQUIRE(forwards.bad_samples().size() == 8);
    for (size_t i = 0; i < 8; ++i) {
        CHECK(forwards.bad_samples()[i].key() == backwards.bad_samples()[i].key());
        CHECK(forwards.bad_samples()[i].key() == std::tuple(0u, static_cast<int>(i / 4), static_cast<int>(i % 4)));
    }
    for (const Film::Pixel& p : forwards.pixels()) CHECK(p.samples == 0);
}

TEST_CASE("a copy does not follow its film") {
    Film film(2, 1);
    const FilmSample one{.radiance = Color(1), .direct = {}, .albedo = {}, .normal = {}};
    film.add(1, 0, 0, one);
    const Film copy(film);
    film.add(1, 0, 1, one);
    CHECK(copy.pixels()[1].samples == 1);
    CHECK(film.pixels()[1].samples == 2);
    CHECK(copy.pixels()[1].radiance.r == 1);
}

}  // namespace eclat
