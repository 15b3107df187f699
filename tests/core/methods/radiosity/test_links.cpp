// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/radiosity/links.h"

#include <doctest/doctest.h>

#include <cstring>

#include "rectangles.h"
#include "room.h"

using namespace eclat;

namespace {

constexpr std::array<float, 6> grey{0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f};

std::vector<Link> linked(const World& world, const PatchTree& tree, float tolerance, int threads = 1) {
    std::vector<float> radiosity(tree.nodes().size(), 1);
    auto links = first_links(tree);
    Progress progress;
    refine_links(world, tree, {}, radiosity, {.tolerance = tolerance, .seed = 1, .threads = threads}, links, progress);
    return links;
}

/// Exchange between the fronts of two walls (of two triangles each).
double between(const PatchTree& tree, const std::vector<Link>& links, uint32_t wall, uint32_t other) {
    double sum = 0;
    for (const Link& link : links) {
        const PatchNode &a = tree[link.a], &b = tree[link.b];
        REQUIRE_FALSE(a.is_cluster());
        if (a.back || b.back) continue;
        const uint32_t p = a.triangle / 2, q = b.triangle / 2;
        if ((p == wall && q == other) || (p == other && q == wall)) sum += link.exchange;
    }
    return sum;
}

}  // namespace

TEST_CASE("links between walls carry the closed form's exchange; what stands between takes its share away") {
    const std::vector<Wall> plates{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.5f, 0},
                                   {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}, 0.5f, 0}};
    const Room open = build_room(plates);
    const PatchTree tree(*open.geometry, 0.3f);
    const double exact = parallel_rectangles(1, 1, 1);
    CHECK(between(tree, linked(open.world(), tree, 0.003f), 0, 1) == doctest::Approx(exact).epsilon(0.003));

    // A wall halfway that covers all, then half.
    for (const float width : {1.0f, 0.5f}) {
        auto with_wall = plates;
        with_wall.push_back({{0, 0, 0.5f}, {width, 0, 0}, {0, 1, 0}, 0.5f, 0});
        const Room room = build_room(with_wall);
        const PatchTree cut(*room.geometry, 0.15f);
        const double seen = between(cut, linked(room.world(), cut, 0.002f), 0, 1);
        if (width == 1) CHECK(seen < 1e-3);
        // By symmetry half of all lines between the plates cross either half of the plane halfway.
        if (width == 0.5f) CHECK(seen == doctest::Approx(exact / 2).epsilon(0.02));
    }
}

TEST_CASE("a tinted pane between walls takes its share of the exchange, and exchanges what it stops") {
    std::vector<Wall> walls{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.5f, 0},
                            {{0, 0, 8}, {0, 1, 0}, {1, 0, 0}, 0.5f, 0},
                            {{-2, -2, 4}, {5, 0, 0}, {0, 5, 0}, 0.5f, 0}};
    std::vector<Material> materials = own_materials(walls);
    materials[2].kind = MaterialKind::thin_dielectric;
    Value white, tint, ior;
    white.constant = Color(1), tint.constant = Color(0.9f, 0.6f, 0.3f), ior.constant = Color(1.5f);
    materials[2].parameters = {white, tint, ior};
    for (Material& m : materials) m.prepare({});
    const Room room = build_room(walls, materials);
    const PatchTree tree(*room.geometry, 0.6f);
    const auto links = linked(room.world(), tree, 0.01f);
    // The angles are so small that the pane lets through what it does at 0°, 12/13, and stops the rest.
    // The angles are so small that the pane lets through what it does at 0°, 12/13, and stops the rest.
    const double passes = 12.0 / 13 * 0.6;
    size_t through = 0, to_pane = 0;
    for (const Link& link : links) {
        const PatchNode &a = tree[link.a], &b = tree[link.b];
        const float between = std::fabs(a.center.z - b.center.z);
        if (between > 7) {
            ++through;
            CHECK(link.visibility == doctest::Approx(passes).epsilon(0.002));
            CHECK(link.tint.r == doctest::Approx(1.5).epsilon(0.001));
            CHECK(link.tint.b == doctest::Approx(0.5).epsilon(0.001));
            CHECK_FALSE(link.in_part);
        } else if (between > 3 && length(a.center - b.center) < 4.1f) {
            ++to_pane;
            CHECK(link.visibility == doctest::Approx(1 - passes).epsilon(0.01));
        }
    }
    CHECK(through > 0);
    CHECK(to_pane > 0);
}

TEST_CASE("form factors of a closed room sum to one in every patch's mean") {
    const Room room = closed_room(grey, {0, 1, 0, 0, 0, 0});
    const PatchTree tree(*room.geometry, 0.4f);
    const auto links = linked(room.world(), tree, 0.002f);
    const Exchanges exchanges(tree, links);
    CHECK(exchanges.size() <= 2 * links.size());
    std::vector<double> sums(tree.nodes().size(), 0);
    double worst = 0, all = 0, area = 0;
    for (uint32_t i = 0; i < tree.nodes().size(); ++i) {
        for (const auto& sender : exchanges.of(i)) sums[i] += sender.form_factor;
        if (tree[i].parent != no_node) sums[i] += sums[tree[i].parent];
        if (!tree[i].is_leaf() || tree[i].back) continue;
        worst = std::max(worst, std::fabs(sums[i] - 1));
        all += sums[i] * tree[i].area;
        area += tree[i].area;
    }
    CHECK(all / area == doctest::Approx(1).epsilon(0.002));
    CHECK(worst < 0.1);
}

TEST_CASE("the exchange is the same in both directions") {
    const Room room = closed_room(grey, {0, 1, 0, 0, 0, 0});
    const PatchTree tree(*room.geometry, 0.6f);
    const Exchanges exchanges(tree, linked(room.world(), tree, 0.01f));
    for (uint32_t i = 0; i < tree.nodes().size(); ++i)
        for (const auto& sender : exchanges.of(i)) {
            double back = 0;
            for (const auto& other : exchanges.of(sender.node))
                if (other.node == i) back = other.form_factor;
            CHECK(back * tree[sender.node].area == doctest::Approx(sender.form_factor * tree[i].area).epsilon(1e-5));
        }
}

TEST_CASE("four times as many patches take about four times as many links, and fewer with a higher tolerance") {
    const Room room = closed_room(grey, {0, 1, 0, 0, 0, 0});
    const PatchTree coarse(*room.geometry, 0.2f), fine(*room.geometry, 0.1f);
    REQUIRE(fine.leaves().size() == 4 * coarse.leaves().size());
    const size_t few = linked(room.world(), coarse, 0.01f).size(), many = linked(room.world(), fine, 0.01f).size();
    CHECK(many < 4.5 * few);
    CHECK(linked(room.world(), coarse, 0.05f).size() < few / 2);
}

TEST_CASE("the tolerance increases so that the number of links stays near its limit") {
    const Room room = closed_room(grey, {0, 1, 0, 0, 0, 0});
    const PatchTree tree(*room.geometry, 0.1f);
    std::vector<float> radiosity(tree.nodes().size(), 1);
    Progress progress;
    auto free = first_links(tree), bounded = free;
    CHECK(refine_links(room.world(), tree, {}, radiosity, {.tolerance = 0.001f}, free, progress) == 0.001f);
    REQUIRE(free.size() > 100'000);
    const float held =
        refine_links(room.world(), tree, {}, radiosity, {.tolerance = 0.001f, .most = 10'000}, bounded, progress);
    CHECK(held > 0.004f);
    CHECK(bounded.size() < free.size() / 4);
}

TEST_CASE("form factors between clusters of small sides are those of the walls that they make up") {
    // Two plates of 8 × 8 tiles each, face to face.
    std::vector<Wall> tiles;
    constexpr float w = 0.125f;
    for (int i = 0; i < 64; ++i) {
        const float x = w * float(i % 8), z = w * float(i / 8);
        tiles.push_back({{x, 0, z}, {0, 0, w}, {w, 0, 0}, 0.5f, 0});
        tiles.push_back({{x, 1, z}, {w, 0, 0}, {0, 0, w}, 0.5f, 0});
    }
    const Room room = build_room(tiles);
    const PatchTree tree(*room.geometry, 1, 0.4f);
    double sum = 0;
    size_t clusters = 0;
    const auto links = linked(room.world(), tree, 0.003f);
    for (const Link& link : links) {
        sum += link.exchange;
        clusters += tree[link.a].is_cluster() && tree[link.b].is_cluster();
        CHECK(tree[tree[link.a].parent].ends_links == false);
    }
    CHECK(clusters > 0);
    CHECK(sum == doctest::Approx(parallel_rectangles(1, 1, 1)).epsilon(0.02));
}

TEST_CASE("links are the same on one thread and on two") {
    const Room room = closed_room(grey, {0, 1, 0, 0, 0, 0});
    const PatchTree tree(*room.geometry, 0.3f);
    const auto one = linked(room.world(), tree, 0.01f, 1), two = linked(room.world(), tree, 0.01f, 2);
    REQUIRE(one.size() == two.size());
    CHECK(std::memcmp(one.data(), two.data(), one.size() * sizeof(Link)) == 0);
}

TEST_CASE("a cancelled refinement stops") {
    const Room room = closed_room(grey, {0, 1, 0, 0, 0, 0});
    const PatchTree tree(*room.geometry, 0.3f);
    std::vector<float> radiosity(tree.nodes().size(), 1);
    auto links = first_links(tree);
    Progress progress;
    progress.cancelled = true;
    CHECK_THROWS_AS(refine_links(room.world(), tree, {}, radiosity, {.tolerance = 0.01f}, links, progress), Cancelled);
}
