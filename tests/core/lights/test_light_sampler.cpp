// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Which light is sampled: half of the choices by power, half evenly among the groups of lights that shine.

#include <doctest/doctest.h>

#include "lights/light_sampler.h"

using namespace eclat;

TEST_CASE("half of the choices follow power, half are shared by the groups, so that no group starves") {
    // Two dim triangles under a sun; the sun's group and the triangles' are the only ones that shine.
    const LightSampler sampler({{{1, 1}, {}, {}, {}, {98}, {}}});
    const auto pdf = [&](LightKind kind, uint32_t i) { return sampler.pdf_discrete(LightSet::all, kind, i); };
    CHECK(pdf(LightKind::triangle, 0) == doctest::Approx(0.5 * 1 / 100 + 0.5 * 1 / (2 * 2)).epsilon(1e-5));
    CHECK(pdf(LightKind::triangle, 1) == doctest::Approx(pdf(LightKind::triangle, 0)).epsilon(1e-5));
    CHECK(pdf(LightKind::directional, 0) == doctest::Approx(0.5 * 98 / 100 + 0.5 / 2).epsilon(1e-5));
}

TEST_CASE("point and spot lights are one group, and the environment can be excluded") {
    const LightSampler sampler({{{}, {3}, {1}, {}, {}, {4}}});
    const auto pdf = [&](LightSet set, LightKind kind) { return sampler.pdf_discrete(set, kind, 0); };
    CHECK(pdf(LightSet::all, LightKind::point) == doctest::Approx(0.5 * 3 / 8 + 0.5 * 3 / (2 * 4)).epsilon(1e-5));
    CHECK(pdf(LightSet::all, LightKind::environment) == doctest::Approx(0.5 * 4 / 8 + 0.5 / 2).epsilon(1e-5));
    CHECK(pdf(LightSet::without_smooth_environment, LightKind::environment) == 0);
    CHECK(pdf(LightSet::without_smooth_environment, LightKind::point) == doctest::Approx(0.75).epsilon(1e-5));
    CHECK(pdf(LightSet::without_smooth_environment, LightKind::spot) == doctest::Approx(0.25).epsilon(1e-5));
}
