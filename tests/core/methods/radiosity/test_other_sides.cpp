// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/radiosity/other_sides.h"

#include <doctest/doctest.h>

#include "room.h"

using namespace eclat;

TEST_CASE("the patches behind a patch cover it, however finely either side is divided") {
    const Room room = build_room({{{0, 0, 0}, {3, 0, 0}, {0, 0, 0.4f}, 0.5f, 0}});
    PatchTree tree(*room.geometry, 0.5f);
    // Some patches of the front become smaller than what lies behind them.
    std::vector<uint32_t> some;
    for (const uint32_t leaf : tree.leaves())
        if (!tree[leaf].back && tree[leaf].center.x < 1) some.push_back(leaf);
    REQUIRE(!some.empty());
    tree.divide(some);
    std::vector<PatchSurface> surfaces(tree.nodes().size());
    CHECK(OtherSides(tree, surfaces).of(tree.leaves().front()).empty());
    for (const uint32_t leaf : tree.leaves())
        if (!tree[leaf].back) surfaces[leaf].transmittance = Color(0.5f);

    const OtherSides others(tree, surfaces);
    for (const uint32_t leaf : tree.leaves()) {
        float share = 0;
        Vec3 center;
        for (const auto& other : others.of(leaf)) {
            CHECK(tree[other.patch].triangle == tree[leaf].triangle);
            CHECK(tree[other.patch].back != tree[leaf].back);
            share += other.share;
            center = center + tree[other.patch].center * other.share;
        }
        CHECK(share == doctest::Approx(1).epsilon(1e-4));
        CHECK(length(center - tree[leaf].center) < tree[tree.behind(leaf)].radius);
    }
}
