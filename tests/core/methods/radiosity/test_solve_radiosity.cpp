// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/radiosity/solve_radiosity.h"

#include <doctest/doctest.h>

#include <cstring>

#include "room.h"

using namespace eclat;

namespace {

Room half_lit() { return closed_room({0.5f, 0.7f, 0.2f, 0.6f, 0.5f, 0.5f}, {0, 0, 3, 0, 0, 0}); }

SolvedRadiosity solved(const Room& room, RadiosityOptions options) {
    Progress progress;
    return solve_radiosity(room.world(), options, progress);
}

}  // namespace

TEST_CASE("a furnace by the whole solver, by gathering and by shooting") {
    const Room room = closed_room({0.6f, 0.6f, 0.6f, 0.6f, 0.6f, 0.6f}, {1, 1, 1, 1, 1, 1});
    for (const auto solver : {RadiositySolver::gathering, RadiositySolver::shooting}) {
        const auto out = solved(room, {.patches = 1500, .solver = solver});
        CHECK(out.patches.size() >= 384);  // of equal walls each size has twice the patches of the one before
        CHECK(out.residual <= 1e-5f);
        for (const SolvedPatch& p : out.patches)
            if (!p.name.back) CHECK(p.total.g == doctest::Approx(M_PI / 0.4).epsilon(0.01));
    }
}

TEST_CASE("the same patches and bits on one thread and on two") {
    const Room room = half_lit();
    const auto one = solved(room, {.patches = 2000, .seed = 7, .threads = 1});
    const auto two = solved(room, {.patches = 2000, .seed = 7, .threads = 2});
    REQUIRE(one.patches.size() == two.patches.size());
    for (size_t i = 0; i < one.patches.size(); ++i) {
        const SolvedPatch &a = one.patches[i], &b = two.patches[i];
        CHECK(a.name.triangle == b.name.triangle);
        CHECK(a.name.path == b.name.path);
        CHECK(std::memcmp(&a.total, &b.total, sizeof a.total) == 0);
        CHECK(std::memcmp(&a.direct, &b.direct, sizeof a.direct) == 0);
    }
}

TEST_CASE("patches are divided where light changes fast, and there are about as many as wanted") {
    // A plate under the ceiling lamp casts a shadow on the floor.
    std::vector<Wall> walls{{{-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, 0.5f, 0},
                            {{-0.2f, 1, -0.2f}, {0.4f, 0, 0}, {0, 0, 0.4f}, 0.5f, 9},
                            {{-0.4f, -0.4f, -0.4f}, {0.8f, 0, 0}, {0, 0, 0.8f}, 0.5f, 0}};
    const Room room = build_room(walls);
    const auto even = solved(room, {.patches = 3000, .refinements = 0});
    const auto fine = solved(room, {.patches = 3000, .refinements = 2});
    CHECK(even.patches.size() <= 3012);  // 12 sides
    CHECK(fine.patches.size() <= 3012);
    CHECK(fine.patches.size() > 2500);
    const auto smallest = [](const SolvedRadiosity& s, float least, float most) {
        uint64_t longest = 0;
        for (const SolvedPatch& p : s.patches) {
            if (p.name.triangle > 1 || p.name.back) continue;
            if (p.direct.g >= least && p.direct.g < most) longest = std::max(longest, p.name.path);
        }
        return longest;
    };
    CHECK(smallest(fine, 0.2f, 0.6f) > smallest(even, 0.2f, 0.6f));  // in the penumbra
}

TEST_CASE("large sides are divided in a scene of many small ones") {
    std::vector<Wall> walls{{{-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, 0.5f, 1}};
    for (int i = 0; i < 200; ++i) walls.push_back({{0.01f * float(i), 0, 0}, {0.005f, 0, 0}, {0, 0, 0.005f}, 0.5f, 0});
    const auto out = solved(build_room(walls), {.patches = 100, .refinements = 0});
    size_t large = 0;
    for (const SolvedPatch& p : out.patches) large += p.name.triangle < 2;
    CHECK(large >= 64);
    CHECK(out.patches.size() <= 804 + 100);
}

TEST_CASE("limited bounces, a dark scene, and an empty one") {
    const Room room = half_lit();
    const auto direct = solved(room, {.patches = 500, .bounces = 1});
    for (const SolvedPatch& p : direct.patches) CHECK(p.total.g == p.direct.g);
    const Room dark = closed_room({0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f}, {0, 0, 0, 0, 0, 0});
    for (const SolvedPatch& p : solved(dark, {.patches = 100}).patches) CHECK(is_black(p.total));
    CHECK(solved(build_room({}), {}).patches.empty());
}
