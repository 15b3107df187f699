// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Surfaces as patches: each side of a triangle that light can reach is halved until its parts are small enough, and sides are
// joined into clusters, so that all of a scene is one binary tree.

#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "scene/scene.h"

namespace eclat {

constexpr uint32_t no_node = ~0u;

/// One side of a triangle, a part of one, or a cluster of sides.
struct PatchNode {
    Vec3 center;
    float radius = 0;  // of a sphere around the centre that holds it
    Vec3 normal;       // unit; a cluster's is the mean of its parts' by area
    float cone = 0;    // largest angle between that and a normal in it, radians
    float height = 0;  // of what it holds above and below the plane through its centre across its normal, at most
    float area = 0;
    uint32_t parent = no_node, child = no_node;  // the first of two that stand side by side
    uint32_t triangle = no_triangle;             // of the scene; none: a cluster
    bool back = false;                           // the side that the triangle's normal looks away from
    bool ends_links = true;                      // a patch, or a face cluster: links go no deeper
    uint8_t longest = 0;                         // the edge that begins at this corner is the longest
    Vec3 corner[3];                              // of a triangle or its part, in the triangle's order

    /// At barycentric weights of the second and third corner.
    Vec3 point(Vec2 b) const { return corner[0] * (1 - b.x - b.y) + corner[1] * b.x + corner[2] * b.y; }
    bool is_leaf() const { return child == no_node; }
    bool is_cluster() const { return triangle == no_triangle; }
    /// How far it reaches from its centre along the unit vector `w`, at most.
    float reach(Vec3 w) const { return std::min(radius, radius * length(cross(normal, w)) + height); }
};

/// A patch by name: which halves lead to it, from the leading 1 on.
struct PatchName {
    uint32_t triangle = 0;
    bool back = false;
    uint64_t path = 1;
};

class PatchTree {
  public:
    /// Sides are halved across their longest edge until that is at most `size`. Links end at patches, and above them at
    /// clusters of whole sides that are at most `face_size` wide and look about the same way: face clusters [Willmott99].
    PatchTree(const Geometry& geometry, float size, float face_size = 0);
    /// The tree whose leaves have these names, in any order. Throws std::invalid_argument where no tree has.
    PatchTree(const Geometry& geometry, std::span<const PatchName> names);

    /// Parents stand before their children; the first is the root, if there is any.
    const std::vector<PatchNode>& nodes() const { return nodes_; }
    const PatchNode& operator[](uint32_t i) const { return nodes_[i]; }
    /// The patches.
    const std::vector<uint32_t>& leaves() const { return leaves_; }

    /// Makes four patches of each of `patches`; but of those that are too deep already.
    void divide(std::span<const uint32_t> patches);
    /// The patch at barycentric weights (u, v); `no_node` where that side has none.
    uint32_t find(uint32_t triangle, bool back, float u, float v) const;
    uint32_t find(const PatchName& name) const;
    /// The node on the other side of its triangle that covers a patch: its mirror image, or a larger patch where that side is
    /// not halved so far; `no_node` where that side has none.
    uint32_t behind(uint32_t patch) const;
    PatchName name(uint32_t leaf) const;

  private:
    static constexpr int deepest = 62;  // halvings of a side

    struct Builder;
    struct NoPatches {};
    PatchTree(const Geometry& geometry, float face_size, NoPatches);
    void join_faces();
    void halve(uint32_t node);
    void halve_down_to(uint32_t node, float size, int depth);
    void list_leaves();
    int depth(uint32_t node) const;

    std::vector<PatchNode> nodes_;
    std::vector<uint32_t> leaves_;
    float face_size_ = 0;         // of face clusters, at most
    std::vector<uint32_t> side_;  // node of side 2 · triangle + back
};

/// Sides that can be patches.
size_t count_sides(const Geometry& geometry);

/// Patches with edges of at most `size`, counted until there are `most`.
size_t count_patches(const Geometry& geometry, float size, size_t most);

/// Area of all sides, m².
double total_area(const Geometry& geometry);

/// How long the longest edge may be so that there are about `count` patches; infinite where each side is one already.
float patch_size_for(const Geometry& geometry, size_t count);

}  // namespace eclat
