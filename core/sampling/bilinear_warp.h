// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Functions on the unit square that are bilinear between nodes and linear in further parameters, and sampling in proportion to
// them [DupuyJakob18].

#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/vec.h"

namespace eclat {

/// The parameters, an outer and an inner one, by their nodes. One node means that nothing depends on it.
using ParameterNodes = std::array<std::vector<float>, 2>;

/// The slices among which a pair of parameters lies, and their weights, which add up to 1.
struct Slices {
    std::array<size_t, 4> index{};
    std::array<float, 4> weight{};
    int count = 0;
};
Slices slices_among(const ParameterNodes& nodes, float outer, float inner);

/// A bilinear function for each pair of nodes of the parameters.
class BilinearTable {
  public:
    BilinearTable() = default;
    /// `values`: slices in order of (outer, inner), each with `height` rows of `width` nodes. `channels` are innermost but rows.
    BilinearTable(size_t width, size_t height, size_t slices, std::span<const float> values);

    float eval(Vec2 at, const Slices& slices) const;

  protected:
    /// A place between two rows and two columns.
    struct Cell {
        size_t column, row;
        float x, y;
    };
    Cell cell_of(Vec2 at) const;
    float node(size_t column, size_t row, const Slices& slices) const {
        float sum = 0;
        for (int i = 0; i < slices.count; ++i)
            sum += slices.weight[size_t(i)] * values_[(slices.index[size_t(i)] * height_ + row) * width_ + column];
        return sum;
    }

    size_t width_ = 0, height_ = 0;
    std::vector<float> values_;
};

/// Maps the unit square to itself so that uniform points become distributed in proportion to the table; it is normalised, so that
/// each slice has the integral 1.
class BilinearWarp : public BilinearTable {
  public:
    struct Result {
        Vec2 at;
        float pdf;  // of the place on the square
    };

    BilinearWarp() = default;
    BilinearWarp(size_t width, size_t height, size_t slices, std::span<const float> values);

    Result sample(Vec2 u, const Slices& slices) const;
    /// The uniform point that `sample` maps to `at`, and the density there.
    Result invert(Vec2 at, const Slices& slices) const;

  private:
    float below_column(size_t column, size_t row, const Slices& slices) const {
        return mean(conditional_, (row * width_) + column, width_ * height_, slices);
    }
    float below_row(size_t row, const Slices& slices) const { return mean(marginal_, row, height_, slices); }
    float row_integral(size_t row, const Slices& slices) const { return below_column(width_ - 1, row, slices); }
    static float mean(const std::vector<float>& from, size_t at, size_t stride, const Slices& slices) {
        float sum = 0;
        for (int i = 0; i < slices.count; ++i)
            sum += slices.weight[size_t(i)] * from[slices.index[size_t(i)] * stride + at];
        return sum;
    }

    std::vector<float> conditional_;  // integral of each row from its beginning to each node
    std::vector<float> marginal_;     // integral of all rows above each row of nodes
};

}  // namespace eclat
