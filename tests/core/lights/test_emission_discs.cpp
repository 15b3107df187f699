// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Flux of photons from infinity: even over all of the scene, by many photons before its places and by few elsewhere.

#include "lights/emission_discs.h"

#include <doctest/doctest.h>

#include "running_mean.h"
#include "sampling/rng.h"

using namespace eclat;

TEST_CASE("photons of a sun bring the same irradiance everywhere, and most start before the places") {
    const Ball whole{{1, 2, 3}, 100};
    const std::vector<Ball> places{{{1, 2, 3}, 1}, {{31, 2, 3}, 2}};
    const EmissionDiscs discs(whole, places);
    CHECK(discs.area() == doctest::Approx(pi * (1 + 4)).epsilon(1e-5));
    LightSample sun;
    sun.wi = {0, 1, 0};
    sun.radiance = Color(7);
    sun.pdf_solid_angle = 1;
    // Squares in the plane of the middle: within both places, between them, and far away.
    const std::vector<std::pair<Vec3, float>> squares{
        {{1, 0, 3}, 0.5f}, {{31, 0, 3}, 1}, {{16, 0, 3}, 4}, {{1, 0, 63}, 30}};
    std::vector<RunningMean> flux(squares.size());
    RunningMean all;
    Rng rng(5, 1);
    int near = 0;
    constexpr int count = 200000;
    for (int i = 0; i < count; ++i) {
        const float u = rng.next();
        const PhotonSample p = discs.emit(sun, {u, rng.next()});
        all.add(p.power.g);
        for (size_t k = 0; k < squares.size(); ++k) {
            const auto [middle, half] = squares[k];
            const bool in = std::fabs(p.origin.x - middle.x) < half && std::fabs(p.origin.z - middle.z) < half;
            flux[k].add(in ? p.power.g / (4 * half * half) : 0);
        }
        if (is_black(p.power)) continue;
        REQUIRE(p.origin.y == doctest::Approx(202).epsilon(1e-4));
        for (const Ball& ball : places)
            near += std::hypot(p.origin.x - ball.center.x, p.origin.z - ball.center.z) < ball.radius;
    }
    for (const RunningMean& f : flux) CHECK(std::abs(f.mean() - 7) <= 5 * f.standard_error());
    CHECK(std::abs(all.mean() - 7 * pi * 1e4) <= 5 * all.standard_error());
    CHECK(near > count / 12);  // of the even disc 5 in 10,000 lie there
}

TEST_CASE("without places the disc is even") {
    const EmissionDiscs discs({{}, 3}, {});
    LightSample sun;
    sun.wi = {0, 0, 1};
    sun.radiance = Color(2);
    sun.pdf_solid_angle = 1;
    Rng rng(6, 1);
    for (int i = 0; i < 100; ++i) {
        const float u = rng.next();
        const PhotonSample p = discs.emit(sun, {u, rng.next()});
        CHECK(p.power.g == doctest::Approx(2 * pi * 9).epsilon(1e-5));
        CHECK(p.importance == 1);
        CHECK(p.origin.z == doctest::Approx(6).epsilon(1e-5));
    }
}
