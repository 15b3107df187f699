// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A guide is a density: its samples have it, it is positive everywhere, sums do not change. It finds what is rare.

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "methods/photon_map/emission_guide.h"
#include "running_mean.h"
#include "sampling/sampler.h"

using namespace eclat;

namespace {

/// What is stored of an emission: a rare place, in the middle of two numbers, with a gradient along a third.
float stored(const EmissionNumbers& u) {
    const float x = u[1] - 0.5f, y = u[4] - 0.45f;
    return x * x + y * y < 0.002f ? 1 + u[2] : 0;
}
constexpr double truth = M_PI * 0.002 * 1.5;

EmissionGuide::Guided sampled(const EmissionGuide& guide, uint32_t stream, uint32_t i) {
    Sampler s(stream, 0, i);
    const float u_box = s.next_1d(), u_light = s.next_1d();
    const Vec2 a = s.next_2d(), b = s.next_2d();
    return guide.sample(u_box, {u_light, a.x, a.y, b.x, b.y});
}

EmissionGuide learnt() {
    EmissionGuide guide;
    for (uint32_t round = 0; round < 5; ++round) {
        std::vector<EmissionGuide::Result> results;
        for (uint32_t i = 0; i < 30000; ++i) {
            const auto g = sampled(guide, 10 + round, i);
            results.push_back({g.u, g.box, stored(g.u)});
        }
        guide.refine(results);
    }
    return guide;
}

}  // namespace

TEST_CASE("a guide is uniform before it learns") {
    const EmissionGuide guide;
    const EmissionNumbers u{0.1f, 0.2f, 0.3f, 0.4f, 0.5f};
    const auto g = guide.sample(0.7f, u);
    CHECK(g.u == u);
    CHECK(g.pdf == 1);
    EmissionGuide still = guide;
    still.refine(std::vector<EmissionGuide::Result>{{u, 0, 0}});
    CHECK(still.uniform());
}

TEST_CASE("a guide finds rare paths more often, with bounded weights, and leaves sums unchanged") {
    const EmissionGuide guide = learnt();
    CHECK(guide.boxes() > 4);
    RunningMean one, mean;
    constexpr uint32_t count = 200000;
    int hits = 0;
    float least = 1e9f, largest = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const auto g = sampled(guide, 1, i);
        REQUIRE(g.pdf > 0.09f);  // a tenth stays uniform
        one.add(1 / double(g.pdf));
        mean.add(stored(g.u) / g.pdf);
        if (stored(g.u) == 0) continue;
        ++hits;
        least = std::min(least, g.pdf);
        largest = std::max(largest, g.pdf);
    }
    CHECK(one.agrees(1));
    CHECK(mean.agrees(truth));
    CHECK(hits > 20 * M_PI * 0.002 * count);  // twenty times as often as without
    CHECK(largest / least < 12);
}
