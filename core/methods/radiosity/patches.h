// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The division of surfaces into patches: each side of a triangle that light can reach is bisected until its parts are
// small enough, and sides are joined into clusters, so that the whole scene is one binary tree.

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
    float radius = 0;  // radius of a sphere around the centre that contains it
    Vec3 normal;       // unit normal; for clusters, the mean weighted by area
    float cone = 0;    // largest angle between this and the normals of its parts, radians
    float height = 0;  // largest distance of its parts from the plane through its centre
    float area = 0;
    float spread = 1;  // area over the area that counts: the mean square of the factor by which patches may be longer
    uint32_t parent = no_node, child = no_node;  // the first of two consecutive children
    uint32_t triangle = no_triangle;             // triangle of the scene, or none for clusters
    bool back = false;                           // whether it is on the back of the triangle
    bool ends_links = true;                      // whether links end here: at patches and face clusters
    uint8_t longest = 0;                         // corner at which the longest edge begins
    Vec3 corner[3];                              // corners of a triangle or its part, in the triangle's order

    /// Returns the position with the given barycentric weights of the second and third corner.
    Vec3 point(Vec2 b) const { return corner[0] * (1 - b.x - b.y) + corner[1] * b.x + corner[2] * b.y; }
    bool is_leaf() const { return child == no_node; }
    bool is_cluster() const { return triangle == no_triangle; }
    /// Returns an upper bound of its extent from the centre along the unit vector `w`.
    float reach(Vec3 w) const { return std::min(radius, radius * length(cross(normal, w)) + height); }
};

/// The name of a patch: the sequence of halves that leads to it, in the bits after the leading 1.
struct PatchName {
    uint32_t triangle = 0;
    bool back = false;
    uint64_t path = 1;
};

class PatchTree {
  public:
    /// Bisects sides across their longest edge until it is at most `size`. Links end at patches, or at face clusters
    /// [Willmott99]: clusters of whole sides that are at most `face_size` wide and face about the same way. `scales` has,
    /// for each side, the factor by which its patches may be longer; if it is empty, all factors are 1.
    PatchTree(const Geometry& geometry, float size, float face_size = 0, std::span<const float> scales = {});
    /// Makes the tree whose leaves have the given names, which may be in any order. Throws std::invalid_argument if
    /// there is no such tree.
    PatchTree(const Geometry& geometry, std::span<const PatchName> names);

    /// The nodes, with parents before their children; the first one, if there is any, is the root.
    const std::vector<PatchNode>& nodes() const { return nodes_; }
    const PatchNode& operator[](uint32_t i) const { return nodes_[i]; }
    /// The patches.
    const std::vector<uint32_t>& leaves() const { return leaves_; }

    /// Divides each of `patches` into four, except those that are already too deep.
    void divide(std::span<const uint32_t> patches);
    /// Returns the patch at the barycentric weights (u, v), or `no_node` if that side has none.
    uint32_t find(uint32_t triangle, bool back, float u, float v) const;
    uint32_t find(const PatchName& name) const;
    /// Returns the node on the other side of the triangle that covers a patch: its mirror image, or a larger patch if
    /// that side is divided less finely, or `no_node` if that side has no patches.
    uint32_t behind(uint32_t patch) const;
    PatchName name(uint32_t leaf) const;

  private:
    static constexpr int deepest = 62;  // greatest number of bisections of a side

    struct Builder;
    struct NoPatches {};
    PatchTree(const Geometry& geometry, float face_size, NoPatches);
    void join_faces();
    void set_spreads(std::span<const float> scales);
    void halve(uint32_t node);
    void halve_down_to(uint32_t node, float size, int depth);
    void list_leaves();
    int depth(uint32_t node) const;

    std::vector<PatchNode> nodes_;
    std::vector<uint32_t> leaves_;
    float face_size_ = 0;         // greatest width of face clusters
    std::vector<uint32_t> side_;  // node of side 2 · triangle + back
};

}  // namespace eclat
