// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/radiosity/patches.h"

#include <algorithm>
#include <string>

#include "base/error.h"
#include "methods/radiosity/corners.h"
#include "methods/radiosity/patch_sizes.h"

namespace eclat {

namespace {

Corners corners_of(const PatchNode& node) { return {{node.corner[0], node.corner[1], node.corner[2]}}; }

void set_corners(PatchNode& node, const Corners& corners) {
    for (int k = 0; k < 3; ++k) node.corner[k] = corners.v[k];
    node.longest = corners.longest();
    node.area = corners.area();
    node.center = (corners.v[0] + corners.v[1] + corners.v[2]) * (1.0f / 3);
    node.radius = 0;
    for (const Vec3& v : corners.v) node.radius = std::max(node.radius, length(v - node.center));
}

// This is the largest angle in radians between the normals of a face cluster and their mean, which excludes clusters of
// both sides of a wall.
constexpr float face_cone = 1.1f;

float angle_between(Vec3 a, Vec3 b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

}  // namespace

/// Joins sides into clusters. A range of sides is split at the median along its widest axis, among the three axes of
/// position and the three of the normal, so that clusters are small and their parts face the same way.
struct PatchTree::Builder {
    struct Side {
        uint32_t triangle;
        bool back;
        Vec3 center, normal;

        float key(int axis) const { return axis < 3 ? center[axis] : normal[axis - 3]; }
    };

    /// The weight of normals relative to positions, in units of the range's width in space: normals of ±1 count as half
    /// of the width.
    static constexpr float normal_weight = 0.25f;
    // If face clusters are made, sides that face different ways, such as the two sides of a triangle, are separated
    // first.
    static constexpr float normal_weight_of_faces = 1;

    PatchTree& tree;
    std::vector<Side> sides;
    struct Range {
        size_t begin, end;
    };
    std::vector<Range> ranges;  // range of sides of each node

    int widest(size_t begin, size_t end) const {
        Vec3 low{infinity, infinity, infinity}, high = -low, low_n = low, high_n = high;
        for (size_t i = begin; i < end; ++i) {
            low = min(low, sides[i].center), high = max(high, sides[i].center);
            low_n = min(low_n, sides[i].normal), high_n = max(high_n, sides[i].normal);
        }
        const Vec3 in_space = high - low;
        const float width = length(in_space),
                    weight = width <= tree.face_size_ ? normal_weight_of_faces : normal_weight;
        const Vec3 of_normals = (high_n - low_n) * (weight * width);
        int best = 0;
        for (int axis = 1; axis < 6; ++axis) {
            const auto spread = [&](int a) { return a < 3 ? in_space[a] : of_normals[a - 3]; };
            if (spread(axis) > spread(best)) best = axis;
        }
        // Only normals distinguish the two sides of a triangle.
        return length_squared(in_space) > 0 ? best : 3;
    }

    /// Returns which of the six axis directions is nearest to a normal.
    static int direction(Vec3 n) {
        const Vec3 a{std::fabs(n.x), std::fabs(n.y), std::fabs(n.z)};
        const int axis = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
        return 2 * axis + (n[axis] < 0);
    }

    /// Separates sides that face different ways first, because all sides of a cluster receive the same light.
    void build_directions() {
        const auto turned = [](const Side& a, const Side& b) { return direction(a.normal) < direction(b.normal); };
        std::stable_sort(sides.begin(), sides.end(), turned);
        uint32_t node = 0;
        for (size_t begin = 0; begin < sides.size();) {
            const auto first = sides.begin() + static_cast<ptrdiff_t>(begin);
            const auto end = static_cast<size_t>(std::upper_bound(first, sides.end(), *first, turned) - sides.begin());
            if (end == sides.size()) return build(node, begin, end);
            const uint32_t child = split(node, begin, sides.size());
            build(child, begin, end);
            node = child + 1;
            begin = end;
        }
    }

    uint32_t split(uint32_t node, size_t begin, size_t end) {
        const auto child = static_cast<uint32_t>(tree.nodes_.size());
        tree.nodes_[node].child = child;
        tree.nodes_[node].ends_links = false;
        tree.nodes_.resize(child + 2);
        tree.nodes_[child].parent = tree.nodes_[child + 1].parent = node;
        ranges.resize(tree.nodes_.size());
        ranges[node] = {begin, end};
        return child;
    }

    void build(uint32_t node, size_t begin, size_t end) {
        if (end - begin == 1) {
            const Side& side = sides[begin];
            PatchNode& n = tree.nodes_[node];
            n.triangle = side.triangle;
            n.back = side.back;
            n.normal = side.normal;
            tree.side_[2 * size_t(side.triangle) + side.back] = node;
            return;
        }
        const size_t middle = begin + (end - begin) / 2;
        const int axis = widest(begin, end);
        const auto at = [&](size_t i) { return sides.begin() + static_cast<ptrdiff_t>(i); };
        std::nth_element(at(begin), at(middle), at(end), [axis](const Side& a, const Side& b) {
            const float p = a.key(axis), q = b.key(axis);
            return p != q ? p < q : a.triangle != b.triangle ? a.triangle < b.triangle : a.back < b.back;
        });
        const uint32_t child = split(node, begin, end);
        build(child, begin, middle);
        build(child + 1, middle, end);
    }

    /// Computes the clusters from the last to the first.
    void measure_clusters() {
        std::vector<Vec3> low(tree.nodes_.size()), high(tree.nodes_.size());
        for (size_t i = tree.nodes_.size(); i-- > 0;) {
            PatchNode& n = tree.nodes_[i];
            if (!n.is_cluster()) {
                low[i] = min(n.corner[0], min(n.corner[1], n.corner[2]));
                high[i] = max(n.corner[0], max(n.corner[1], n.corner[2]));
                continue;
            }
            const PatchNode &a = tree.nodes_[n.child], &b = tree.nodes_[n.child + 1];
            low[i] = min(low[n.child], low[n.child + 1]);
            high[i] = max(high[n.child], high[n.child + 1]);
            n.area = a.area + b.area;
            n.center = (low[i] + high[i]) * 0.5f;
            n.radius = 0.5f * length(high[i] - low[i]);
            const Vec3 sum = a.normal * a.area + b.normal * b.area;
            const bool sides_cancel = !(length(sum) > 1e-3f * n.area);
            n.normal = sides_cancel ? a.normal : normalize(sum);
            n.cone = 0;
            if (2 * n.radius <= tree.face_size_) {
                for (size_t s = ranges[i].begin; s < ranges[i].end; ++s)
                    n.cone = std::max(n.cone, angle_between(n.normal, sides[s].normal));
            } else {
                n.cone =
                    std::max(angle_between(n.normal, a.normal) + a.cone, angle_between(n.normal, b.normal) + b.cone);
            }
            if (sides_cancel || n.cone > pi) n.cone = pi;
            for (const PatchNode* part : {&a, &b})
                n.height =
                    std::max(n.height, std::fabs(dot(n.normal, part->center - n.center)) + part->reach(n.normal));
        }
    }
};

PatchTree::PatchTree(const Geometry& geometry, float face_size, NoPatches)
    : face_size_(face_size), side_(2 * geometry.triangle_count(), no_node) {
    Builder builder{*this, {}, {}};
    for (uint32_t t = 0; t < geometry.triangle_count(); ++t) {
        const Corners corners = corners_of(geometry, t);
        if (!(corners.area() > 0)) continue;
        const Vec3 center = (corners.v[0] + corners.v[1] + corners.v[2]) * (1.0f / 3);
        const Vec3 normal = geometry.geometric_normal(t);
        builder.sides.push_back({t, false, center, normal});
        if (!geometry.has_no_back(t)) builder.sides.push_back({t, true, center, -normal});
    }
    require(builder.sides.size() < no_node / 4, "radiosity: expected fewer than " + std::to_string(no_node / 4) +
                                                    " sides of triangles, got " + std::to_string(builder.sides.size()));
    if (builder.sides.empty()) return;
    nodes_.reserve(2 * builder.sides.size());
    nodes_.resize(1);
    builder.build_directions();
    for (PatchNode& n : nodes_)
        if (!n.is_cluster()) set_corners(n, corners_of(geometry, n.triangle));
    builder.measure_clusters();
}

PatchTree::PatchTree(const Geometry& geometry, float size, float face_size, std::span<const float> scales)
    : PatchTree(geometry, face_size, NoPatches{}) {
    const auto sides = static_cast<uint32_t>(nodes_.size());
    set_spreads(scales);
    for (uint32_t i = 0; i < sides; ++i)
        if (!nodes_[i].is_cluster())
            halve_down_to(i, size * scale_of(scales, 2 * size_t(nodes_[i].triangle) + nodes_[i].back), deepest);
    list_leaves();
    join_faces();
}

void PatchTree::set_spreads(std::span<const float> scales) {
    for (size_t i = nodes_.size(); i-- > 0;) {
        PatchNode& n = nodes_[i];
        if (!n.is_cluster()) {
            n.spread = sqr(scale_of(scales, 2 * size_t(n.triangle) + n.back));
            continue;
        }
        const PatchNode &a = nodes_[n.child], &b = nodes_[n.child + 1];
        n.spread = n.area / (a.area / a.spread + b.area / b.spread);
    }
}

PatchTree::PatchTree(const Geometry& geometry, std::span<const PatchName> names) : PatchTree(geometry, 0, NoPatches{}) {
    const auto fail = [] {
        require(false,
                "patches: expected patches that cover the surfaces of this scene without gaps or overlaps, got others");
    };
    for (const PatchName& name : names) {
        const size_t side = 2 * size_t(name.triangle) + name.back;
        if (side >= side_.size() || side_[side] == no_node || name.path == 0) fail();
        uint32_t node = side_[side];
        for (int bit = 62 - __builtin_clzll(name.path); bit >= 0; --bit) {
            if (nodes_[node].is_leaf()) {
                if (!corners_of(nodes_[node]).is_divisible()) fail();
                halve(node);
            }
            node = nodes_[node].child + static_cast<uint32_t>(name.path >> bit & 1);
        }
    }
    list_leaves();
    // If there are as many leaves as names and each name is a leaf, no part is missing or covered twice.
    if (leaves_.size() != names.size()) fail();
    std::vector<uint8_t> named(nodes_.size(), 0);
    for (const PatchName& name : names) {
        const uint32_t node = find(name);
        if (!nodes_[node].is_leaf() || named[node]) fail();
        named[node] = 1;
    }
}

uint32_t PatchTree::find(const PatchName& name) const {
    uint32_t node = side_[2 * size_t(name.triangle) + name.back];
    for (int bit = 62 - __builtin_clzll(name.path); bit >= 0; --bit)
        node = nodes_[node].child + static_cast<uint32_t>(name.path >> bit & 1);
    return node;
}

uint32_t PatchTree::behind(uint32_t patch) const {
    const PatchName front = name(patch);
    uint32_t node = side_[2 * size_t(front.triangle) + !front.back];
    for (int bit = 62 - __builtin_clzll(front.path); bit >= 0 && node != no_node && !nodes_[node].is_leaf(); --bit)
        node = nodes_[node].child + static_cast<uint32_t>(front.path >> bit & 1);
    return node;
}

void PatchTree::halve(uint32_t node) {
    const auto child = static_cast<uint32_t>(nodes_.size());
    nodes_.resize(child + 2);
    PatchNode& n = nodes_[node];
    n.child = child;
    n.ends_links = false;
    const Corners corners = corners_of(n);
    for (const bool second : {false, true}) {
        PatchNode& half = nodes_[child + second];
        half.parent = node;
        half.triangle = n.triangle;
        half.back = n.back;
        half.normal = n.normal;
        half.spread = n.spread;
        set_corners(half, corners.half(n.longest, second));
    }
}

void PatchTree::halve_down_to(uint32_t node, float size, int depth) {
    const Corners corners = corners_of(nodes_[node]);
    if (depth == 0 || !(corners.longest_edge() > size) || !corners.is_divisible()) return;
    halve(node);
    const uint32_t child = nodes_[node].child;
    halve_down_to(child, size, depth - 1);
    halve_down_to(child + 1, size, depth - 1);
}

void PatchTree::divide(std::span<const uint32_t> patches) {
    for (const uint32_t patch : patches) {
        if (depth(patch) + 2 > deepest || !corners_of(nodes_[patch]).is_divisible()) continue;
        halve(patch);
        const uint32_t child = nodes_[patch].child;
        for (const uint32_t half : {child, child + 1})
            if (corners_of(nodes_[half]).is_divisible()) halve(half);
    }
    list_leaves();
    join_faces();
}

void PatchTree::join_faces() {
    for (size_t i = nodes_.size(); i-- > 0;) {
        PatchNode& n = nodes_[i];
        if (!n.is_cluster()) continue;
        const bool whole = nodes_[n.child].ends_links && nodes_[n.child + 1].ends_links;
        n.ends_links = whole && 2 * n.radius <= face_size_ && n.cone <= face_cone;
    }
}

void PatchTree::list_leaves() {
    leaves_.clear();
    for (uint32_t i = 0; i < nodes_.size(); ++i)
        if (nodes_[i].is_leaf()) leaves_.push_back(i);
}

int PatchTree::depth(uint32_t node) const {
    int depth = 0;
    for (uint32_t i = nodes_[node].parent; i != no_node && !nodes_[i].is_cluster(); i = nodes_[i].parent) ++depth;
    return depth;
}

uint32_t PatchTree::find(uint32_t triangle, bool back, float u, float v) const {
    uint32_t node = side_[2 * size_t(triangle) + back];
    float w[3] = {1 - u - v, u, v};
    while (node != no_node && !nodes_[node].is_leaf()) {
        const uint8_t k = nodes_[node].longest;
        const float a = w[k], b = w[(k + 1) % 3], apex = w[(k + 2) % 3];
        // The midpoint of the edge from a to b gets twice the smaller weight.
        const bool second = b > a;
        w[0] = second ? 2 * a : a - b;
        w[1] = second ? b - a : 2 * b;
        w[2] = apex;
        node = nodes_[node].child + second;
    }
    return node;
}

PatchName PatchTree::name(uint32_t leaf) const {
    PatchName name{nodes_[leaf].triangle, nodes_[leaf].back, 0};
    int bit = 0;
    uint32_t node = leaf;
    for (uint32_t up = nodes_[node].parent; up != no_node && !nodes_[up].is_cluster(); up = nodes_[up].parent) {
        name.path |= uint64_t(node != nodes_[up].child) << bit++;
        node = up;
    }
    name.path |= uint64_t(1) << bit;
    return name;
}

}  // namespace eclat
