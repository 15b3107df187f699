// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A balanced kd-tree of points [Bentley75]: a range of points is split at the median along the longest side of its bounds. The
// median is stored in the middle of the range and the halves on its left and right, so no pointers are needed. Ties of
// coordinates are broken by the order of the points, so the tree is the same on any number of threads.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "base/vec.h"

namespace eclat {

/// The region of a query: a disc around `position` in the plane perpendicular to `normal`.
struct Disc {
    Vec3 position, normal;
    float radius = infinity;

    /// The region is an ellipsoid, whose radius along the normal is smaller by this factor than in the plane: it is
    /// flat, so that it does not extend far up a wall, but thick enough for curved surfaces.
    static constexpr float flatness = 4;
    /// The cosine of the largest angle between the disc's normal and the normals of points that belong to the disc.
    static constexpr float least_cosine = 0.9f;

    /// Returns the squared distance from the centre in the metric of the ellipsoid, which is at least the Euclidean
    /// one.
    float distance2(Vec3 p) const {
        const Vec3 d = p - position;
        return length_squared(d) + (flatness * flatness - 1) * sqr(dot(d, normal));
    }
    bool same_side(Vec3 n) const { return dot(n, normal) >= least_cosine; }
    /// Returns whether a part of a surface with centre `p` and normal `n` may belong to the same sheet as the disc. A
    /// sheet that turns by an angle rises by at most its sine times the distance, so a parallel part at another height,
    /// such as the floor below a rug, is another sheet.
    bool same_sheet(Vec3 p, Vec3 n) const {
        constexpr float rounding = 2e-3f;  // slope that imprecise coordinates may cause
        const Vec3 d = p - position;
        return same_side(n) && std::fabs(dot(d, normal)) <= length(d) * (length(cross(n, normal)) + rounding);
    }
};

struct Neighbor {
    float distance2;  // squared distance in the metric of the disc
    uint32_t index;   // index in the order of the tree

    bool operator<(const Neighbor& o) const {
        return distance2 < o.distance2 || (distance2 == o.distance2 && index < o.index);
    }
};

class KdTree {
  public:
    KdTree() = default;
    KdTree(std::span<const Vec3> points, int threads);

    /// The index of the given point at each position in the tree.
    const std::vector<uint32_t>& order() const { return order_; }

    /// Finds the `count` points nearest to the disc's centre, within its radius, for which `accept(index)` is true, and
    /// writes them to `found` in no particular order. Returns the radius of the disc that they fill, which is the
    /// distance of the next point or, if there is none, the radius of the query.
    template <class Accept>
    float nearest(const Disc& disc, size_t count, std::vector<Neighbor>& found, const Accept& accept) const {
        found.clear();
        // One more point than wanted is searched, because its distance is the radius of the disc of the others.
        Search<Accept> s{disc, accept, count + 1, found, sqr(disc.radius)};
        search(s, 0, static_cast<uint32_t>(nodes_.size()));
        if (found.size() <= count) return disc.radius;
        std::pop_heap(found.begin(), found.end());
        const float radius = std::sqrt(found.back().distance2);
        found.pop_back();
        return radius;
    }

  private:
    static constexpr uint32_t leaf_size = 8;  // number of points that are examined one by one

    struct Node {
        Vec3 position;
        uint32_t axis;
    };
    struct Range {
        uint32_t begin, end;

        uint32_t size() const { return end - begin; }
        uint32_t middle() const { return begin + (end - begin) / 2; }
    };
    class Builder;
    template <class Accept>
    struct Search {
        const Disc& disc;
        const Accept& accept;
        size_t wanted;
        std::vector<Neighbor>& heap;  // a heap with the farthest on top once there are `wanted`
        float radius2;                // squared distance beyond which points are ignored

        void consider(Vec3 position, uint32_t index) {
            const Neighbor candidate{disc.distance2(position), index};
            if (!(candidate.distance2 < radius2) || !accept(index)) return;
            heap.push_back(candidate);
            if (heap.size() < wanted) return;
            if (heap.size() == wanted) {
                std::make_heap(heap.begin(), heap.end());
            } else {
                std::push_heap(heap.begin(), heap.end());
                std::pop_heap(heap.begin(), heap.end());
                heap.pop_back();
            }
            radius2 = heap.front().distance2;
        }
    };

    template <class Accept>
    void search(Search<Accept>& s, uint32_t begin, uint32_t end) const {
        if (end - begin <= leaf_size) {
            for (uint32_t i = begin; i < end; ++i) s.consider(nodes_[i].position, i);
            return;
        }
        const uint32_t middle = Range{begin, end}.middle();
        const int axis = static_cast<int>(nodes_[middle].axis);
        const float beyond = s.disc.position[axis] - nodes_[middle].position[axis];
        const bool low_first = beyond < 0;
        search(s, low_first ? begin : middle + 1, low_first ? middle : end);
        if (!(sqr(beyond) < s.radius2)) return;
        s.consider(nodes_[middle].position, middle);
        search(s, low_first ? middle + 1 : begin, low_first ? end : middle);
    }

    std::vector<uint32_t> order_;
    std::vector<Node> nodes_;
};

}  // namespace eclat
