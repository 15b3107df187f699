// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "transport/vertex.h"

#include <doctest/doctest.h>

#include <cmath>

#include "room.h"
#include "transport/direct_light.h"
#include "transport/path_loop.h"

using namespace eclat;

namespace {

constexpr float albedo = 0.5f;

/// A room whose ceiling shines.
Room lit_room() { return closed_room({albedo, albedo, albedo, albedo, albedo, albedo}, {0, 1, 0, 0, 0, 0}); }

/// The middle of the floor, seen from above at a slant.
Vertex floor_vertex(const Room& room) {
    const Ray ray{{0.3f, 0.4f, 0.1f}, 0, normalize(Vec3{-0.3f, -1.4f, -0.1f})};
    Progress progress;
    Vertices vertices;
    return vertices.meet(room.world(), {&ray, 1}, Coherence::none, progress)[0];
}

/// Rays from the middle into all directions.
Paths<PathState> fan(uint32_t count) {
    Paths<PathState> paths;
    for (uint32_t i = 0; i < count; ++i) {
        Sampler sampler(1, 0, i);
        paths.push({.sampler = sampler, .index = i}, {{}, 0, square_to_uniform_sphere(sampler.next_2d())});
    }
    return paths;
}

}  // namespace

TEST_CASE("paths have the same vertices, in the same order, for any number of vertices at once") {
    const Room room = lit_room();
    const auto followed = [&](Span span) {
        std::vector<float> out;
        size_t calls = 0;
        Progress progress;
        follow_paths(
            room.world(), fan(100), Coherence::none, span, progress,
            [&](int edges, std::span<PathState> paths, std::span<Vertex> vertices, Paths<PathState>& next) {
                ++calls;
                REQUIRE(paths.size() == vertices.size());
                for (size_t i = 0; i < paths.size(); ++i) {
                    const Vec3 p = vertices[i].point.position;
                    for (const float x : {static_cast<float>(paths[i].index), p.x, p.y, p.z}) out.push_back(x);
                    Ray ray;
                    if (edges < 4 && go_on(vertices[i], LobeSet::all, 1, paths[i], ray)) next.push(paths[i], ray);
                }
            },
            [](Paths<PathState>&) {});
        CHECK(progress.rays == out.size() / 4);
        return std::pair(out, calls);
    };
    const auto [whole, few] = followed(Span::batch);
    const auto [parts, many] = followed(Span::part);
    CHECK(whole == parts);
    CHECK(whole.size() > 4 * 100);
    CHECK(few <= 4);
    CHECK(many > few);
}

TEST_CASE("roulette leaves the mean throughput") {
    const Room room = lit_room();
    const Vertex vertex = floor_vertex(room);
    constexpr uint32_t count = 40000;
    double sum = 0;
    uint32_t survived = 0;
    for (uint32_t i = 0; i < count; ++i) {
        PathState path{.throughput = Color(0.6f), .sampler = Sampler(2, 0, i)};
        Ray ray;
        if (!go_on(vertex, LobeSet::all, 1, path, ray)) continue;
        ++survived;
        sum += path.throughput.g;
    }
    const double chance = 0.6 * albedo;  // what is left of the throughput
    const double deviation = std::sqrt(chance * (1 - chance) / count);
    CHECK(std::fabs(static_cast<double>(survived) / count - chance) < 5 * deviation);
    CHECK(std::fabs(sum / count - 0.6 * albedo) < 5 * deviation);
}

// The form factor of the opposite face of a cube, seen from the middle of a face:
// (4 / π) · h / √(1 + h²) · atan(h / √(1 + h²)) with h = 1 / 2, as the face is twice as far away as half of it is wide.
TEST_CASE("light samples and directions together count all light once, compared with closed forms") {
    const Room room = lit_room();
    const World world = room.world();
    Vertex vertex = floor_vertex(room);
    CHECK(vertex.point.position.x == doctest::Approx(0).epsilon(1e-4));
    const double s = 0.5 / std::sqrt(1.25);
    const double expected = albedo * 4 / M_PI * s * std::atan(s);
    constexpr uint32_t count = 20000;
    const DirectLight lights(world, LightSet::all);
    const auto estimated = [&](const LitLobes& lobes, bool lights_sampled) {
        Progress progress;
        double sum = 0;
        Shadows shadows;
        for (uint32_t i = 0; i < count; ++i) {
            PathState path{.sampler = Sampler(3, 0, i)};
            const WantedLight wanted{&path, &vertex, path.sampler, lobes, true};
            if (lights_sampled) lights.sample({&wanted, 1}, shadows);
            path.sampler.skip(light_sample_dimensions);
            Ray ray;
            if (!lobes.has_shared || !go_on(vertex, LobeSet::all, 0, path, ray)) continue;
            if (!lights_sampled) path.arrival = Arrival::whole;
            Vertices vertices;
            Vertex& met = vertices.meet(world, {&ray, 1}, Coherence::none, progress)[0];
            lights.arrive(path, met);
            sum += met.arriving.g;
        }
        shadows.resolve(world, progress, [&](uint32_t, Color contribution, bool) { sum += contribution.g; });
        return sum / count;
    };
    const LitLobes alone{.alone = LobeSet::all, .shared = LobeSet::all, .has_shared = false};
    const LitLobes shared{.alone = LobeSet::cached, .shared = LobeSet::all};
    CHECK(estimated(alone, true) == doctest::Approx(expected).epsilon(0.005));
    CHECK(estimated(shared, true) == doctest::Approx(expected).epsilon(0.005));
    CHECK(estimated(shared, false) == doctest::Approx(expected).epsilon(0.005));
}
