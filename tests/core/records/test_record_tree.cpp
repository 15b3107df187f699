// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Lookups in the tree of spheres against a loop over all of them.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "records/record_tree.h"
#include "sampling/rng.h"

using namespace eclat;

namespace {

using Found = std::vector<std::pair<uint32_t, float>>;  // index of the sphere, squared distance

Vec3 random_point(Rng& rng) {
    const float x = rng.next(), y = rng.next(), z = rng.next();
    return {x, y, z};
}

std::vector<SphereTree::Sphere> random_spheres(size_t count, uint32_t seed, bool cut = false) {
    Rng rng(seed, 0);
    std::vector<SphereTree::Sphere> out;
    for (size_t i = 0; i < count; ++i) {
        const Vec3 center = random_point(rng);
        // A few large ones among many small ones, as in a cache; of every other one only a slab is asked for.
        const float u = rng.next(), radius = 0.3f * u * u;
        out.push_back({center, radius});
        if (!cut || i % 2 == 0) continue;
        out.back().normal = normalize(random_point(rng) - Vec3{0.5f, 0.5f, 0.5f});
        out.back().height = radius * rng.next();
    }
    return out;
}

Found sorted(Found found) {
    std::sort(found.begin(), found.end());
    return found;
}

Found near(const SphereTree& tree, Vec3 p, float reach) {
    Found out;
    tree.for_each_near(p, reach, [&](uint32_t slot, float d2) { out.emplace_back(tree.order()[slot], d2); });
    return out;
}

Found around(const SphereTree& tree, Vec3 p) { return near(tree, p, 0); }

Found by_force(const std::vector<SphereTree::Sphere>& spheres, Vec3 p, float reach) {
    Found out;
    for (uint32_t i = 0; i < spheres.size(); ++i) {
        const Vec3 d = p - spheres[i].center;
        const bool in_slab = std::fabs(dot(d, spheres[i].normal)) <= spheres[i].height + reach;
        if (in_slab && length_squared(d) < sqr(spheres[i].radius + reach)) out.emplace_back(i, length_squared(d));
    }
    return out;
}

}  // namespace

TEST_CASE("lookups find what a loop over all spheres finds") {
    for (size_t count : {0, 1, 4, 5, 9, 300, 2000}) {
        const auto spheres = random_spheres(count, 11), slabs = random_spheres(count, 11, true);
        const SphereTree tree{spheres}, tree_of_slabs{slabs};
        Rng rng(12, static_cast<uint32_t>(count));
        size_t total = 0;
        for (int query = 0; query < 200; ++query) {
            const Vec3 p = random_point(rng);
            const Found expected = by_force(spheres, p, 0);
            total += expected.size();
            CHECK(sorted(around(tree, p)) == expected);
            CHECK(sorted(near(tree, p, 0.1f)) == by_force(spheres, p, 0.1f));
            CHECK(sorted(around(tree_of_slabs, p)) == by_force(slabs, p, 0));
        }
        if (count >= 300) CHECK(total > 500);  // the comparison is not of nothing with nothing
    }
}

TEST_CASE("each sphere has one slot") {
    const SphereTree tree{random_spheres(777, 13)};
    std::vector<uint32_t> order = tree.order();
    std::erase(order, SphereTree::vacant);
    std::sort(order.begin(), order.end());
    REQUIRE(order.size() == 777);
    for (uint32_t i = 0; i < order.size(); ++i) CHECK(order[i] == i);
}

TEST_CASE("spheres at one point are all found, and in the same order from equal trees") {
    std::vector<SphereTree::Sphere> spheres(100, {{0.5f, 0.5f, 0.5f}, 1});
    for (size_t i = 0; i < spheres.size(); i += 3) spheres[i].center.x += 1e-3f * static_cast<float>(i % 5);
    const SphereTree one{spheres}, other{spheres};
    CHECK(around(one, {0.4f, 0.5f, 0.5f}).size() == 100);
    CHECK(around(one, {0.4f, 0.5f, 0.5f}) == around(other, {0.4f, 0.5f, 0.5f}));
}
