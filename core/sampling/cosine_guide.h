// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A density of directions around +z that is a piecewise-constant factor times the cosine: directions of matte surfaces, aimed at
// where light comes from [Jensen95].
//
// The unit square maps to the hemisphere so that equal areas have equal shares of the cosine; it is divided into `side` × `side` cells.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "base/vec.h"
#include "sampling/warp.h"

namespace eclat {

class CosineGuide {
  public:
    static constexpr uint32_t side = 8, cells = side * side;

    /// All cells have the factor 1.
    CosineGuide() : CosineGuide(std::array<float, cells>{}) {}
    /// Makes cells with factors in proportion to `weights`, row by row, none negative; all 1 if their sum is 0.
    explicit CosineGuide(const std::array<float, cells>& weights) {
        float total = 0;
        for (uint32_t row = 0; row < side; ++row) {
            for (uint32_t column = 0; column < side; ++column) total += weights[row * side + column];
            until_row_[row] = total;
        }
        if (!(total > 0)) {
            factors_.fill(1);
            for (uint32_t i = 0; i < cells; ++i) until_[i] = static_cast<float>(i % side + 1) / side;
            for (uint32_t row = 0; row < side; ++row) until_row_[row] = static_cast<float>(row + 1) / side;
            return;
        }
        for (uint32_t row = 0; row < side; ++row) {
            float sum = 0;
            for (uint32_t column = 0; column < side; ++column) {
                const uint32_t i = row * side + column;
                factors_[i] = weights[i] * (cells / total);
                until_[i] = sum += weights[i];
            }
            for (uint32_t column = 0; column < side; ++column) {
                float& until = until_[row * side + column];
                until = sum > 0 ? until / sum : static_cast<float>(column + 1) / side;
            }
            until_row_[row] /= total;
        }
    }

    struct Place {
        Vec2 at;       // on the square
        float factor;  // density there over the uniform one
    };
    /// Maps uniform numbers to places distributed as the guide is.
    Place sample(Vec2 u) const {
        const uint32_t row = choose(&until_row_[0], u.y);
        const uint32_t column = choose(&until_[row * side], u.x);
        return {{(static_cast<float>(column) + u.x) / side, (static_cast<float>(row) + u.y) / side},
                factors_[row * side + column]};
    }
    /// Returns the density of the direction over that of the cosine.
    float factor(Vec3 w) const { return factors_[cell_of(w)]; }

    /// Returns the cell of a direction: the inverse of `square_to_cosine_hemisphere`. Any vector has one.
    static uint32_t cell_of(Vec3 w) {
        const float radius = std::sqrt(w.x * w.x + w.y * w.y);
        const bool x_leads = std::abs(w.x) > std::abs(w.y);
        const float leading = x_leads ? w.x : w.y, other = x_leads ? w.y : w.x;
        const float a = std::copysign(radius, leading);
        const float b = leading == 0 ? 0 : a * (4 / pi) * std::atan(other / leading);
        return cell(x_leads ? b : a) * side + cell(x_leads ? a : b);
    }

  private:
    static uint32_t cell(float x) {
        // The order of the arguments makes NaN 0, so that no direction lies outside.
        const float at = std::max(0.0f, (0.5f * x + 0.5f) * side);
        return static_cast<uint32_t>(std::min(at, static_cast<float>(side) - 0.5f));
    }
    /// Returns the interval of `until` in which u lies, and makes u uniform in it.
    static uint32_t choose(const float* until, float& u) {
        uint32_t i = 0;
        while (i + 1 < side && u >= until[i]) ++i;
        const float from = i > 0 ? until[i - 1] : 0, width = until[i] - from;
        u = width > 0 ? clamp((u - from) / width, 0, below_one) : 0.5f;
        return i;
    }

    std::array<float, cells> factors_;
    std::array<float, cells> until_;     // share of its row up to and including the cell
    std::array<float, side> until_row_;  // share of all up to and including the row
};

}  // namespace eclat
