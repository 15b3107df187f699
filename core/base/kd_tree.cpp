// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "base/kd_tree.h"

#include "base/parallel.h"

namespace eclat {

/// Orders ranges of point indices and stores the axis of each split.
class KdTree::Builder {
  public:
    Builder(std::span<const Vec3> points, std::vector<uint32_t>& order, std::vector<uint32_t>& axes)
        : points_(points), order_(order), axes_(axes) {}

    void split(Range range) const {
        Vec3 low{infinity, infinity, infinity}, high = -low;
        for (uint32_t i = range.begin; i < range.end; ++i) {
            low = min(low, points_[order_[i]]);
            high = max(high, points_[order_[i]]);
        }
        const Vec3 side = high - low;
        const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
        const auto before = [&](uint32_t a, uint32_t b) {
            const float x = points_[a][axis], y = points_[b][axis];
            return x < y || (x == y && a < b);
        };
        const auto at = order_.begin();
        std::nth_element(at + range.begin, at + range.middle(), at + range.end, before);
        axes_[range.middle()] = static_cast<uint32_t>(axis);
    }

    void split_all(Range range) const {
        if (range.size() <= leaf_size) {
            std::sort(order_.begin() + range.begin, order_.begin() + range.end);
            return;
        }
        split(range);
        split_all({range.begin, range.middle()});
        split_all({range.middle() + 1, range.end});
    }

  private:
    std::span<const Vec3> points_;
    std::vector<uint32_t>& order_;
    std::vector<uint32_t>& axes_;
};

KdTree::KdTree(std::span<const Vec3> points, int threads) {
    constexpr uint32_t alone = 1 << 14;  // number of points of a range that one thread finishes
    const auto count = static_cast<uint32_t>(points.size());
    std::vector<uint32_t> axes(count, 0);
    order_.resize(count);
    for (uint32_t i = 0; i < count; ++i) order_[i] = i;
    const Builder builder(points, order_, axes);
    std::vector<Range> ranges{{0, count}};
    while (ranges.front().size() > alone) {
        parallel_for(ranges.size(), threads, [&](size_t i) { builder.split(ranges[i]); });
        std::vector<Range> halves;
        for (const Range& r : ranges) {
            halves.push_back({r.begin, r.middle()});
            halves.push_back({r.middle() + 1, r.end});
        }
        ranges.swap(halves);
    }
    parallel_for(ranges.size(), threads, [&](size_t i) { builder.split_all(ranges[i]); });
    nodes_.resize(count);
    for (uint32_t i = 0; i < count; ++i) nodes_[i] = {points[order_[i]], axes[i]};
}

}  // namespace eclat
