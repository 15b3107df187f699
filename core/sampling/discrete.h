// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Discrete distributions: an alias table (which light?), piecewise-constant functions on [0, 1) and [0, 1)² (where in
// the sky?). Built once, in double; read by many threads.

#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "base/error.h"
#include "sampling/warp.h"

namespace eclat {

struct DiscreteSample {
    uint32_t index = 0;
    float pdf_discrete = 0;  // 0 if there is nothing to choose from
    float remapped = 0;      // a uniform number made from the unused part of the random number
};

/// Chooses i with a probability close to weight_i / Σ weight in constant time [Walker77, Vose91].
/// Random numbers are multiples of 2^-24, and so are probabilities: weights are rounded to counts of these 2^24
/// numbers, at least one if the weight is positive, and the table is computed in integers. `pdf_discrete` is therefore
/// exactly the frequency of an index, for any number of entries.
class AliasTable {
  public:
    AliasTable() = default;

    explicit AliasTable(std::span<const double> weights) {
        require(weights.size() <= max_size,
                "alias table: expected at most 4194304 entries, got " + std::to_string(weights.size()));
        std::vector<uint32_t> counts = share_out(weights);
        if (counts.empty()) return;
        pdf_.resize(weights.size());
        for (size_t i = 0; i < weights.size(); ++i) pdf_[i] = static_cast<float>(counts[i]) * 0x1p-24f;
        counts.resize(std::bit_ceil(counts.size()), 0);
        fill(counts);
    }

    bool empty() const { return entries_.empty(); }

    DiscreteSample sample(float u) const {
        if (empty()) return {};
        const float scaled = std::clamp(u, 0.0f, below_one) * 0x1p24f;
        const uint32_t bits = static_cast<uint32_t>(scaled);
        const Entry& entry = entries_[bits >> shift_];
        const uint32_t offset = bits & (capacity() - 1);
        // The bits below the 24th are used for the remapped number.
        const float rest = scaled - static_cast<float>(bits);
        if (offset < entry.threshold) {
            return {bits >> shift_, entry.pdf, remap(offset, rest, entry.threshold)};
        }
        return {entry.alias, entry.alias_pdf, remap(offset - entry.threshold, rest, capacity() - entry.threshold)};
    }

    float pdf_discrete(uint32_t index) const { return empty() ? 0 : pdf_[index]; }

  private:
    // The bucket's numbers below `threshold` give its own index, and the others that of its alias.
    struct Entry {
        uint32_t threshold = 0, alias = 0;
        float pdf = 0, alias_pdf = 0;
    };

    static constexpr uint32_t total = 1u << 24;
    static constexpr size_t max_size = 1u << 22;  // leaves four counts an entry on average

    uint32_t capacity() const { return 1u << shift_; }

    static float remap(uint32_t offset, float rest, uint32_t range) {
        return std::min((static_cast<float>(offset) + rest) / static_cast<float>(range), below_one);
    }

    /// Returns counts whose sum is 2^24: one for each positive weight, and the others by rounding the cumulative sum.
    static std::vector<uint32_t> share_out(std::span<const double> weights) {
        double sum = 0;
        uint32_t positive = 0;
        for (const double w : weights) {
            require(w >= 0 && w < 0x1p1000, "alias table: weights must be finite and not negative");
            sum += w;
            positive += w > 0;
        }
        if (positive == 0) return {};
        std::vector<uint32_t> counts(weights.size(), 0);
        const double rest = total - positive;
        double running = 0;
        uint32_t given = 0;
        for (uint32_t i = 0; i < weights.size(); ++i) {
            if (weights[i] == 0) continue;
            running += weights[i];
            const uint32_t until = static_cast<uint32_t>(std::min(rest, running / sum * rest + 0.5));
            counts[i] = 1 + until - given;
            given = until;
        }
        return counts;
    }

    /// Fills each bucket with the excess of one other entry [Vose91]; in integers there is no remainder.
    void fill(std::vector<uint32_t> counts) {
        const size_t size = counts.size();
        shift_ = 24 - static_cast<uint32_t>(std::countr_zero(size));
        entries_.resize(size);
        std::vector<uint32_t> poor, rich;
        for (uint32_t i = 0; i < size; ++i) (counts[i] < capacity() ? poor : rich).push_back(i);
        while (!poor.empty()) {
            const uint32_t low = poor.back(), high = rich.back();
            poor.pop_back();
            entries_[low] = {counts[low], high, pdf_or_zero(low), pdf_or_zero(high)};
            counts[high] -= capacity() - counts[low];
            if (counts[high] < capacity()) {
                rich.pop_back();
                poor.push_back(high);
            }
        }
        for (const uint32_t i : rich) entries_[i] = {capacity(), i, pdf_or_zero(i), pdf_or_zero(i)};
    }

    float pdf_or_zero(uint32_t i) const { return i < pdf_.size() ? pdf_[i] : 0; }

    std::vector<Entry> entries_;
    std::vector<float> pdf_;
    uint32_t shift_ = 24;
};

namespace detail {

/// A cumulative distribution of n cells as n + 1 nodes, with a shortcut into it [ChenAsau74]: u begins its search at
/// node ⌊u n⌋'s `first` and ends it at the next one's, on average a step away. A plain binary search would miss the
/// cache at every step.
struct CdfNode {
    float below = 0;     // the cells before this one
    uint32_t first = 0;  // the last node with below ≤ this node's index / n
};

/// Fills n + 1 `nodes` from n weights and returns their total.
template <class T>
double cumulate(std::span<const T> weights, CdfNode* nodes) {
    double total = 0;
    for (const T w : weights) total += w;
    if (!(total > 0)) return 0;
    const size_t n = weights.size();
    double running = 0;
    for (size_t i = 0; i < n; ++i) {
        running += weights[i];
        nodes[i + 1].below = static_cast<float>(running / total);
    }
    uint32_t last = 0;
    for (size_t k = 0; k <= n; ++k) {
        const double share = static_cast<double>(k) / static_cast<double>(n);
        while (last + 1 < n && nodes[last + 1].below <= share) ++last;
        nodes[k].first = last;
    }
    return total;
}

/// Returns the node at which the search for u, which is below 1, begins.
inline uint32_t shortcut(uint32_t size, float u) {
    return std::min(static_cast<uint32_t>(u * static_cast<float>(size)), size - 1);
}

/// The cells among which u lies.
struct Bracket {
    uint32_t first = 0, last = 0;

    uint32_t middle() const { return (first + last + 1) / 2; }
};

inline Bracket bracket(const CdfNode* nodes, uint32_t size, float u) {
    const uint32_t k = shortcut(size, u);
    return {nodes[k].first, nodes[k + 1].first};
}

/// Finds the cell i with nodes[i].below ≤ u < nodes[i + 1].below, and the position of u in it.
inline DiscreteSample find_cell(const CdfNode* nodes, Bracket among, float u) {
    auto [i, last] = among;
    while (i < last) {
        const uint32_t middle = Bracket{i, last}.middle();
        if (nodes[middle].below <= u) {
            i = middle;
        } else {
            last = middle - 1;
        }
    }
    const float mass = nodes[i + 1].below - nodes[i].below;
    return {i, mass, mass > 0 ? clamp((u - nodes[i].below) / mass, 0, below_one) : 0};
}

inline DiscreteSample find_cell(const CdfNode* nodes, uint32_t size, float u) {
    u = std::clamp(u, 0.0f, below_one);
    return find_cell(nodes, bracket(nodes, size, u), u);
}

}  // namespace detail

/// A density on [0, 1) that is constant on n equal cells, sampled by inversion (which keeps the order of u).
class PiecewiseConstant1D {
  public:
    PiecewiseConstant1D() = default;
    explicit PiecewiseConstant1D(std::span<const double> weights) : nodes_(weights.size() + 1) {
        total_ = detail::cumulate(weights, nodes_.data());
    }

    uint32_t size() const { return nodes_.empty() ? 0 : static_cast<uint32_t>(nodes_.size() - 1); }
    double total() const { return total_; }

    /// The cell, its probability and the place in the cell; x is (index + remapped) / size.
    DiscreteSample sample(float u) const {
        return total_ > 0 ? detail::find_cell(nodes_.data(), size(), u) : DiscreteSample{};
    }

    float pdf_discrete(uint32_t index) const { return nodes_[index + 1].below - nodes_[index].below; }
    float pdf(float x) const {
        const uint32_t n = size();
        return pdf_discrete(std::min(static_cast<uint32_t>(x * static_cast<float>(n)), n - 1)) * static_cast<float>(n);
    }

  private:
    std::vector<detail::CdfNode> nodes_;
    double total_ = 0;
};

/// The same on a grid of height × width cells of [0, 1)²: first the row by u.y, then the cell in it by u.x.
class PiecewiseConstant2D {
  public:
    struct Cell {
        uint32_t column = 0, row = 0;
        Vec2 offset;             // position in the cell, in [0, 1)²
        float pdf_discrete = 0;  // probability of the cell; times width · height it is the density on the unit square
    };

    PiecewiseConstant2D() = default;

    /// `weights` in row-major order.
    PiecewiseConstant2D(uint32_t width, uint32_t height, std::span<const float> weights)
        : width_(width), height_(height), conditional_(size_t(width + 1) * height) {
        std::vector<double> rows(height);
        for (uint32_t y = 0; y < height; ++y) {
            rows[y] = detail::cumulate(weights.subspan(size_t(y) * width, width), row(y));
        }
        marginal_ = PiecewiseConstant1D(rows);
    }

    double total() const { return marginal_.total(); }

    Cell sample(Vec2 u) const {
        Search search = find_row(u);
        narrow(search);
        return find_cell(search);
    }

    /// `sample` in three steps. Each step prefetches what the next one reads, so that a caller who takes each step for
    /// many samples in turn hardly waits for memory.
    struct Search {
        DiscreteSample row;
        float u = 0;
        detail::Bracket among;
    };
    Search find_row(Vec2 u) const {
        Search out{marginal_.sample(u.y), std::clamp(u.x, 0.0f, below_one), {}};
        if (out.row.pdf_discrete > 0) __builtin_prefetch(row(out.row.index) + detail::shortcut(width_, out.u));
        return out;
    }
    void narrow(Search& search) const {
        if (search.row.pdf_discrete == 0) return;
        const detail::CdfNode* nodes = row(search.row.index);
        search.among = detail::bracket(nodes, width_, search.u);
        __builtin_prefetch(nodes + search.among.middle());
    }
    Cell find_cell(const Search& search) const {
        const DiscreteSample& y = search.row;
        if (y.pdf_discrete == 0) return {};
        const DiscreteSample x = detail::find_cell(row(y.index), search.among, search.u);
        return {x.index, y.index, {x.remapped, y.remapped}, x.pdf_discrete * y.pdf_discrete};
    }

    float pdf_discrete(uint32_t column, uint32_t y) const {
        return marginal_.pdf_discrete(y) * (row(y)[column + 1].below - row(y)[column].below);
    }

  private:
    detail::CdfNode* row(uint32_t y) { return conditional_.data() + size_t(y) * (width_ + 1); }
    const detail::CdfNode* row(uint32_t y) const { return conditional_.data() + size_t(y) * (width_ + 1); }

    uint32_t width_ = 0, height_ = 0;
    PiecewiseConstant1D marginal_;
    std::vector<detail::CdfNode> conditional_;
};

}  // namespace eclat
