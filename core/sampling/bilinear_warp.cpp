// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "sampling/bilinear_warp.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace eclat {

namespace {

/// The place among nodes: the interval, and the position in it, which is clamped to 0..1.
std::pair<size_t, float> among(const std::vector<float>& nodes, float x) {
    if (nodes.size() < 2) return {0, 0.0f};
    const auto above = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, x);
    const auto i = static_cast<size_t>(above - nodes.begin()) - 1;
    return {i, clamp((x - nodes[i]) / (nodes[i + 1] - nodes[i]), 0, 1)};
}

/// Solves a t + (b − a) t² / 2 = area for t in 0..1.
float position_of_area(float area, float a, float b) {
    const float root = safe_sqrt(a * a + 2 * area * (b - a));
    return a + root > 0 ? clamp(2 * area / (a + root), 0, 1) : 0;
}

/// The greatest i ≤ last with below(i) ≤ x, for a function that does not decrease.
template <class Below>
size_t interval(size_t last, float x, const Below& below) {
    size_t low = 0, high = last + 1;
    while (high - low > 1) {
        const size_t middle = (low + high) / 2;
        (below(middle) <= x ? low : high) = middle;
    }
    return low;
}

}  // namespace

Slices slices_among(const ParameterNodes& nodes, float outer, float inner) {
    const auto [i, s] = among(nodes[0], outer);
    const auto [j, t] = among(nodes[1], inner);
    const size_t inner_count = nodes[1].size();
    Slices out;
    for (const auto& [row, weight_of_row] : {std::pair(i, 1 - s), std::pair(i + 1, s)})
        for (const auto& [column, weight_of_column] : {std::pair(j, 1 - t), std::pair(j + 1, t)}) {
            const float weight = weight_of_row * weight_of_column;
            if (!(weight > 0)) continue;
            out.index[size_t(out.count)] = row * inner_count + column;
            out.weight[size_t(out.count++)] = weight;
        }
    return out;
}

BilinearTable::BilinearTable(size_t width, size_t height, size_t slices, std::span<const float> values)
    : width_(width), height_(height), values_(values.begin(), values.end()) {
    require(width >= 2 && height >= 2 && values.size() == width * height * slices,
            "measured BRDF: expected tables of at least 2 x 2 nodes for all parameters");
    require(std::ranges::all_of(values, [](float v) { return std::isfinite(v); }),
            "measured BRDF: expected finite values");
}

BilinearTable::Cell BilinearTable::cell_of(Vec2 at) const {
    const float x = clamp(at.x, 0, 1) * static_cast<float>(width_ - 1),
                y = clamp(at.y, 0, 1) * static_cast<float>(height_ - 1);
    const size_t column = std::min(static_cast<size_t>(x), width_ - 2),
                 row = std::min(static_cast<size_t>(y), height_ - 2);
    return {column, row, x - static_cast<float>(column), y - static_cast<float>(row)};
}

float BilinearTable::eval(Vec2 at, const Slices& slices) const {
    const auto [column, row, x, y] = cell_of(at);
    const float above = std::lerp(node(column, row, slices), node(column + 1, row, slices), x);
    const float below = std::lerp(node(column, row + 1, slices), node(column + 1, row + 1, slices), x);
    return std::lerp(above, below, y);
}

BilinearWarp::BilinearWarp(size_t width, size_t height, size_t slices, std::span<const float> values)
    : BilinearTable(width, height, slices, values), conditional_(values.size()), marginal_(height * slices) {
    const double dx = 1.0 / static_cast<double>(width - 1), dy = 1.0 / static_cast<double>(height - 1);
    std::vector<double> along(width * height), down(height);
    for (size_t slice = 0; slice < slices; ++slice) {
        float* value = values_.data() + slice * width * height;
        for (size_t y = 0; y < height; ++y) {
            double sum = 0;
            for (size_t x = 0; x < width; ++x) {
                value[y * width + x] = std::max(value[y * width + x], 0.0f);
                if (x > 0) sum += 0.5 * dx * (double(value[y * width + x - 1]) + double(value[y * width + x]));
                along[y * width + x] = sum;
            }
            down[y] = y == 0 ? 0 : down[y - 1] + 0.5 * dy * (along[y * width - 1] + sum);
        }
        const double total = down[height - 1];
        require(total > 0, "measured BRDF: expected distributions whose integral is above 0");
        for (size_t i = 0; i < width * height; ++i) {
            value[i] = static_cast<float>(value[i] / total);
            conditional_[slice * width * height + i] = static_cast<float>(along[i] / total);
        }
        for (size_t y = 0; y < height; ++y) marginal_[slice * height + y] = static_cast<float>(down[y] / total);
    }
}

BilinearWarp::Result BilinearWarp::sample(Vec2 u, const Slices& slices) const {
    const size_t row = interval(height_ - 2, u.y, [&](size_t i) { return below_row(i, slices); });
    const float first = row_integral(row, slices), second = row_integral(row + 1, slices);
    const auto rows = static_cast<float>(height_ - 1), columns = static_cast<float>(width_ - 1);
    const float y = position_of_area((u.y - below_row(row, slices)) * rows, first, second);
    const auto below = [&](size_t i) {
        return std::lerp(below_column(i, row, slices), below_column(i, row + 1, slices), y);
    };
    const float target = u.x * std::lerp(first, second, y);
    const size_t column = interval(width_ - 2, target, below);
    const auto value = [&](size_t i) { return std::lerp(node(i, row, slices), node(i, row + 1, slices), y); };
    const float left = value(column), right = value(column + 1);
    const float x = position_of_area((target - below(column)) * columns, left, right);
    return {{(static_cast<float>(column) + x) / columns, (static_cast<float>(row) + y) / rows},
            std::lerp(left, right, x)};
}

BilinearWarp::Result BilinearWarp::invert(Vec2 at, const Slices& slices) const {
    const auto [column, row, x, y] = cell_of(at);
    const auto rows = static_cast<float>(height_ - 1), columns = static_cast<float>(width_ - 1);
    const float first = row_integral(row, slices), second = row_integral(row + 1, slices);
    const auto value = [&](size_t i) { return std::lerp(node(i, row, slices), node(i, row + 1, slices), y); };
    const float left = value(column), right = value(column + 1), whole = std::lerp(first, second, y);
    const float before = std::lerp(below_column(column, row, slices), below_column(column, row + 1, slices), y);
    const float along = before + x * (left + 0.5f * x * (right - left)) / columns;
    const float down = below_row(row, slices) + y * (first + 0.5f * y * (second - first)) / rows;
    return {{whole > 0 ? clamp(along / whole, 0, 1) : 0, clamp(down, 0, 1)}, std::lerp(left, right, x)};
}

}  // namespace eclat
