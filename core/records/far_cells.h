// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Cells of a hash grid hold the mean of the irradiance that paths of earlier gathers found on surfaces there. Later gather rays
// end in them.

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/color.h"
#include "base/vec.h"

namespace eclat {

/// The number of a cell, in two halves, so that what holds it needs no padding.
struct CellKey {
    uint32_t low, high;

    /// Returns the cell of a point that a gather ray of length `distance` hit; `normal` is that of the shading, on the side of
    /// the ray.
    static CellKey at(Vec3 position, Vec3 normal, float distance);
    uint64_t number() const { return uint64_t(high) << 32 | low; }
};

/// An estimate of the irradiance at a point that a gather ray hit, from the one path that continued there.
struct CellSample {
    CellKey cell;
    Color irradiance;  // indirect, W m⁻²
};

/// What is read of a cell.
struct CellMean {
    CellKey cell;
    Color irradiance;
};

class FarCells {
  public:
    /// Adds samples in their order.
    void add(std::span<const CellSample> samples, int threads);

    /// Returns what is read of the cells of samples that were added: each cell once, in the order of their numbers.
    std::vector<CellMean> means_of(std::span<const CellSample> samples) const;
    /// Sets what is read of cells, without what is known of them.
    void set(std::span<const CellMean> means);

    /// Returns the mean irradiance in the cell around a point that a ray of length `distance` hit, or nothing if too few
    /// samples are known there.
    std::optional<Color> irradiance(Vec3 position, Vec3 normal, float distance) const;

  private:
    /// What is known of a cell. Cells are found by the hash of their coordinates; two of a million cells have the same
    /// hash of 64 bits with a probability of 10⁻⁷.
    struct Sum {
        uint64_t key = 0;  // 0 in empty slots
        uint32_t count = 0;
        std::array<double, 3> irradiance{};
    };
    struct Mean {
        uint64_t key = 0;
        Color irradiance;
    };
    /// A hash table with open addressing, whose size is a power of two.
    template <class Cell>
    struct Table {
        std::vector<Cell> slots;
        size_t used = 0;

        /// Returns the slot of the key, which may be empty.
        size_t slot(uint64_t key) const;
        const Cell* find(uint64_t key) const;
        Cell& find_or_add(uint64_t key);
        void grow();
    };

    /// Cells are divided by their keys, so that threads can add samples at once.
    static constexpr size_t parts = 16;
    static size_t part_of(uint64_t key) { return key >> 60; }
    std::array<Table<Sum>, parts> sums_;
    std::array<Table<Mean>, parts>
        means_;  // of the cells that are read; they are few, so that they stay in fast memory
};

}  // namespace eclat
