// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Where the flux of a closed room goes: photons carry what the lights emit, and after each bounce the reflected part.

#include <doctest/doctest.h>

#include <array>
#include <cstring>

#include "methods/photon_map/trace_photons.h"
#include "room.h"

using namespace eclat;

namespace {

double flux(const std::vector<Photon>& photons, uint64_t paths, float edges = 0) {
    double sum = 0;
    for (const Photon& p : photons)
        if (edges == 0 || p.edges == edges) sum += p.power.g;
    return sum / double(paths);
}

constexpr Stored everything{.direct = true, .caustic = true, .indirect = true};

}  // namespace

TEST_CASE("the flux that arrives in a closed room is the emitted one over 1 - albedo, edge by edge its power") {
    const float albedo = 0.6f;
    const Room room = closed_room({albedo, albedo, albedo, albedo, albedo, albedo}, {0, 2, 0, 0, 0, 0});
    Progress progress;
    const uint64_t paths = 100000;
    const auto photons = trace_photons(room.world(), {0, paths}, {.stored = everything}, progress);
    const double emitted = M_PI * 2 * 4;  // π L A
    CHECK(room.lights.total_power().g == doctest::Approx(emitted).epsilon(1e-5));
    // The roulette's variance: the number of bounces is geometric, its deviation √ρ / (1 − ρ).
    CHECK(flux(photons, paths) == doctest::Approx(emitted / (1 - albedo)).epsilon(5 * 0.8 / std::sqrt(paths)));
    CHECK(flux(photons, paths, 1) == doctest::Approx(emitted).epsilon(1e-5));
    for (const float edges : {2.0f, 3.0f, 4.0f}) {
        const double part = std::pow(albedo, edges - 1);
        CHECK(flux(photons, paths, edges) ==
              doctest::Approx(emitted * part).epsilon(5 * std::sqrt((1 - part) / part / paths)));
    }
    CHECK(progress.rays == photons.size());
    for (const Photon& p : photons) {
        CHECK(dot(p.direction, p.normal) > 0);
        CHECK(std::max(std::fabs(p.position.x), std::max(std::fabs(p.position.y), std::fabs(p.position.z))) <= 1.0001f);
    }
}

TEST_CASE("photons are the same on one thread and on two, and in parts") {
    const Room room = closed_room({0.5f, 0.7f, 0.2f, 0.6f, 0.5f, 0.5f}, {0, 0, 3, 0, 0, 0});
    Progress progress;
    const auto traced = [&](int threads, PhotonPaths paths) {
        return trace_photons(room.world(), paths, {.stored = everything, .seed = 3, .threads = threads}, progress);
    };
    const auto one = traced(1, {0, 20000}), two = traced(2, {0, 20000});
    REQUIRE(one.size() == two.size());
    CHECK(std::memcmp(one.data(), two.data(), one.size() * sizeof(Photon)) == 0);
    const auto first = traced(2, {0, 8192}), second = traced(2, {8192, 20000});
    REQUIRE(first.size() + second.size() == one.size());
    CHECK(std::memcmp(one.data(), first.data(), first.size() * sizeof(Photon)) == 0);
    CHECK(std::memcmp(one.data() + first.size(), second.data(), second.size() * sizeof(Photon)) == 0);
}

TEST_CASE("tracing continues until the wanted number of photons is stored, or ends if none can be stored") {
    const Room room = closed_room({0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f}, {0, 2, 0, 0, 0, 0});
    Progress progress;
    const auto some = trace_until(room.world(), 30000, 1 << 20, {.stored = {.indirect = true}}, progress);
    CHECK(some.photons.size() >= 30000);
    CHECK(some.photons.size() < 50000);
    CHECK(flux(some.photons, some.paths) == doctest::Approx(M_PI * 2 * 4).epsilon(0.05));
    const auto none = trace_until(room.world(), 30000, 1 << 15, {.stored = {.caustic = true}}, progress);
    CHECK(none.photons.empty());
    CHECK(none.paths == 1 << 15);
    const auto shallow = trace_photons(room.world(), {0, 5000}, {.stored = everything, .max_edges = 2}, progress);
    for (const Photon& p : shallow) CHECK(p.edges <= 2);
}
