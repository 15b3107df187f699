// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "sampling/cosine_guide.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <numeric>

using namespace eclat;

namespace {

constexpr uint32_t side = CosineGuide::side, cells = CosineGuide::cells;
using Cells = std::array<float, cells>;

/// A lattice of n × n points of the unit square, without its edges.
template <class F>
void for_each_point(uint32_t n, const F& f) {
    for (uint32_t y = 0; y < n; ++y)
        for (uint32_t x = 0; x < n; ++x) f(Vec2{(float(x) + 0.5f) / float(n), (float(y) + 0.5f) / float(n)});
}

Cells some_weights() {
    Cells weights;
    for (uint32_t i = 0; i < cells; ++i) weights[i] = float(i * 29 % 64);  // 0 among them
    return weights;
}

}  // namespace

TEST_CASE("the cell of a direction is that of its place on the square") {
    for_each_point(10 * side, [](Vec2 u) {
        const uint32_t cell = uint32_t(u.y * side) * side + uint32_t(u.x * side);
        REQUIRE(CosineGuide::cell_of(square_to_cosine_hemisphere(u)) == cell);
    });
    CHECK(CosineGuide::cell_of({0, 0, 1}) < cells);
    for (const Vec3 w : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0.6f, 0.8f, 0}})
        CHECK(CosineGuide::cell_of(w) < cells);
    constexpr float huge = std::numeric_limits<float>::max(), none = std::numeric_limits<float>::quiet_NaN();
    for (const Vec3 w : {Vec3{none, none, none}, Vec3{none, 0, 1}, Vec3{0, none, 1}, Vec3{huge, -huge, huge}})
        CHECK(CosineGuide::cell_of(w) < cells);
}

TEST_CASE("a guide sends shares of directions into cells in proportion to the weights") {
    const Cells weights = some_weights();
    const float total = std::accumulate(weights.begin(), weights.end(), 0.0f);
    const CosineGuide guide(weights);
    constexpr uint32_t n = 1000;
    Cells found{};
    for_each_point(n, [&](Vec2 u) {
        const CosineGuide::Place place = guide.sample(u);
        const Vec3 w = square_to_cosine_hemisphere(place.at);
        REQUIRE(guide.factor(w) == place.factor);
        found[CosineGuide::cell_of(w)] += 1.0f / (n * n);
    });
    for (uint32_t i = 0; i < cells; ++i) {
        CAPTURE(i);
        CHECK(found[i] == doctest::Approx(weights[i] / total).epsilon(0.02).scale(0.01));
    }
}

TEST_CASE("the ends of the unit interval lead into cells that have a weight") {
    Cells weights{};
    weights[3 * side + 2] = 5;  // the only one
    const CosineGuide guide(weights);
    for (const float x : {0.0f, 0.5f, below_one})
        for (const float y : {0.0f, 0.5f, below_one}) {
            const CosineGuide::Place place = guide.sample({x, y});
            CHECK(place.factor == cells);
            const Vec2 in_cell{place.at.x * side - 2, place.at.y * side - 3};
            CHECK(std::min(in_cell.x, in_cell.y) >= 0);
            CHECK(std::max(in_cell.x, in_cell.y) <= 1);
        }
}

TEST_CASE("without weights a guide leaves directions as they are") {
    const CosineGuide guide;
    for_each_point(7, [&](Vec2 u) {
        const CosineGuide::Place place = guide.sample(u);
        CHECK(place.at.x == doctest::Approx(u.x).epsilon(1e-5));
        CHECK(place.at.y == doctest::Approx(u.y).epsilon(1e-5));
        CHECK(place.factor == 1);
    });
}
