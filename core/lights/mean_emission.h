// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The mean of a textured emission over a triangle, from which its power and the probability of choosing it follow.

#pragma once

#include <vector>

#include "scene/texture.h"

namespace eclat {

class MeanEmission {
  public:
    /// For a textured `emission`, which must outlive this.
    explicit MeanEmission(const Value& emission);

    struct Estimate {
        Color mean;         // radiance, by point samples
        double weight = 0;  // luminance for the odds: zero only where no texel within the triangle's reach emits
    };
    /// `uv0` … `uv2` of the triangle's corners.
    Estimate over(Vec2 uv0, Vec2 uv1, Vec2 uv2) const;

  private:
    struct Range {
        uint32_t begin, end;  // blocks
    };
    Range reach(float a, float b, float c, uint32_t size, Wrap wrap) const;
    uint32_t lit_blocks(Range x, Range y) const;

    Value emission_;
    uint32_t block_;                // texels a side
    uint32_t columns_, rows_;       // of blocks
    std::vector<uint32_t> counts_;  // lit blocks above and to the left: a summed-area table, exact in integers
    double lit_mean_ = 0;           // luminance of the texels that emit
};

}  // namespace eclat
