// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The ray tracer against a loop over all triangles in double precision.

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "running_mean.h"
#include "sampling/rng.h"
#include "sampling/warp.h"
#include "scene/intersect.h"

using namespace eclat;

namespace {

struct Soup {
    std::vector<Vec3> vertices;  // one more than is shown
    std::vector<Intersector::Triangle> triangles;
    std::vector<Sieve> sieves;

    std::span<const Vec3> shown() const { return std::span(vertices).first(vertices.size() - 1); }
};

Vec3 in_cube(Rng& rng) {
    const float x = rng.next(), y = rng.next(), z = rng.next();
    return {x, y, z};
}

Soup soup(int count) {
    Soup s;
    Rng rng(31, 0);
    for (int i = 0; i < count; ++i) {
        const Vec3 center = in_cube(rng);
        for (int k = 0; k < 3; ++k) s.vertices.push_back(center + (in_cube(rng) - Vec3{0.5f, 0.5f, 0.5f}) * 0.3f);
        const auto v = static_cast<uint32_t>(3 * i);
        s.triangles.push_back({{v, v + 1, v + 2}});
        s.sieves.emplace_back();
    }
    s.vertices.push_back({});
    return s;
}

struct Met {
    double t, u, v;
};

/// By Cramer's rule: origin + t · direction = a + u (b − a) + v (c − a).
std::optional<Met> meet(const Soup& s, const Intersector::Triangle& t, const Ray& ray) {
    using D = std::array<double, 3>;
    const auto d = [](Vec3 x) { return D{x.x, x.y, x.z}; };
    const auto minus = [](D x, D y) { return D{x[0] - y[0], x[1] - y[1], x[2] - y[2]}; };
    const auto det = [](D x, D y, D z) {
        return x[0] * (y[1] * z[2] - y[2] * z[1]) - x[1] * (y[0] * z[2] - y[2] * z[0]) +
               x[2] * (y[0] * z[1] - y[1] * z[0]);
    };
    const D a = d(s.vertices[t.v[0]]), e1 = minus(d(s.vertices[t.v[1]]), a), e2 = minus(d(s.vertices[t.v[2]]), a);
    const D w = d(ray.direction), o = minus(d(ray.origin), a), back = {-w[0], -w[1], -w[2]};
    const double whole = det(back, e1, e2);
    if (whole == 0) return std::nullopt;
    const Met m{det(o, e1, e2) / whole, det(back, o, e2) / whole, det(back, e1, o) / whole};
    if (m.t < ray.t_min || m.t > ray.t_max || m.u < 0 || m.v < 0 || m.u + m.v > 1) return std::nullopt;
    return m;
}

std::vector<Ray> random_rays(int count, float t_max) {
    Rng rng(32, 1);
    std::vector<Ray> rays;
    for (int i = 0; i < count; ++i) {
        const Vec3 origin = in_cube(rng);
        const float u = rng.next(), v = rng.next();
        rays.push_back({origin, 0, square_to_uniform_sphere({u, v}), t_max});
    }
    return rays;
}

}  // namespace

TEST_CASE("closest hits and occlusion are those of a loop over all triangles") {
    const Soup s = soup(200);
    const Intersector rays_in(s.shown(), s.triangles, s.sieves, {});
    for (float t_max : {infinity, 0.2f})
        for (Coherence coherence : {Coherence::none, Coherence::camera}) {
            const auto rays = random_rays(1003, t_max);  // the last packet is not full
            std::vector<Hit> hits(rays.size());
            std::vector<uint8_t> occluded(rays.size());
            rays_in.intersect(rays, hits, coherence);
            rays_in.occluded(rays, occluded);
            int met = 0;
            for (size_t i = 0; i < rays.size(); ++i) {
                Met nearest{infinity, 0, 0};
                uint32_t which = no_triangle;
                for (uint32_t k = 0; k < s.triangles.size(); ++k)
                    if (const auto m = meet(s, s.triangles[k], rays[i]); m && m->t < nearest.t) nearest = *m, which = k;
                CHECK(hits[i].triangle == which);
                CHECK(bool(occluded[i]) == (which != no_triangle));
                if (which == no_triangle) continue;
                ++met;
                CHECK(hits[i].t == doctest::Approx(nearest.t).epsilon(1e-4));
                CHECK(std::abs(hits[i].u - nearest.u) < 1e-3);
                CHECK(std::abs(hits[i].v - nearest.v) < 1e-3);
            }
            CHECK(met > 100);
        }
}

TEST_CASE("panes attenuate light samples and are hit by other rays") {
    // A pane of opacity 1 and one of 0.5, and a wall behind half of them.
    Soup s;
    for (float z : {1.0f, 2.0f, 3.0f})
        for (float x : {0.0f, 1.0f})
            for (float y : {0.0f, 1.0f}) s.vertices.push_back({x, y, z});
    s.vertices.push_back({});
    s.triangles = {{{0, 1, 2}}, {{1, 3, 2}}, {{4, 5, 6}}, {{5, 7, 6}}, {{8, 9, 10}}};
    s.sieves = {
        {.pane = true}, {.pane = true}, {.translucent = true, .pane = true}, {.translucent = true, .pane = true}, {}};
    const Intersector rays_in(
        s.shown(), s.triangles, s.sieves, [](uint32_t triangle, float, float) { return triangle < 2 ? 1.0f : 0.5f; },
        [](uint32_t, float, float, Vec3 w) { return Color{0.5f, 0.25f, w.z}; });
    const std::vector<Ray> rays{{{0.2f, 0.2f, 0}, 0, {0, 0, 1}, infinity},
                                {{0.8f, 0.8f, 0}, 0, {0, 0, 1}, infinity},
                                {{0.8f, 0.8f, 0}, 0, {0, 0, 1}, 1.5f},
                                {{0.8f, 0.8f, 0}, 0, {0, 0, -1}, infinity}};
    std::vector<Color> passed(rays.size());
    rays_in.transmitted(rays, passed);
    const Color expected[]{{0, 0, 0}, {0.5f * 0.75f, 0.25f * 0.625f, 1}, {0.5f, 0.25f, 1}, {1, 1, 1}};
    for (size_t i = 0; i < rays.size(); ++i) {
        CHECK(passed[i].r == doctest::Approx(expected[i].r));
        CHECK(passed[i].g == doctest::Approx(expected[i].g));
        CHECK(passed[i].b == doctest::Approx(expected[i].b));
    }
    std::vector<uint8_t> hidden(rays.size());
    rays_in.occluded(rays, hidden);
    CHECK(hidden == std::vector<uint8_t>{1, 1, 1, 0});
}

TEST_CASE("a partly opaque triangle stops a share of rays equal to its opacity") {
    // Two parallel squares, the nearer one of opacity 0.3 in its lower half, 1 in its upper half.
    Soup s;
    for (float z : {1.0f, 2.0f})
        for (float x : {0.0f, 1.0f})
            for (float y : {0.0f, 1.0f}) s.vertices.push_back({x, y, z});
    s.vertices.push_back({});
    s.triangles = {{{0, 1, 2}}, {{1, 3, 2}}, {{4, 5, 6}}, {{5, 7, 6}}};
    s.sieves = {{.translucent = true}, {.translucent = true}, {}, {}};
    const Intersector rays_in(s.shown(), s.triangles, s.sieves,
                              [](uint32_t triangle, float, float) { return triangle == 0 ? 0.3f : 1.0f; });
    Rng rng(33, 2);
    std::vector<Ray> rays;
    for (int i = 0; i < 20000; ++i) {
        const float x = rng.next(), y = rng.next();
        rays.push_back({{x, y, 0}, 0, {0, 0, 1}, infinity});
    }
    std::vector<Hit> hits(rays.size());
    rays_in.intersect(rays, hits);
    RunningMean stopped;
    for (size_t i = 0; i < rays.size(); ++i) {
        REQUIRE_FALSE(hits[i].missed());
        if (rays[i].origin.x + rays[i].origin.y < 1)
            stopped.add(hits[i].t < 1.5f);
        else
            CHECK(hits[i].triangle == 1);
    }
    CHECK(stopped.agrees(0.3));
    // Light that is asked for passes each of them in part.
    std::vector<Ray> short_rays(rays.begin(), rays.begin() + 100);
    for (Ray& ray : short_rays) ray.t_max = 1.5f;
    std::vector<Color> passed(short_rays.size());
    rays_in.transmitted(short_rays, passed);
    for (size_t i = 0; i < short_rays.size(); ++i)
        CHECK(passed[i].g == doctest::Approx(rays[i].origin.x + rays[i].origin.y < 1 ? 0.7f : 0.0f));
    // The answer belongs to the ray: asked again, alone, it is the same.
    Hit again;
    for (size_t i = 0; i < 100; ++i) {
        rays_in.intersect(std::span(rays).subspan(i, 1), std::span(&again, 1));
        CHECK(again.triangle == hits[i].triangle);
    }
}

TEST_CASE("rays pass through culled backs, alone and where they are translucent, unless they ask for them") {
    const Soup plain = soup(200);
    Soup s = plain;
    for (size_t i = 0; i < s.sieves.size(); ++i) s.sieves[i] = {.translucent = i % 4 == 0, .back_culled = i % 2 == 0};
    const Intersector rays_in(s.shown(), s.triangles, s.sieves, [](uint32_t, float, float) { return 1.0f; });
    CHECK(rays_in.culls_backs());
    CHECK_FALSE(Intersector(plain.shown(), plain.triangles, plain.sieves, {}).culls_backs());
    const auto rays = random_rays(1003, infinity);
    for (const Backs backs : {Backs::culled, Backs::met}) {
        std::vector<Hit> hits(rays.size());
        std::vector<uint8_t> occluded(rays.size());
        rays_in.intersect(rays, hits, Coherence::none, backs);
        rays_in.occluded(rays, occluded, backs);
        int passed = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            double nearest = infinity;
            uint32_t which = no_triangle;
            for (uint32_t k = 0; k < s.triangles.size(); ++k) {
                const auto& v = s.triangles[k].v;
                const Vec3 a = s.vertices[v[0]], normal = cross(s.vertices[v[1]] - a, s.vertices[v[2]] - a);
                const auto m = meet(s, s.triangles[k], rays[i]);
                if (!m) continue;
                const bool culled = s.sieves[k].back_culled && dot(normal, rays[i].direction) > 0;
                passed += culled;
                if ((backs == Backs::met || !culled) && m->t < nearest) nearest = m->t, which = k;
            }
            CHECK(hits[i].triangle == which);
            CHECK(bool(occluded[i]) == (which != no_triangle));
        }
        CHECK(passed > 100);
    }
}

TEST_CASE("rays that the ray tracer cannot trace hit nothing and do not affect others") {
    const Soup s = soup(200);
    const Intersector rays_in(s.shown(), s.triangles, s.sieves, {});
    const auto sound = random_rays(16, infinity);
    std::vector<Hit> expected(sound.size()), hits(sound.size());
    rays_in.intersect(sound, expected);
    auto rays = sound;
    rays[1].origin.x = 2e18f;
    rays[3].direction = {NAN, 0, 0};
    rays[10].direction = {0, infinity, 0};
    rays[12].t_max = NAN;
    const auto broken = [](size_t i) { return i == 1 || i == 3 || i == 10 || i == 12; };
    std::vector<uint8_t> hidden(rays.size());
    std::vector<Color> passed(rays.size());
    rays_in.intersect(rays, hits);
    rays_in.occluded(rays, hidden);
    rays_in.transmitted(rays, passed);
    for (size_t i = 0; i < rays.size(); ++i) {
        CHECK(hits[i].triangle == (broken(i) ? no_triangle : expected[i].triangle));
        CHECK(bool(hidden[i]) == (broken(i) || !expected[i].missed()));
        CHECK(passed[i].r == (hidden[i] ? 0 : 1));
    }
}

TEST_CASE(
    "rays of a camera pass through what is hidden from it, and other rays meet it, with every other test as well") {
    Soup s;
    for (const float z : {1.0f, 2.0f})
        for (const Vec3 corner : {Vec3{-9, -9, z}, Vec3{9, -9, z}, Vec3{0, 9, z}}) s.vertices.push_back(corner);
    s.vertices.push_back({});
    s.triangles = {{{0, 1, 2}}, {{3, 4, 5}}};
    const Ray ray{{0, 0, 0}, 0, {0, 0, 1}, infinity};
    for (const bool translucent : {false, true})
        for (const bool back_culled : {false, true})
            for (const bool pane : {false, true})
                for (const bool hidden : {false, true}) {
                    // Seen from below, the fronts of these triangles look away, so culled ones are not met at all.
                    s.sieves = {{translucent, back_culled, pane, hidden}, {}};
                    const Intersector rays(
                        s.shown(), s.triangles, s.sieves, [](uint32_t, float, float) { return 1.0f; },
                        [](uint32_t, float, float, Vec3) { return Color(); });
                    Hit seen, met;
                    uint8_t hides = 0;
                    rays.intersect({&ray, 1}, {&seen, 1}, Coherence::camera);
                    rays.intersect({&ray, 1}, {&met, 1});
                    const Ray shadow{{0, 0, 0}, 0, {0, 0, 1}, 1.5f};
                    rays.occluded({&shadow, 1}, {&hides, 1});
                    CHECK(met.triangle == (back_culled ? 1 : 0));
                    CHECK(seen.triangle == (back_culled || hidden ? 1 : 0));
                    CHECK(hides == (back_culled ? 0 : 1));
                }
}
