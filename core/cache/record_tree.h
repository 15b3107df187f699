// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Spheres around records, in a bounding volume hierarchy: which records may serve a point, which lie near one.
// Built anew after each pass from the records in index order, with ties broken by index, so that every lookup visits
// the same records in the same order whatever the number of threads.

#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "base/vec.h"

namespace eclat {

class SphereTree {
  public:
    struct Sphere {
        Vec3 center;
        float radius;
    };

    SphereTree() = default;
    explicit SphereTree(std::vector<Sphere> spheres) : spheres_(std::move(spheres)), order_(spheres_.size()) {
        std::iota(order_.begin(), order_.end(), 0u);
        nodes_.reserve(spheres_.size());
        if (!spheres_.empty()) build(0, static_cast<uint32_t>(spheres_.size()));
        // Spheres that are visited together shall lie together.
        const std::vector<Sphere> unsorted = spheres_;
        for (size_t slot = 0; slot < order_.size(); ++slot) spheres_[slot] = unsorted[order_[slot]];
    }

    /// The index of the sphere in each slot: what lookups name is the slot.
    const std::vector<uint32_t>& order() const { return order_; }

    /// Calls `f(slot, squared distance)` for each sphere that holds `p`.
    template <class F>
    void for_each_around(Vec3 p, F&& f) const {
        visit(p, 0, [&](uint32_t slot, float d2) {
            if (d2 < sqr(spheres_[slot].radius)) f(slot, d2);
        });
    }

    /// Calls `f(slot, squared distance)` for each sphere whose surface or inside is closer than `reach` to `p`.
    template <class F>
    void for_each_near(Vec3 p, float reach, F&& f) const {
        visit(p, reach, [&](uint32_t slot, float d2) {
            if (d2 < sqr(spheres_[slot].radius + reach)) f(slot, d2);
        });
    }

  private:
    static constexpr uint32_t leaf_size = 4;
    struct Node {
        Vec3 low, high;
        uint32_t begin = 0;  // of a leaf's spheres; of an inner node: its second child, the first follows it
        uint32_t count = 0;  // 0: inner node
    };

    uint32_t build(uint32_t begin, uint32_t end) {
        const auto index = static_cast<uint32_t>(nodes_.size());
        nodes_.emplace_back();
        Vec3 low{infinity, infinity, infinity}, high = -low, center_low = low, center_high = high;
        for (uint32_t i = begin; i < end; ++i) {
            const Sphere& s = spheres_[order_[i]];
            const Vec3 r{s.radius, s.radius, s.radius};
            low = min(low, s.center - r);
            high = max(high, s.center + r);
            center_low = min(center_low, s.center);
            center_high = max(center_high, s.center);
        }
        nodes_[index].low = low;
        nodes_[index].high = high;
        if (end - begin <= leaf_size) {
            nodes_[index].begin = begin;
            nodes_[index].count = end - begin;
            return index;
        }
        const Vec3 extent = center_high - center_low;
        const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
        const uint32_t middle = begin + (end - begin) / 2;
        std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](uint32_t a, uint32_t b) {
            const float x = spheres_[a].center[axis], y = spheres_[b].center[axis];
            return x != y ? x < y : a < b;
        });
        build(begin, middle);
        nodes_[index].begin = build(middle, end);
        return index;
    }

    template <class F>
    void visit(Vec3 p, float reach, F&& f) const {
        if (nodes_.empty()) return;
        uint32_t stack[64];
        int depth = 0;
        stack[depth++] = 0;
        while (depth > 0) {
            const uint32_t index = stack[--depth];
            const Node& node = nodes_[index];
            if (p.x < node.low.x - reach || p.y < node.low.y - reach || p.z < node.low.z - reach ||
                p.x > node.high.x + reach || p.y > node.high.y + reach || p.z > node.high.z + reach)
                continue;
            if (node.count == 0) {
                stack[depth++] = node.begin;
                stack[depth++] = index + 1;
                continue;
            }
            for (uint32_t i = node.begin; i < node.begin + node.count; ++i)
                f(i, length_squared(p - spheres_[i].center));
        }
    }

    std::vector<Sphere> spheres_;
    std::vector<uint32_t> order_;
    std::vector<Node> nodes_;
};

}  // namespace eclat
