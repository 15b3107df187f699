// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Stratification of the sampler: what makes it better than independent numbers.

#include <doctest/doctest.h>

#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "running_mean.h"
#include "sampling/sampler.h"

using namespace eclat;

TEST_CASE("2^k samples of a pixel fall one in each elementary interval, in every pair of dimensions") {
    constexpr int k = 6, count = 1 << k;
    for (uint32_t pixel : {0u, 77u, 65536u})
        for (uint32_t first : {0u, 64u, 640u})  // any aligned run of samples, not only the first
            for (uint32_t dimension : {0u, 1u, 9u}) {
                for (int log_columns = 0; log_columns <= k; ++log_columns) {
                    const int columns = 1 << log_columns, rows = count / columns;
                    std::set<std::pair<int, int>> cells;
                    for (uint32_t sample = 0; sample < count; ++sample) {
                        Sampler sampler(3, pixel, first + sample);
                        sampler.set_dimension(dimension);
                        const Vec2 u = sampler.next_2d();
                        cells.emplace(static_cast<int>(u.x * columns), static_cast<int>(u.y * rows));
                    }
                    CHECK(cells.size() == count);
                }
                std::set<int> strata;
                for (uint32_t sample = 0; sample < count; ++sample) {
                    Sampler sampler(3, pixel, first + sample);
                    sampler.set_dimension(dimension);
                    strata.insert(static_cast<int>(sampler.next_1d() * count));
                }
                CHECK(strata.size() == count);
            }
}

TEST_CASE("a sample is a function of its key, and of the dimension only, not of what was drawn before") {
    Sampler a(1, 2, 3), b(1, 2, 3), c(1, 2, 4);
    const Vec2 first = a.next_2d();
    CHECK(b.next_2d().x == first.x);
    CHECK(c.next_2d().x != first.x);
    a.next_1d();
    a.next_1d();
    b.set_dimension(3);
    CHECK(a.next_2d().y == b.next_2d().y);
}

TEST_CASE("different pixels, dimensions and seeds are uncorrelated") {
    RunningMean pixels, dimensions, seeds;
    for (uint32_t pixel = 0; pixel < 20000; ++pixel) {
        Sampler here(1, pixel, 5), beside(1, pixel + 1, 5), other(2, pixel, 5);
        const Vec2 u = here.next_2d(), v = here.next_2d();
        pixels.add((u.x - 0.5) * (beside.next_2d().x - 0.5));
        dimensions.add((u.x - 0.5) * (v.x - 0.5));
        seeds.add((u.x - 0.5) * (other.next_2d().x - 0.5));
    }
    CHECK(pixels.agrees(0));
    CHECK(dimensions.agrees(0));
    CHECK(seeds.agrees(0));
}

TEST_CASE("each single sample is uniform over pixels: the estimate has no bias") {
    RunningMean x, y, xx, xy;
    for (uint32_t pixel = 0; pixel < 50000; ++pixel) {
        const Vec2 u = Sampler(9, pixel, 0).next_2d();
        x.add(u.x);
        y.add(u.y);
        xx.add(u.x * u.x);
        xy.add(u.x * u.y);
    }
    CHECK(x.agrees(0.5));
    CHECK(y.agrees(0.5));
    CHECK(xx.agrees(1.0 / 3));
    CHECK(xy.agrees(0.25));
}

TEST_CASE("a smooth integral converges much faster than by independent numbers") {
    double stratified = 0, independent = 0;
    constexpr int count = 256, runs = 64;
    const auto f = [](Vec2 u) { return std::exp(double(u.x) + u.y); };
    const double truth = (std::exp(1.0) - 1) * (std::exp(1.0) - 1);
    for (uint32_t run = 0; run < runs; ++run) {
        double a = 0, b = 0;
        Rng rng(run, 0);
        for (uint32_t sample = 0; sample < count; ++sample) {
            a += f(Sampler(4, run, sample).next_2d()) / count;
            const float x = rng.next(), y = rng.next();
            b += f({x, y}) / count;
        }
        stratified += (a - truth) * (a - truth) / runs;
        independent += (b - truth) * (b - truth) / runs;
    }
    CHECK(std::sqrt(stratified) < 0.05 * std::sqrt(independent));
}

TEST_CASE("reversing bits") {
    CHECK(reverse_bits(1) == 0x80000000u);
    CHECK(reverse_bits(0x00ff1234u) == 0x2c48ff00u);
    CHECK(reverse_bits(reverse_bits(0xdeadbeefu)) == 0xdeadbeefu);
}

TEST_CASE("Owen scrambling flips a bit by the bits below it only, so reversed prefixes stay prefixes") {
    for (uint32_t seed : {1u, 12345u, 0x9e3779b9u})
        for (uint32_t x : {0u, 1u, 0x12345678u, 0xffffffffu})
            for (int bit = 1; bit < 32; ++bit) {
                const uint32_t low = (1u << bit) - 1;
                CHECK(((laine_karras_permutation(x, seed) ^ laine_karras_permutation(x ^ (1u << bit), seed)) & low) ==
                      0);
            }
}
