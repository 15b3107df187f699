// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A bounding volume hierarchy with eight children per node of the spheres around records, which finds the records that
// may serve a point or lie near it. It is rebuilt after each pass from the records in index order, with ties broken by
// index, so that every lookup visits the same records in the same order with any number of threads.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "base/lanes.h"
#include "base/vec.h"

namespace eclat {

class SphereTree {
  public:
    /// A sphere, or the part of a sphere that is within `height` of the plane through its centre.
    struct Sphere {
        Vec3 center;
        float radius;
        Vec3 normal{};
        float height = infinity;
    };
    static constexpr uint32_t vacant = ~0u;

    SphereTree() = default;
    explicit SphereTree(std::span<const Sphere> spheres) {
        if (spheres.empty()) return;
        std::vector<uint32_t> indices(spheres.size());
        std::iota(indices.begin(), indices.end(), 0u);
        std::vector<Box> boxes;
        boxes.reserve(spheres.size());
        for (const Sphere& s : spheres) boxes.push_back(box_of(s));
        order_.reserve(spheres.size() + width);
        root_ = build({spheres, boxes}, indices);
    }

    static constexpr uint32_t width = lane_count;  // number of slots of a leaf

    /// The index of the sphere in each slot, or `vacant` if the slot is empty. Lookups return slots.
    const std::vector<uint32_t>& order() const { return order_; }

    /// Calls `f(slot, squared distance)` for each sphere whose surface or interior is closer than `reach` to `p`. It is
    /// also called for some spheres cut by planes that are slightly farther away.
    template <class F>
    void for_each_near(Vec3 p, float reach, F&& f) const {
        for_each_leaf_near(p, reach, [&](uint32_t leaf) {
            float d2[width];
            for_each_lane(leaves_[leaf].near(p, reach, d2), [&](uint32_t lane) { f(leaf * width + lane, d2[lane]); });
        });
    }

    /// Calls `f(leaf)` for each leaf that may contain such spheres. Its `width` slots start at width · leaf.
    template <class F>
    void for_each_leaf_near(Vec3 p, float reach, F&& f) const {
        if (order_.empty()) return;
        uint32_t stack[width * 16];  // a tree deeper than 16 levels would not fit into any memory
        uint32_t depth = 0;
        stack[depth++] = root_;
        while (depth > 0) {
            const uint32_t entry = stack[--depth];
            if (entry & leaf_bit) {
                f(entry & ~leaf_bit);
            } else {
                const Node& node = nodes_[entry];
                for_each_lane(node.near(p, reach), [&](uint32_t lane) { stack[depth++] = node.child[lane]; });
            }
        }
    }

  private:
    static constexpr uint32_t leaf_bit = 1u << 31;

    struct alignas(32) Node {
        float low[3][width], high[3][width];  // bounds of the children, inverted for missing ones
        uint32_t child[width];

        Lanes near(Vec3 p, float reach) const {
            float outside[width];  // largest distance from the box along any axis
            for (uint32_t i = 0; i < width; ++i) {
                const float x = std::max(low[0][i] - p.x, p.x - high[0][i]);
                const float y = std::max(low[1][i] - p.y, p.y - high[1][i]);
                const float z = std::max(low[2][i] - p.z, p.z - high[2][i]);
                outside[i] = std::max(std::max(x, y), z);
            }
            return lanes_where([&](uint32_t i) { return outside[i] <= reach; });
        }
    };

    struct alignas(32) Leaf {
        float x[width], y[width], z[width], radius[width];  // spheres; infinitely far away in empty slots
        float nx[width], ny[width], nz[width], height[width];

        Lanes near(Vec3 p, float reach, float* d2) const {
            float off[width];
            for (uint32_t i = 0; i < width; ++i) {
                const float dx = p.x - x[i], dy = p.y - y[i], dz = p.z - z[i];
                d2[i] = sqr(dx) + sqr(dy) + sqr(dz);
                off[i] = std::fabs(dx * nx[i] + dy * ny[i] + dz * nz[i]);
            }
            return lanes_where(
                [&](uint32_t i) { return (d2[i] < sqr(radius[i] + reach)) & (off[i] <= height[i] + reach); });
        }
    };

    struct Box {
        Vec3 low{infinity, infinity, infinity}, high{-infinity, -infinity, -infinity};

        void hold(const Box& other) {
            low = min(low, other.low);
            high = max(high, other.high);
        }
        /// Returns half of the surface area, to which the probability that a lookup enters the box is proportional.
        float area() const {
            const Vec3 d = high - low;
            return d.x * d.y + d.y * d.z + d.z * d.x;
        }
    };
    struct Part {
        std::span<uint32_t> indices;
        Box box;
        uint32_t entry;
    };

    /// The data from which a tree is built.
    struct Input {
        std::span<const Sphere> spheres;
        std::span<const Box> boxes;  // bounds of each sphere

        Box around(std::span<const uint32_t> indices) const {
            Box box;
            for (uint32_t i : indices) box.hold(boxes[i]);
            return box;
        }
        Box of_centers(std::span<const uint32_t> indices) const {
            Box box;
            for (uint32_t i : indices) box.hold({spheres[i].center, spheres[i].center});
            return box;
        }
    };

    static Box box_of(const Sphere& s) {
        // The extent along an axis depends on the cosine of the angle between the axis and the normal.
        const auto extent = [&](float cosine) {
            const float across = std::fabs(cosine);
            if (s.height >= s.radius * across) return s.radius;
            return s.height * across + std::sqrt((sqr(s.radius) - sqr(s.height)) * std::max(0.0f, 1 - sqr(across)));
        };
        const Vec3 r{extent(s.normal.x), extent(s.normal.y), extent(s.normal.z)};
        return {s.center - r, s.center + r};
    }

    struct Split {
        int axis = 0;
        size_t first = 0;  // number of spheres in the first part
        float cost = infinity;
    };

    /// Finds the best split along one axis, at the border of one of the bins of the centres.
    static Split best_split(const Input& input, std::span<const uint32_t> indices, int axis, float low, float high) {
        constexpr size_t bin_count = 16;
        struct Bin {
            Box box;
            size_t count = 0;
        } bins[bin_count], before[bin_count];
        Split best{axis};
        if (!(high > low)) return best;
        const float scale = static_cast<float>(bin_count) / (high - low);
        for (uint32_t i : indices) {
            const auto at = static_cast<size_t>(std::max(0.0f, (input.spheres[i].center[axis] - low) * scale));
            Bin& bin = bins[std::min(at, bin_count - 1)];
            bin.box.hold(input.boxes[i]);
            ++bin.count;
        }
        Bin sum;
        for (size_t i = 0; i < bin_count; ++i) {
            before[i] = sum;
            sum.box.hold(bins[i].box);
            sum.count += bins[i].count;
        }
        sum = {};
        for (size_t i = bin_count - 1; i > 0; --i) {
            sum.box.hold(bins[i].box);
            sum.count += bins[i].count;
            if (sum.count == 0 || before[i].count == 0) continue;
            const float cost = before[i].box.area() * static_cast<float>(before[i].count) +
                               sum.box.area() * static_cast<float>(sum.count);
            if (cost < best.cost) best.cost = cost, best.first = before[i].count;
        }
        return best;
    }

    /// Splits a range of spheres in two so that the surface area heuristic [MacDonaldBooth90], the sum over both parts
    /// of the area of the box times the number of spheres, is least. The sizes are rounded to whole leaves.
    static std::span<uint32_t> take_part(const Input& input, std::span<uint32_t>& indices) {
        const Box centers = input.of_centers(indices);
        Split best{0, indices.size() / 2};
        for (int axis = 0; axis < 3; ++axis) {
            const Split split = best_split(input, indices, axis, centers.low[axis], centers.high[axis]);
            if (split.cost < best.cost) best = split;
        }
        const size_t leaves = (indices.size() + width - 1) / width;
        const size_t middle = width * std::clamp<size_t>((best.first + width / 2) / width, 1, leaves - 1);
        std::nth_element(indices.begin(), indices.begin() + static_cast<ptrdiff_t>(middle), indices.end(),
                         [&](uint32_t a, uint32_t b) {
                             const float x = input.spheres[a].center[best.axis], y = input.spheres[b].center[best.axis];
                             return x != y ? x < y : a < b;
                         });
        const auto part = indices.subspan(middle);
        indices = indices.first(middle);
        return part;
    }

    /// Builds the node or leaf that contains the spheres of `indices` and returns its entry.
    uint32_t build(const Input& input, std::span<uint32_t> indices) {
        if (indices.size() <= width) return build_leaf(input.spheres, indices);
        // The part with the largest box is split next, until the node has all its children.
        std::vector<Part> parts{{indices, input.around(indices), 0}};
        while (parts.size() < width) {
            Part* largest = nullptr;
            for (Part& part : parts)
                if (part.indices.size() > width && (!largest || part.box.area() > largest->box.area())) largest = &part;
            if (!largest) break;
            const auto half = take_part(input, largest->indices);
            largest->box = input.around(largest->indices);
            parts.push_back({half, input.around(half), 0});
        }
        const auto index = static_cast<uint32_t>(nodes_.size());
        nodes_.emplace_back();
        for (Part& part : parts) part.entry = build(input, part.indices);
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
            leaf.nx[i] = s.normal.x;
            leaf.ny[i] = s.normal.y;
            leaf.nz[i] = s.normal.z;
            leaf.height[i] = s.height;
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
