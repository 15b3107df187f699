// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Form factors against closed forms: rectangles [Howell10], and the inside of a sphere.

#include "methods/radiosity/form_factor.h"

#include <doctest/doctest.h>

#include <vector>

#include "room.h"
#include "rectangles.h"

using namespace eclat;

namespace {

PatchNode patch(Vec3 a, Vec3 b, Vec3 c) {
    PatchNode p;
    p.corner[0] = a, p.corner[1] = b, p.corner[2] = c;
    const Vec3 n = cross(b - a, c - a);
    p.normal = normalize(n);
    p.area = 0.5f * length(n);
    p.center = (a + b + c) / 3;
    for (const Vec3& v : p.corner) p.radius = std::max(p.radius, length(v - p.center));
    p.triangle = 0;
    return p;
}

/// A sphere of 8 · 4^depth triangles that look inwards.
std::vector<PatchNode> sphere(int depth) {
    std::vector<std::array<Vec3, 3>> triangles;
    for (const float x : {-1.0f, 1.0f})
        for (const float y : {-1.0f, 1.0f})
            for (const float z : {-1.0f, 1.0f}) {
                const bool turn = x * y * z > 0;
                triangles.push_back(
                    {Vec3{x, 0, 0}, turn ? Vec3{0, 0, z} : Vec3{0, y, 0}, turn ? Vec3{0, y, 0} : Vec3{0, 0, z}});
            }
    for (int i = 0; i < depth; ++i) {
        std::vector<std::array<Vec3, 3>> finer;
        for (const auto& [a, b, c] : triangles) {
            const Vec3 ab = normalize(a + b), bc = normalize(b + c), ca = normalize(c + a);
            for (const auto& t :
                 {std::array{a, ab, ca}, std::array{ab, b, bc}, std::array{ca, bc, c}, std::array{ab, bc, ca}})
                finer.push_back(t);
        }
        triangles = finer;
    }
    std::vector<PatchNode> out;
    for (const auto& [a, b, c] : triangles) out.push_back(patch(a, b, c));
    return out;
}

}  // namespace

TEST_CASE("from a point to a rectangle above its corner: the closed form, and half of it where the horizon cuts it") {
    const float a = 1.3f, b = 0.7f, c = 0.9f;
    const Vec3 first[3] = {{0, 0, c}, {a, 0, c}, {a, b, c}}, second[3] = {{0, 0, c}, {0, b, c}, {a, b, c}};
    const double x = a / c, y = b / c;
    const double exact = 1 / (2 * M_PI) *
                         (x / std::sqrt(1 + x * x) * std::atan(y / std::sqrt(1 + x * x)) +
                          y / std::sqrt(1 + y * y) * std::atan(x / std::sqrt(1 + y * y)));
    const Vec3 up{0, 0, 1};
    CHECK(point_to_triangle({}, up, first) + point_to_triangle({}, up, second) == doctest::Approx(exact).epsilon(1e-5));
    // A triangle that reaches as far below the horizon as above, seen by a point that looks at it.
    const Vec3 half[3] = {{1, -1, 2}, {1, 1, 2}, {1, 0, -2}}, part[3] = {{1, -1, 2}, {1, 1, 2}, {1, 0.5f, 0}},
               rest[3] = {{1, -1, 2}, {1, 0.5f, 0}, {1, -0.5f, 0}};
    CHECK(point_to_triangle({}, up, half) ==
          doctest::Approx(point_to_triangle({}, up, part) + point_to_triangle({}, up, rest)).epsilon(1e-4));
    const Vec3 below[3] = {{1, -1, -2}, {1, 1, -2}, {1, 0, -0.1f}};
    CHECK(point_to_triangle({}, up, below) == 0);
}

TEST_CASE("a patch that is far enough to be a point has the exact form factor all the same") {
    const PatchNode p = patch({0, 0, 5}, {0.03f, 0.1f, 5}, {0.1f, 0, 5});
    REQUIRE(p.normal.z < 0);
    for (const Vec3 x : {Vec3{}, Vec3{2, 1, 0}, Vec3{-4, 3, 1}})
        CHECK(point_to_patch(x, {0, 0, 1}, p) ==
              doctest::Approx(point_to_triangle(x, {0, 0, 1}, p.corner)).epsilon(5e-4));
    CHECK(point_to_patch({0, 0, 6}, {0, 0, -1}, p) == 0);  // from behind
}

TEST_CASE("exchange between rectangles of many patches: parallel and perpendicular, in closed form") {
    for (const auto& [gap, angle] : {std::pair{1.0f, 0}, std::pair{0.4f, 0}, std::pair{0.0f, 90}}) {
        // 1.5 × 1, divided into n × n cells of two triangles.
        const auto cells = [](Vec3 corner, Vec3 e1, Vec3 e2) {
            constexpr int n = 6;
            std::vector<PatchNode> out;
            for (int i = 0; i < n; ++i)
                for (int j = 0; j < n; ++j) {
                    const Vec3 u = e1 / n, v = e2 / n, at = corner + u * float(i) + v * float(j);
                    out.push_back(patch(at, at + u, at + u + v));
                    out.push_back(patch(at, at + u + v, at + v));
                }
            return out;
        };
        const auto one = cells({0, 0, 0}, {1.5f, 0, 0}, {0, 1, 0});
        const auto other =
            angle ? cells({0, 0, 0}, {0, 0, 0.8f}, {1.5f, 0, 0}) : cells({0, 0, gap}, {0, 1, 0}, {1.5f, 0, 0});
        double exchange = 0;
        for (const PatchNode& p : one)
            for (const PatchNode& q : other) {
                const float near = std::min(1.0f, (p.radius + q.radius) / length(p.center - q.center));
                const float there = patch_exchange(p, q, near);
                CHECK(may_see(p, q) >= (there > 0));
                exchange += there;
            }
        const double exact = angle ? perpendicular_rectangles(1, 0.8, 1.5) : parallel_rectangles(1.5, 1, gap);
        CHECK(exchange / 1.5 == doctest::Approx(exact).epsilon(0.003));
    }
}

TEST_CASE("inside of a sphere every form factor is the sender's share of the area") {
    const auto patches = sphere(3);
    double area = 0;
    for (const PatchNode& p : patches) area += p.area;
    double worst_row = 0, squares = 0, pairs = 0;
    for (const PatchNode& i : patches) {
        double row = 0;
        for (const PatchNode& j : patches) {
            if (&i == &j) continue;
            const float near = std::min(1.0f, (i.radius + j.radius) / length(i.center - j.center));
            const double f = patch_exchange(i, j, near) / i.area;
            row += f;
            // Flat facets near by are seen at grazing angles, at which their tilt against the sphere counts.
            if (near < 0.3f) squares += std::pow(f / (j.area / area) - 1, 2), ++pairs;
        }
        worst_row = std::max(worst_row, std::fabs(row - 1));
    }
    CHECK(worst_row < 0.01);
    CHECK(std::sqrt(squares / pairs) < 0.03);
    CHECK(pairs > 0.7 * double(patches.size() * patches.size()));
}

TEST_CASE("points for rays lie on their patches, and exchange by them is the exact one") {
    const Room room =
        build_room({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0.5f, 0}, {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}, 0.5f, 0}});
    const PatchTree tree(*room.geometry, infinity);
    uint32_t up = no_node, down = no_node;
    for (const uint32_t leaf : tree.leaves()) {
        if (tree[leaf].triangle == 0 && !tree[leaf].back) up = leaf;
        if (tree[leaf].triangle == 2 && !tree[leaf].back) down = leaf;
    }
    constexpr uint32_t count = 4096;
    double sum = 0;
    for (uint32_t i = 0; i < count; ++i) {
        const PointPair p = ExposedParts(tree, {}).sample_pair(up, down, 1, i, count);
        CHECK(p.x.z == 0);
        CHECK(p.y.z == 1);
        sum += p.kernel();
    }
    const double expected = patch_exchange(tree[up], tree[down], 1);
    CHECK(tree[up].area * tree[down].area * sum / count == doctest::Approx(expected).epsilon(0.01));
}
