// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <unordered_set>

#include "running_mean.h"
#include "sampling/rng.h"

using namespace eclat;

TEST_CASE("the hash is a bijection and has no fixed pattern between neighbours") {
    std::unordered_set<uint32_t> seen;
    for (uint32_t i = 0; i < 100000; ++i) seen.insert(hash(i));
    CHECK(seen.size() == 100000);
}

TEST_CASE("each input bit flips each output bit about half the time") {
    constexpr int trials = 4000;
    for (int in = 0; in < 32; ++in) {
        int flips[32] = {};
        for (uint32_t i = 0; i < trials; ++i) {
            const uint32_t x = i * 2654435761u, difference = hash(x) ^ hash(x ^ (1u << in));
            for (int out = 0; out < 32; ++out) flips[out] += difference >> out & 1;
        }
        // Ten standard deviations of a fair coin: a pattern, not bad luck.
        for (int out = 0; out < 32; ++out) CHECK(std::abs(flips[out] - trials / 2) < 10 * std::sqrt(trials) / 2);
    }
}

TEST_CASE("keys depend on the order of their parts") {
    CHECK(hash(1, 2) != hash(2, 1));
    CHECK(hash(1, 2, 3) != hash(3, 2, 1));
    CHECK(hash(0, 1) != hash(1, 0));
    std::unordered_set<uint32_t> seen;
    for (uint32_t a = 0; a < 200; ++a)
        for (uint32_t b = 0; b < 200; ++b) seen.insert(hash(a, b));
    CHECK(seen.size() > 39990);  // random collisions of 40 000 keys: 0.2 on average
}

TEST_CASE("unit floats lie in [0, 1)") {
    CHECK(to_unit_float(0) == 0);
    CHECK(to_unit_float(~0u) < 1);
    CHECK(to_unit_float(~0u) > 0.9999999f);
    CHECK(to_unit_float(1u << 31) == 0.5f);
}

TEST_CASE("a key gives one sequence, uniform and uncorrelated") {
    Rng a(5, 6), b(5, 6), other(5, 7);
    RunningMean mean, square, serial;
    float last = 0;
    int equal = 0;
    for (int i = 0; i < 100000; ++i) {
        const float x = a.next();
        CHECK(x == b.next());
        equal += x == other.next();
        mean.add(x);
        square.add(x * x);
        if (i % 2) serial.add((x - 0.5) * (last - 0.5));
        last = x;
    }
    CHECK(equal < 5);
    CHECK(mean.agrees(0.5));
    CHECK(square.agrees(1.0 / 3));
    CHECK(serial.agrees(0));
}
