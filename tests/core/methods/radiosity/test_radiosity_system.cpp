// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/radiosity/radiosity_system.h"

#include <doctest/doctest.h>

#include "room.h"

using namespace eclat;

namespace {

/// A room with its equation.
struct Problem {
    Room room;
    PatchTree tree;
    std::vector<PatchSurface> surfaces;
    Exchanges exchanges;

    Problem(Room r, float size, float tolerance) : room(std::move(r)), tree(*room.geometry, size) {
        Progress progress;
        surfaces.resize(tree.nodes().size());
        measure_surfaces(room.world(), tree, tree.leaves(), {}, surfaces, progress);
        std::vector<float> radiosity(tree.nodes().size(), 1);
        auto links = first_links(tree);
        refine_links(room.world(), tree, {}, radiosity, {.tolerance = tolerance}, links, progress);
        exchanges = Exchanges(tree, links);
    }
    RadiositySystem system() const { return {tree, surfaces, exchanges, 1}; }
};

Room furnace(float albedo) { return closed_room({albedo, albedo, albedo, albedo, albedo, albedo}, {1, 1, 1, 1, 1, 1}); }

Room uneven() { return closed_room({0.3f, 0.7f, 0.2f, 0.8f, 0.5f, 0.6f}, {0, 2, 0, 0, 0.1f, 0}); }

}  // namespace

TEST_CASE("balancing brings all form factors of a closed room to one, and keeps exchange symmetric") {
    const Problem p(furnace(0.5f), 0.4f, 0.01f);
    RadiositySystem system = p.system();
    Progress progress;
    system.balance(1e-4f, 100, progress);
    const auto sums = system.row_sums();
    for (const uint32_t i : p.tree.leaves())
        if (!p.tree[i].back) CHECK(sums[i] == doctest::Approx(1).epsilon(1e-3));
    // ⟨f, K g⟩ = ⟨K f, g⟩ for any two radiosities: A_i F_ij = A_j F_ji, for parts of linked nodes too.
    std::vector<Color> f(p.tree.nodes().size()), g = f;
    for (const uint32_t i : p.tree.leaves()) {
        f[i] = Color(1 + p.tree[i].center.x * p.tree[i].center.y);
        g[i] = Color(p.tree[i].center.z > 0 ? 2.0f : 0.5f);
    }
    const auto kf = system.irradiance(f), kg = system.irradiance(g);
    double one = 0, other = 0;
    for (const uint32_t i : p.tree.leaves()) {
        one += double(p.tree[i].area) * kf[i].r * g[i].r;
        other += double(p.tree[i].area) * f[i].r * kg[i].r;
    }
    CHECK(one == doctest::Approx(other).epsilon(1e-5));
}

TEST_CASE("a closed room of equal walls: B = π L_e / (1 − ρ), by gathering and by shooting") {
    for (const float albedo : {0.3f, 0.8f}) {
        const Problem p(furnace(albedo), 0.5f, 0.01f);
        RadiositySystem system = p.system();
        Progress progress;
        system.balance(1e-4f, 100, progress);
        for (const bool shoot : {false, true}) {
            PatchLight light =
                shoot ? solve_by_shooting(system, {}, progress) : solve_by_gathering(system, {}, progress);
            CHECK(light.residual <= 1e-5f);
            for (const uint32_t i : p.tree.leaves()) {
                if (p.tree[i].back) continue;
                CHECK(light.total[i].g == doctest::Approx(M_PI / (1 - albedo)).epsilon(0.003));
                CHECK(light.direct[i].g == doctest::Approx(M_PI).epsilon(0.003));
            }
            refine_locally(system, light, progress);
            for (const uint32_t i : p.tree.leaves())
                if (!p.tree[i].back) CHECK(light.total[i].g == doctest::Approx(M_PI / (1 - albedo)).epsilon(0.005));
        }
    }
}

TEST_CASE("gathering and shooting solve the same equation") {
    const Problem p(uneven(), 0.3f, 0.01f);
    const RadiositySystem system = p.system();
    Progress progress;
    const PatchLight gathered = solve_by_gathering(system, {}, progress),
                     shot = solve_by_shooting(system, {}, progress);
    double brightest = 0;
    for (const uint32_t i : p.tree.leaves()) brightest = std::max<double>(brightest, gathered.total[i].g);
    for (const uint32_t i : p.tree.leaves()) {
        CHECK(std::fabs(shot.total[i].g - gathered.total[i].g) < 3e-4 * brightest);
        CHECK(shot.direct[i].g == gathered.direct[i].g);
    }
    // It is the equation's solution: once more through it changes nothing.
    std::vector<Color> radiosity(p.tree.nodes().size());
    for (const uint32_t i : p.tree.leaves())
        radiosity[i] = p.surfaces[i].emitted + p.surfaces[i].albedo * gathered.total[i];
    const auto again = system.irradiance(radiosity);
    for (const uint32_t i : p.tree.leaves()) CHECK(std::fabs(again[i].g - gathered.total[i].g) < 1e-4 * brightest);
}

TEST_CASE("each sweep of gathering adds a bounce") {
    const float albedo = 0.5f;
    const Problem p(furnace(albedo), 0.5f, 0.01f);
    RadiositySystem system = p.system();
    Progress progress;
    system.balance(1e-4f, 100, progress);
    double expected = 0;
    for (const int bounces : {1, 2, 3}) {
        expected += M_PI * std::pow(albedo, bounces - 1);
        const PatchLight light = solve_by_gathering(system, {1e-5f, bounces}, progress);
        for (const uint32_t i : p.tree.leaves())
            if (!p.tree[i].back) CHECK(light.total[i].g == doctest::Approx(expected).epsilon(0.003));
    }
    CHECK(is_black(solve_by_gathering(system, {1e-5f, 0}, progress).total[p.tree.leaves()[0]]));
}

TEST_CASE("the residual of shooting decreases: a few steps give most of the light") {
    const Problem p(uneven(), 0.2f, 0.02f);
    const RadiositySystem system = p.system();
    Progress progress;
    const PatchLight coarse = solve_by_shooting(system, {0.2f, 1000}, progress);
    const PatchLight fine = solve_by_shooting(system, {1e-4f, 1000}, progress);
    CHECK(coarse.residual <= 0.2f);
    CHECK(coarse.sweeps * 3 < fine.sweeps);
}
