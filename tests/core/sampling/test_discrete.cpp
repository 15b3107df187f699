// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Discrete choices: probabilities are exactly the frequencies over all random numbers.

#include <doctest/doctest.h>

#include <numeric>

#include "sampling/discrete.h"
#include "sampling/rng.h"

using namespace eclat;

namespace {

constexpr uint32_t numbers = 1u << 24;
float number(uint32_t i) { return static_cast<float>(i) * 0x1p-24f; }

}  // namespace

TEST_CASE("over all 2^24 random numbers, the frequency of each entry is exactly its probability") {
    Rng rng(1, 1);
    for (const size_t size : {1, 2, 3, 7, 1000}) {
        CAPTURE(size);
        std::vector<double> weights(size);
        for (double& w : weights) w = rng.next() < 0.2f && size > 3 ? 0 : std::pow(rng.next(), 6.0f) * 1e-5;
        const AliasTable table(weights);
        std::vector<uint32_t> count(size, 0);
        std::vector<double> remapped(size, 0);
        for (uint32_t i = 0; i < numbers; ++i) {
            const DiscreteSample s = table.sample(number(i));
            ++count[s.index];
            remapped[s.index] += s.remapped;
        }
        const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
        for (uint32_t i = 0; i < size; ++i) {
            CHECK(count[i] == table.pdf_discrete(i) * 0x1p24);
            CHECK((count[i] > 0) == (weights[i] > 0));
            // One number of each positive entry is set aside before the rest is shared.
            CHECK(std::abs(count[i] - weights[i] / sum * numbers) <= 2 + 1.1 * double(size) * weights[i] / sum);
            if (count[i] > 1000) CHECK(remapped[i] / count[i] == doctest::Approx(0.5).epsilon(0.01));
        }
    }
}

TEST_CASE("fifty thousand entries, one of them ten orders brighter") {
    std::vector<double> weights(50000, 1e-10);
    weights[31234] = 1;
    const AliasTable table(weights);
    uint64_t hits = 0;
    double sum = 0;
    std::vector<bool> seen(weights.size(), false);
    for (uint32_t i = 0; i < numbers; ++i) {
        const DiscreteSample s = table.sample(number(i));
        seen[s.index] = true;
        hits += s.index == 31234;
        CHECK_FALSE(s.pdf_discrete != table.pdf_discrete(s.index));
        sum += 1 / s.pdf_discrete;
    }
    CHECK(static_cast<double>(hits) == table.pdf_discrete(31234) * 0x1p24);
    // Mean of 1 / pdf counts the entries.
    CHECK(sum / numbers == doctest::Approx(50000).epsilon(1e-6));
    CHECK(std::count(seen.begin(), seen.end(), true) == 50000);
}

TEST_CASE("an alias table does not depend on the weights' scale, bit for bit") {
    std::vector<double> weights = {0.3, 0, 1.7, 12, 1e-3}, scaled = weights;
    for (double& w : scaled) w *= 0x1p-40;
    const AliasTable a(weights), b(scaled);
    for (uint32_t i = 0; i < weights.size(); ++i) CHECK(a.pdf_discrete(i) == b.pdf_discrete(i));
}

TEST_CASE("nothing to choose from") {
    CHECK(AliasTable().sample(0.5f).pdf_discrete == 0);
    CHECK(AliasTable(std::vector<double>{}).empty());
    CHECK(AliasTable(std::vector<double>{0, 0}).sample(0.1f).pdf_discrete == 0);
    CHECK(AliasTable(std::vector<double>{0, 0}).pdf_discrete(1) == 0);
    CHECK_THROWS_WITH_AS(AliasTable(std::vector<double>{1, -1}), "alias table: weights must be finite and not negative",
                         std::invalid_argument);
    CHECK_THROWS_AS(AliasTable(std::vector<double>{1, NAN}), std::invalid_argument);
    CHECK_THROWS_AS(AliasTable(std::vector<double>{1, INFINITY}), std::invalid_argument);
}

TEST_CASE("random numbers at and beyond the ends stay in the table") {
    const AliasTable table(std::vector<double>{1, 2, 3});
    const PiecewiseConstant1D line(std::vector<double>{0, 1, 2, 0, 0});
    for (const float u : {0.0f, below_one, 1.0f, -0.1f, 1e-30f}) {
        CHECK(table.sample(u).index < 3);
        CHECK(table.sample(u).remapped < 1);
        CHECK(line.sample(u).pdf_discrete > 0);
        CHECK(line.sample(u).remapped < 1);
    }
}

TEST_CASE("a piecewise-constant line is inverted in order and skips empty cells") {
    const PiecewiseConstant1D line(std::vector<double>{0, 1, 0, 3});
    CHECK(line.sample(0.2f).index == 1);
    CHECK(line.sample(0.2f).remapped == doctest::Approx(0.8));
    CHECK(line.sample(0.25f).index == 3);
    CHECK(line.sample(0.25f).remapped == 0);
    CHECK(line.sample(0.5f).pdf_discrete == 0.75f);
    CHECK(line.pdf(0.3f) == 1);
    CHECK(line.pdf(0.6f) == 0);
    CHECK(line.pdf(1.0f) == 3);
    CHECK(line.total() == 4);
    CHECK(PiecewiseConstant1D(std::vector<double>{0, 0}).sample(0.5f).pdf_discrete == 0);
    CHECK(PiecewiseConstant1D().sample(0.5f).pdf_discrete == 0);
}

TEST_CASE("a piecewise-constant grid: frequencies are the weights, offsets uniform") {
    const std::vector<float> weights = {0, 1, 2, 0, 0, 0, 4, 0, 1};
    const PiecewiseConstant2D grid(3, 3, weights);
    std::vector<double> count(9, 0);
    const int side = 1024;
    double x = 0, y = 0;
    for (int j = 0; j < side; ++j) {
        for (int i = 0; i < side; ++i) {
            const auto cell = grid.sample({(i + 0.5f) / side, (j + 0.5f) / side});
            count[cell.row * 3 + cell.column] += 1;
            CHECK_FALSE(cell.pdf_discrete != grid.pdf_discrete(cell.column, cell.row));
            x += cell.offset.x;
            y += cell.offset.y;
        }
    }
    for (int i = 0; i < 9; ++i) CHECK(count[i] / (side * side) == doctest::Approx(weights[i] / 8).epsilon(0.003));
    CHECK(x / (side * side) == doctest::Approx(0.5).epsilon(0.003));
    CHECK(y / (side * side) == doctest::Approx(0.5).epsilon(0.003));
    CHECK(PiecewiseConstant2D(2, 1, std::vector<float>{0, 0}).sample({0.3f, 0.3f}).pdf_discrete == 0);
}
