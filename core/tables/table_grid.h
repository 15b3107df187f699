// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The nodes of a table of reflection, over view direction and roughness, and which of them surround a query: what brdf_table.h
// fills and radiance_tables.h reads in single precision.
// Held to      tests/core/tables/test_brdf_table.cpp

#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "base/vec.h"

namespace eclat {

/// A node and its weight in the linear interpolation.
struct TableCorner {
    size_t node;
    float weight;
};

class TableCorners {
  public:
    void add(size_t node, float weight) { corners_[count_++] = {node, weight}; }
    bool empty() const { return count_ == 0; }
    size_t size() const { return count_; }
    TableCorner& operator[](size_t i) { return corners_[i]; }
    const TableCorner* begin() const { return corners_.data(); }
    const TableCorner* end() const { return corners_.data() + count_; }

  private:
    std::array<TableCorner, 8> corners_;
    size_t count_ = 0;
};

class TableGrid {
  public:
    TableGrid() = default;
    /// `alphas` are the increasing roughnesses of the lobes; there is one if the table does not depend on roughness.
    TableGrid(int resolution, bool isotropic, std::vector<float> alphas)
        : resolution_(size_t(resolution)), isotropic_(isotropic), alphas_(std::move(alphas)) {}

    bool isotropic() const { return isotropic_; }
    /// Nodes of a lobe: over |p|, or the quadrant's rows.
    size_t directions() const { return isotropic_ ? resolution_ : resolution_ * resolution_; }

    /// Returns the position of `wo`, with wo.z > 0, in the table, or nothing if the roughness is below the least of
    /// several.
    TableCorners around(Vec3 wo, float alpha) const {
        TableCorners out;
        const size_t n = resolution_;
        const float x = wo.x / (1 + wo.z), y = wo.y / (1 + wo.z);
        if (isotropic_) {
            const Position r = position(std::sqrt(x * x + y * y));
            out.add(r.index, 1 - r.fraction);
            out.add(r.index + 1, r.fraction);
        } else {
            const Position a = position(std::abs(x)), b = position(std::abs(y));
            out.add(b.index * n + a.index, (1 - a.fraction) * (1 - b.fraction));
            out.add(b.index * n + a.index + 1, a.fraction * (1 - b.fraction));
            out.add((b.index + 1) * n + a.index, (1 - a.fraction) * b.fraction);
            out.add((b.index + 1) * n + a.index + 1, a.fraction * b.fraction);
        }
        if (alphas_.size() == 1) return out;
        if (!(alpha >= alphas_.front())) return {};
        size_t i = 0;
        while (i + 2 < alphas_.size() && alpha > alphas_[i + 1]) ++i;
        const float t = clamp((alpha - alphas_[i]) / (alphas_[i + 1] - alphas_[i]), 0, 1);
        const size_t count = out.size();
        for (size_t k = 0; k < count; ++k) {
            out.add((i + 1) * directions() + out[k].node, t * out[k].weight);
            out[k] = {i * directions() + out[k].node, (1 - t) * out[k].weight};
        }
        return out;
    }

  private:
    struct Position {
        size_t index;
        float fraction;
    };
    Position position(float x) const {
        const float scaled = clamp(x, 0, 1) * float(resolution_ - 1);
        const size_t index = std::min(size_t(scaled), resolution_ - 2);
        return {index, scaled - float(index)};
    }

    size_t resolution_ = 2;
    bool isotropic_ = true;
    std::vector<float> alphas_;
};

}  // namespace eclat
