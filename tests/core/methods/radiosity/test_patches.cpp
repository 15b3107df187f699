// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/radiosity/patches.h"

#include <doctest/doctest.h>

#include "methods/radiosity/patch_sizes.h"
#include "room.h"
#include "sampling/rng.h"
#include "sampling/warp.h"

using namespace eclat;

namespace {

Room slender_room() {
    return build_room({{{0, 0, 0}, {3, 0, 0}, {0, 0, 0.4f}, 0.5f, 0}, {{0, 1, 0}, {0, 0, 2}, {2, 0, 0.3f}, 0.5f, 1}});
}

float longest_edge(const PatchNode& n) {
    float l = 0;
    for (int k = 0; k < 3; ++k) l = std::max(l, length(n.corner[(k + 1) % 3] - n.corner[k]));
    return l;
}

}  // namespace

TEST_CASE("patches tile their triangles, are small enough, and each point finds the one that it lies in") {
    const Room room = slender_room();
    const PatchTree tree(*room.geometry, 0.15f);
    double area = 0;
    for (const uint32_t leaf : tree.leaves()) {
        area += tree[leaf].area;
        CHECK(longest_edge(tree[leaf]) <= 0.15f);
        CHECK(tree.find(tree.name(leaf)) == leaf);
    }
    // Both sides of 3 × 0.4 and of 2 × |(2, 0, 0.3) − its part along z| = 2 × 2.
    CHECK(area == doctest::Approx(2 * (1.2 + 4)).epsilon(1e-4));
    Rng rng(3, 1);
    for (int i = 0; i < 500; ++i) {
        const auto triangle = static_cast<uint32_t>(i % 4);
        const Vec2 b = square_to_triangle({rng.next(), rng.next()});
        const PatchNode& patch = tree[tree.find(triangle, i % 3 == 0, b.x, b.y)];
        REQUIRE(patch.is_leaf());
        CHECK(patch.triangle == triangle);
        CHECK(patch.back == (i % 3 == 0));
        const Vec3 p = room.geometry->vertex(triangle, 0) * (1 - b.x - b.y) + room.geometry->vertex(triangle, 1) * b.x +
                       room.geometry->vertex(triangle, 2) * b.y;
        const Vec3 front = room.geometry->geometric_normal(triangle);
        for (int k = 0; k < 3; ++k)
            CHECK(dot(cross(patch.corner[(k + 1) % 3] - patch.corner[k], p - patch.corner[k]), front) > -1e-5f);
    }
}

TEST_CASE("the bounds of clusters contain their parts: position, normals, area, height") {
    const Room room = closed_room({0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f}, {0, 1, 0, 0, 0, 0});
    const PatchTree tree(*room.geometry, 0.7f);
    for (const uint32_t leaf : tree.leaves()) {
        const PatchNode& patch = tree[leaf];
        for (uint32_t up = patch.parent; up != no_node; up = tree[up].parent) {
            const PatchNode& n = tree[up];
            CHECK(std::acos(clamp(dot(n.normal, patch.normal), -1, 1)) <= n.cone + 1e-3f);
            for (const Vec3& corner : patch.corner) {
                CHECK(length(corner - n.center) <= n.radius * 1.0001f);
                CHECK(std::fabs(dot(corner - n.center, n.normal)) <= n.height + 1e-5f);
                const Vec3 w = normalize({1, 2, -1});
                CHECK(dot(corner - n.center, w) <= n.reach(w) + 1e-5f);
            }
        }
    }
    CHECK(tree[0].area == doctest::Approx(48));  // both sides of all walls
}

TEST_CASE("divided patches become four, and names restore the same tree") {
    const Room room = slender_room();
    PatchTree tree(*room.geometry, 1);
    const size_t before = tree.leaves().size();
    const std::vector<uint32_t> some{tree.leaves()[1], tree.leaves()[4]};
    tree.divide(some);
    CHECK(tree.leaves().size() == before + 6);
    CHECK(tree[tree[some[0]].child].area == doctest::Approx(tree[some[0]].area / 2));
    std::vector<PatchName> names;
    for (const uint32_t leaf : tree.leaves()) names.push_back(tree.name(leaf));
    const PatchTree again(*room.geometry, names);
    CHECK(again.leaves().size() == tree.leaves().size());
    for (const PatchName& name : names) {
        const PatchNode &a = tree[tree.find(name)], &b = again[again.find(name)];
        for (int k = 0; k < 3; ++k) CHECK(a.corner[k] == b.corner[k]);
    }
    const auto refused = [&](std::vector<PatchName> wrong) {
        CHECK_THROWS_WITH(
            PatchTree(*room.geometry, wrong),
            "patches: expected patches that cover the surfaces of this scene without gaps or overlaps, got others");
    };
    auto missing = names, twice = names, elsewhere = names, deeper = names;
    missing.pop_back();
    twice.back() = twice.front();
    elsewhere.back().triangle = 99;
    deeper.back().path = 0;
    refused(missing), refused(twice), refused(elsewhere), refused(deeper);
}

TEST_CASE("the patch size for a number of patches") {
    const Room room = closed_room({0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f}, {0, 1, 0, 0, 0, 0});
    for (const size_t count : {100u, 1000u, 5000u}) {
        const PatchTree tree(*room.geometry, patch_size_for(*room.geometry, count));
        // All walls are alike, so that halving them doubles the number.
        CHECK(tree.leaves().size() <= count);
        CHECK(tree.leaves().size() * 2 >= count * 0.95);
    }
    CHECK(patch_size_for(*room.geometry, 3) == infinity);
    CHECK(PatchTree(*room.geometry, infinity).leaves().size() == 24);
}

TEST_CASE("links end at clusters of small sides with similar normals, and at the patches of divided sides") {
    // Sixteen tiles with both sides, 0.25 wide.
    std::vector<Wall> tiles;
    for (int i = 0; i < 16; ++i)
        tiles.push_back({{0.25f * float(i % 4), 0, 0.25f * float(i / 4)}, {0, 0, 0.25f}, {0.25f, 0, 0}, 0.5f, 0});
    const Room room = build_room(tiles);
    const auto ends = [](const PatchTree& tree) {
        std::vector<uint32_t> out;
        for (uint32_t i = 0; i < tree.nodes().size(); ++i)
            if (tree[i].ends_links && (tree[i].parent == no_node || !tree[tree[i].parent].ends_links)) out.push_back(i);
        return out;
    };
    PatchTree tree(*room.geometry, 1, 0.8f);
    double area = 0;
    for (const uint32_t end : ends(tree)) {
        CHECK(tree[end].is_cluster());
        CHECK(2 * tree[end].radius <= 0.8f);
        CHECK(tree[end].cone < 1e-3f);  // never both sides
        area += tree[end].area;
    }
    CHECK(area == doctest::Approx(2).epsilon(1e-4));
    CHECK(ends(tree).size() <= 16);
    CHECK(ends(PatchTree(*room.geometry, 1)).size() == 64);  // patches only

    const uint32_t divided = tree.leaves().front();
    tree.divide(std::vector{divided});
    for (const uint32_t end : ends(tree))
        for (uint32_t up = divided; up != no_node; up = tree[up].parent) CHECK(end != up);
}
