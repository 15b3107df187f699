// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Where no far record serves the hit of a gather ray, the path goes on, and what it finds is an estimate of the irradiance
// there with one sample. All estimates of a pass that fall into the same cell of a grid are averaged, and the gather rays of
// later passes that hit the cell read the mean instead of going on. A cell holds points of about one place and orientation.
//
// Symbol   name here        meaning                                                                   unit
//   t      distance         length of the gather ray                                                  m
//   h      –                width of a cell, the power of two at most `share` · t                     m
//   n      count            number of estimates in a cell
//
// A gather of N rays sees the surface at the distance t only blurred over about t √(2π / N), so a cell of this width costs
// nothing. Short rays read small cells, which few paths have visited: near corners, paths go on. A cell counts its places as
// often as gather rays hit them, so it neither adds nor removes light in the sum over all gathers, wherever the walls and edges
// within it are. But a cell across a wall gives its mean to both sides, and a closed dark room beside a lit one would not stay
// dark: in a light map, 0.002 of the light came through a wall of a centimetre. So records for points and for all surfaces do
// not read cells. In pictures this is a bias, which error probes measure because their paths do not read cells.
//
// References   [Binder18] cells of a hash grid, with widths that follow the length of rays
// Bias         Gather rays see light that varies within a cell only blurred, also across a thin wall.
// Held to      tests/core/records/test_far_cells.cpp

#include "records/far_cells.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace eclat {

namespace {

// √(2π / N) for a gather of 250 rays.
constexpr float share = 0.16f;
// The number of estimates from which a cell is read. An estimate deviates by about its mean, and a gather averages over some
// hundred cells, which leaves about 2 % of noise. With 8 estimates, a solve of `living-room` takes a tenth less time, but
// records in a furnace deviate by 5 %.
constexpr uint32_t least_count = 32;

/// Returns the exponent of the width of the cells that belong to rays of this length.
int level_of(float distance) { return std::ilogb(std::max(distance * share, 1e-30f)); }

uint64_t mix(uint64_t x) {
    x ^= x >> 32;
    x *= 0xd6e8feb86659fd93u;
    x ^= x >> 32;
    x *= 0xd6e8feb86659fd93u;
    x ^= x >> 32;
    return x;
}

/// Returns the number of the cell of the unit sphere, of which there are 54: nine on each side of a cube. Normals along
/// the axes are in the middle of theirs, so that rounding does not divide a wall.
uint64_t orientation(Vec3 n) {
    int axis = 0;
    for (int i = 1; i < 3; ++i)
        if (std::fabs(n[i]) > std::fabs(n[axis])) axis = i;
    const float largest = std::fabs(n[axis]);
    const auto third = [&](float x) {
        return static_cast<uint64_t>(x > largest / 3) + static_cast<uint64_t>(x > -largest / 3);
    };
    return (static_cast<uint64_t>(2 * axis + (n[axis] < 0)) * 3 + third(n[(axis + 1) % 3])) * 3 +
           third(n[(axis + 2) % 3]);
}

uint64_t key_of(Vec3 p, Vec3 n, int level) {
    // The grid is displaced by arbitrary shares of a cell, because floors and walls often lie at multiples of a power of two, where rounding would
    // divide their points between two cells.
    constexpr float displaced[3] = {0.381966f, 0.276393f, 0.324920f};
    const float scale = std::ldexp(1.0f, -level);
    uint64_t key = mix(orientation(n) * 1024 + static_cast<uint64_t>(level + 512));
    for (int axis = 0; axis < 3; ++axis) {
        const double at = std::floor(static_cast<double>(p[axis]) * static_cast<double>(scale) +
                                     static_cast<double>(displaced[axis]));
        key = mix(key ^ static_cast<uint64_t>(static_cast<int64_t>(std::clamp(at, -9e18, 9e18))));
    }
    return key == 0 ? 1 : key;
}

}  // namespace

template <class Cell>
size_t FarCells::Table<Cell>::slot(uint64_t key) const {
    const size_t mask = slots.size() - 1;
    size_t i = key & mask;
    while (slots[i].key != 0 && slots[i].key != key) i = (i + 1) & mask;
    return i;
}

template <class Cell>
const Cell* FarCells::Table<Cell>::find(uint64_t key) const {
    if (slots.empty()) return nullptr;
    const Cell& cell = slots[slot(key)];
    return cell.key == key ? &cell : nullptr;
}

template <class Cell>
Cell& FarCells::Table<Cell>::find_or_add(uint64_t key) {
    if (2 * (used + 1) > slots.size()) grow();
    Cell& cell = slots[slot(key)];
    used += cell.key == 0;
    cell.key = key;
    return cell;
}

template <class Cell>
void FarCells::Table<Cell>::grow() {
    std::vector<Cell> before(std::max<size_t>(1024, 2 * slots.size()));
    before.swap(slots);
    for (const Cell& cell : before)
        if (cell.key != 0) slots[slot(cell.key)] = cell;
}

CellKey CellKey::at(Vec3 position, Vec3 normal, float distance) {
    const uint64_t key = key_of(position, normal, level_of(distance));
    return {static_cast<uint32_t>(key), static_cast<uint32_t>(key >> 32)};
}

void FarCells::add(std::span<const CellSample> samples, int threads) {
    parallel_for(parts, threads, [&](size_t part) {
        for (const CellSample& sample : samples) {
            const uint64_t key = sample.cell.number();
            if (part_of(key) != part) continue;
            Sum& sum = sums_[part].find_or_add(key);
            ++sum.count;
            for (size_t c = 0; c < 3; ++c)
                sum.irradiance[c] += static_cast<double>(sample.irradiance[static_cast<int>(c)]);
            if (sum.count < least_count) continue;
            Color& mean = means_[part].find_or_add(key).irradiance;
            for (size_t c = 0; c < 3; ++c)
                mean[static_cast<int>(c)] = static_cast<float>(sum.irradiance[c] / sum.count);
        }
    });
}

std::vector<CellMean> FarCells::means_of(std::span<const CellSample> samples) const {
    std::vector<CellMean> out;
    for (const CellSample& sample : samples)
        if (const Mean* mean = means_[part_of(sample.cell.number())].find(sample.cell.number()))
            out.push_back({sample.cell, mean->irradiance});
    const auto number = [](const CellMean& mean) { return mean.cell.number(); };
    std::ranges::sort(out, {}, number);
    const auto repeated = std::ranges::unique(out, {}, number);
    out.erase(repeated.begin(), repeated.end());
    return out;
}

void FarCells::set(std::span<const CellMean> means) {
    for (const CellMean& mean : means)
        means_[part_of(mean.cell.number())].find_or_add(mean.cell.number()).irradiance = mean.irradiance;
}

std::optional<Color> FarCells::irradiance(Vec3 position, Vec3 normal, float distance) const {
    const uint64_t key = CellKey::at(position, normal, distance).number();
    if (const Mean* mean = means_[part_of(key)].find(key)) return mean->irradiance;
    return std::nullopt;
}

}  // namespace eclat
