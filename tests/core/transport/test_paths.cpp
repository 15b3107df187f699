// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "transport/paths.h"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "room.h"

using namespace eclat;

namespace {

/// A room whose ceiling shines, with a floor of bright varnish.
Room varnished_room() {
    const auto walls = closed_walls({0.9f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f}, {0, 1, 0, 0, 0, 0});
    std::vector<Material> materials = own_materials(walls);
    materials[0] = varnish(0.9f, 0.2f);
    return build_room(walls, materials);
}

struct Traced {
    double mean = 0, deviation = 0;  // of the radiance, and the standard error of its mean
    uint64_t rays = 0;
};

/// The radiance of the floor where a cache knows all light of matte lobes.
Traced traced(const Room& room, float roulette_beside_cache) {
    constexpr uint32_t count = 20000;
    std::vector<PathRay> rays;
    for (uint32_t i = 0; i < count; ++i)
        rays.push_back({{{0.3f, 0.4f, 0.1f}, 0, normalize(Vec3{-0.3f, -1.4f, -0.1f})}, Sampler(5, 0, i)});
    PathOptions options;
    options.cache = [](const SurfacePoint&, float) { return Color(1); };
    options.roulette_beside_cache = roulette_beside_cache;
    std::vector<PathResult> results(count);
    Progress progress;
    trace_paths(room.world(), rays, options, results, progress);
    double sum = 0, squares = 0;
    for (const PathResult& r : results)
        sum += r.radiance.g, squares += static_cast<double>(r.radiance.g) * r.radiance.g;
    const double mean = sum / count;
    return {mean, std::sqrt((squares / count - mean * mean) / count), progress.rays};
}

}  // namespace

TEST_CASE("roulette beside a cache leaves the mean radiance and saves rays") {
    const Room room = varnished_room();
    const Traced all = traced(room, 0), few = traced(room, 4);
    CHECK(few.rays < 0.8 * static_cast<double>(all.rays));
    CHECK(std::fabs(few.mean - all.mean) < 4 * std::hypot(few.deviation, all.deviation));
}
