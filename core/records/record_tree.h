// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Spheres around records, in a bounding volume hierarchy eight wide: which records may serve a point, which lie near one.
// Built anew after each pass from the records in index order, with ties broken by index, so that every lookup visits
// the same records in the same order whatever the number of threads.

#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
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
    static constexpr uint32_t vacant = ~0u;

    SphereTree() = default;
    explicit SphereTree(std::span<const Sphere> spheres) {
        if (spheres.empty()) return;
        std::vector<uint32_t> indices(spheres.size());
        std::iota(indices.begin(), indices.end(), 0u);
        order_.reserve(spheres.size() + width);
        root_ = build(spheres, indices);
    }

    /// The index of the sphere in each slot, `vacant` for none: what lookups name is the slot.
    const std::vector<uint32_t>& order() const { return order_; }

    /// Calls `f(slot, squared distance)` for each sphere that holds `p`.
    template <class F>
    void for_each_around(Vec3 p, F&& f) const {
        for_each_near(p, 0, std::forward<F>(f));
    }

    /// Calls `f(slot, squared distance)` for each sphere whose surface or inside is closer than `reach` to `p`.
    template <class F>
    void for_each_near(Vec3 p, float reach, F&& f) const {
        if (order_.empty()) return;
        uint32_t stack[width * 16];  // 8^16 spheres are deeper than any memory
        uint32_t depth = 0;
        stack[depth++] = root_;
        while (depth > 0) {
            const uint32_t entry = stack[--depth];
            if (entry & leaf_bit) {
                const uint32_t block = entry & ~leaf_bit;
                float d2[width];
                for_each_lane(leaves_[block].near(p, reach, d2),
                              [&](uint32_t lane) { f(block * width + lane, d2[lane]); });
            } else {
                const Node& node = nodes_[entry];
                for_each_lane(node.near(p, reach), [&](uint32_t lane) { stack[depth++] = node.child[lane]; });
            }
        }
    }

  private:
    static constexpr uint32_t width = 8;
    static constexpr uint32_t leaf_bit = 1u << 31;

    /// One byte a lane: what compilers turn a loop of comparisons into with a few vector instructions.
    using Lanes = uint64_t;
    static_assert(std::endian::native == std::endian::little);

    template <class F>
    static void for_each_lane(Lanes lanes, F&& f) {
        for (; lanes != 0; lanes &= lanes - 1) f(static_cast<uint32_t>(std::countr_zero(lanes)) / 8);
    }
    template <class Test>
    static Lanes lanes_where(Test&& test) {
        uint8_t bytes[width];
        for (uint32_t i = 0; i < width; ++i) bytes[i] = test(i);
        Lanes lanes;
        std::memcpy(&lanes, bytes, sizeof lanes);
        return lanes;
    }

    struct alignas(32) Node {
        float low[3][width], high[3][width];  // of the children; inside out where there is none
        uint32_t child[width];

        Lanes near(Vec3 p, float reach) const {
            return lanes_where([&](uint32_t i) {
                return (p.x >= low[0][i] - reach) & (p.x <= high[0][i] + reach) & (p.y >= low[1][i] - reach) &
                       (p.y <= high[1][i] + reach) & (p.z >= low[2][i] - reach) & (p.z <= high[2][i] + reach);
            });
        }
    };

    struct alignas(32) Leaf {
        float x[width], y[width], z[width], radius[width];  // infinitely far where there is no sphere

        Lanes near(Vec3 p, float reach, float* d2) const {
            for (uint32_t i = 0; i < width; ++i) d2[i] = sqr(p.x - x[i]) + sqr(p.y - y[i]) + sqr(p.z - z[i]);
            return lanes_where([&](uint32_t i) { return d2[i] < sqr(radius[i] + reach); });
        }
    };

    struct Box {
        Vec3 low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};
    };
    struct Part {
        std::span<uint32_t> indices;
        Box box;
        uint32_t entry;
    };

    /// Halves a range of spheres across the longest side of their centres' box, at a multiple of a leaf's width.
    static std::span<uint32_t> take_half(std::span<const Sphere> spheres, std::span<uint32_t>& indices) {
        Box centers;
        for (uint32_t i : indices) {
            centers.low = min(centers.low, spheres[i].center);
            centers.high = max(centers.high, spheres[i].center);
        }
        const Vec3 extent = centers.high - centers.low;
        const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
        const size_t middle = (indices.size() / 2 + width - 1) / width * width;
        std::nth_element(indices.begin(), indices.begin() + static_cast<ptrdiff_t>(middle), indices.end(),
                         [&](uint32_t a, uint32_t b) {
                             const float x = spheres[a].center[axis], y = spheres[b].center[axis];
                             return x != y ? x < y : a < b;
                         });
        const auto half = indices.subspan(middle);
        indices = indices.first(middle);
        return half;
    }

    /// Builds what holds the spheres of `indices` and returns its entry, a node or a leaf; `box` grows around them.
    uint32_t build(std::span<const Sphere> spheres, std::span<uint32_t> indices, Box* box = nullptr) {
        if (box)
            for (uint32_t i : indices) {
                const Vec3 r{spheres[i].radius, spheres[i].radius, spheres[i].radius};
                box->low = min(box->low, spheres[i].center - r);
                box->high = max(box->high, spheres[i].center + r);
            }
        if (indices.size() <= width) return build_leaf(spheres, indices);
        std::vector<Part> parts{{indices, {}, 0}};
        for (int halving = 0; halving < 3; ++halving)
            for (size_t i = parts.size(); i-- > 0;)
                if (parts[i].indices.size() > width) {
                    const auto half = take_half(spheres, parts[i].indices);
                    parts.push_back({half, {}, 0});
                }
        const auto index = static_cast<uint32_t>(nodes_.size());
        nodes_.emplace_back();
        for (Part& part : parts) part.entry = build(spheres, part.indices, &part.box);
        Node& node = nodes_[index];
        for (uint32_t i = 0; i < width; ++i) {
            const Box lane = i < parts.size() ? parts[i].box : Box{};
            for (int axis = 0; axis < 3; ++axis) {
                node.low[axis][i] = lane.low[axis];
                node.high[axis][i] = lane.high[axis];
            }
            node.child[i] = i < parts.size() ? parts[i].entry : 0;
        }
        return index;
    }

    uint32_t build_leaf(std::span<const Sphere> spheres, std::span<const uint32_t> indices) {
        const auto block = static_cast<uint32_t>(leaves_.size());
        Leaf& leaf = leaves_.emplace_back();
        for (uint32_t i = 0; i < width; ++i) {
            const bool there = i < indices.size();
            const Sphere s = there ? spheres[indices[i]] : Sphere{{infinity, infinity, infinity}, 0};
            leaf.x[i] = s.center.x;
            leaf.y[i] = s.center.y;
            leaf.z[i] = s.center.z;
            leaf.radius[i] = s.radius;
            order_.push_back(there ? indices[i] : vacant);
        }
        return block | leaf_bit;
    }

    std::vector<Node> nodes_;
    std::vector<Leaf> leaves_;
    std::vector<uint32_t> order_;
    uint32_t root_ = 0;
};

}  // namespace eclat
