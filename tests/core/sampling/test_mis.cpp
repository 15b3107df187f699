// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Weights of techniques: shares that sum to one, at the ends of the range too.

#include <doctest/doctest.h>

#include <cmath>
#include <initializer_list>

#include "sampling/mis.h"

using namespace eclat;

TEST_CASE("the weights of two techniques sum to one") {
    for (const float a : {1e-30f, 1e-3f, 1.0f, 7.0f, 1e30f}) {
        for (const float b : {1e-30f, 0.5f, 3.0f, 1e30f}) {
            CHECK(balance_heuristic(a, b) + balance_heuristic(b, a) == doctest::Approx(1));
            CHECK(power_heuristic(a, b) + power_heuristic(b, a) == doctest::Approx(1));
        }
    }
    CHECK(balance_heuristic(1, 3) == doctest::Approx(0.25));
    CHECK(power_heuristic(1, 3) == doctest::Approx(0.1));
}

TEST_CASE("a technique that cannot generate the sample has the weight 0, and a delta has 1") {
    CHECK(power_heuristic(0, 1) == 0);
    CHECK(power_heuristic(0, 0) == 0);
    CHECK(power_heuristic(2, 0) == 1);
    CHECK(power_heuristic(INFINITY, 1) == 1);
    CHECK(power_heuristic(1, INFINITY) == 0);
    CHECK(balance_heuristic(1, INFINITY) == 0);
}
