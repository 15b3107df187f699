// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// References   [Lambert1760] the form factor of a polygon, [Hanrahan91] estimates that decide about links
// Held to      tests/core/methods/radiosity/test_form_factor.cpp

#include "methods/radiosity/form_factor.h"

#include <algorithm>

#include "sampling/sampler.h"
#include "sampling/warp.h"

namespace eclat {

namespace {

// If the ratio of a triangle's radius to its distance is below this, the triangle is treated as a point, with a
// relative error of about the square of the ratio, 2e-4.
constexpr float point_like = 1.0f / 64;

// Points whose height above a plane is below this, relative to the sizes involved, count as lying in it.
constexpr float coplanar = 1e-5f;

struct Barycentric {
    float a, b;
};

/// Quadrature points of equal weight: the centroid, three points that integrate quadratic functions exactly, or the
/// centroids of sixteen similar parts.
constexpr std::array<Barycentric, 1> one_point{{{1.0f / 3, 1.0f / 3}}};
constexpr std::array<Barycentric, 3> three_points{{{1.0f / 6, 1.0f / 6}, {2.0f / 3, 1.0f / 6}, {1.0f / 6, 2.0f / 3}}};
constexpr std::array<Barycentric, 16> sixteen_points = [] {
    std::array<Barycentric, 16> out{};
    size_t n = 0;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; i + j < 4; ++j) {
            const float u = static_cast<float>(i), v = static_cast<float>(j);
            out[n++] = {(u + 1.0f / 3) / 4, (v + 1.0f / 3) / 4};
            if (i + j < 3) out[n++] = {(u + 2.0f / 3) / 4, (v + 2.0f / 3) / 4};
        }
    return out;
}();

std::span<const Barycentric> quadrature(float near) {
    // These limits are tuned: the error of row sums in a box of uniform patches is then below 1 %.
    if (near < 0.1f) return one_point;
    if (near < 0.4f) return three_points;
    return sixteen_points;
}

Vec3 point_of(const PatchNode& patch, float a, float b) {
    return patch.corner[0] * (1 - a - b) + patch.corner[1] * a + patch.corner[2] * b;
}

bool looks_towards(const PatchNode& a, const PatchNode& b) {
    const Vec3 between = b.center - a.center;
    const float d2 = length_squared(between), reach = a.radius + b.radius;
    if (a.cone < 1e-3f) return dot(a.normal, between) + b.reach(a.normal) + a.height > coplanar * reach;
    if (d2 <= sqr(reach)) return true;
    const float d = std::sqrt(d2);
    const float angle = std::acos(clamp(dot(a.normal, between) / d, -1, 1));
    return angle - a.cone - std::asin(reach / d) < 0.5f * pi;
}

}  // namespace

float point_to_triangle(Vec3 x, Vec3 n, const Vec3 (&corner)[3]) {
    std::array<Vec3, 4> seen;
    size_t count = 0;
    for (int k = 0; k < 3; ++k) {
        const Vec3 a = corner[k] - x, b = corner[(k + 1) % 3] - x;
        const float above_a = dot(a, n), above_b = dot(b, n);
        if (above_a > 0) seen[count++] = a;
        if ((above_a > 0) != (above_b > 0)) seen[count++] = a + (b - a) * (above_a / (above_a - above_b));
    }
    float sum = 0;
    for (size_t i = 0; i < count; ++i) {
        const Vec3 a = seen[i], b = seen[i + 1 == count ? 0 : i + 1], across = cross(a, b);
        const float l = length(across);
        if (l > 0) sum += std::atan2(l, dot(a, b)) * dot(n, across) / l;
    }
    return std::min(1.0f, std::fabs(sum) * (0.5f * inv_pi));
}

float point_to_patch(Vec3 x, Vec3 n, const PatchNode& patch) {
    const Vec3 to = patch.center - x;
    const float away = -dot(patch.normal, to);
    if (!(away > 0)) return 0;
    const float d2 = length_squared(to);
    if (sqr(patch.radius) > sqr(point_like) * d2) return point_to_triangle(x, n, patch.corner);
    return std::max(0.0f, dot(n, to)) * away * patch.area * inv_pi / sqr(d2);
}

float patch_exchange(const PatchNode& a, const PatchNode& b, float near) {
    const bool to_b = a.area <= b.area;
    const PatchNode &small = to_b ? a : b, &large = to_b ? b : a;
    const auto points = quadrature(near);
    float sum = 0;
    for (const Barycentric& p : points) sum += point_to_patch(point_of(small, p.a, p.b), small.normal, large);
    return small.area * sum / static_cast<float>(points.size());
}

float PointPair::kernel() const {
    const Vec3 to = y - x;
    const float d2 = length_squared(to), cos_x = dot(normal_x, to), cos_y = -dot(normal_y, to);
    return cos_x > 0 && cos_y > 0 ? cos_x * cos_y * inv_pi / sqr(d2) : 0;
}

float PointPair::smooth_kernel() const {
    return on_x->area <= on_y->area ? point_to_patch(x, normal_x, *on_y) / on_y->area
                                    : point_to_patch(y, normal_y, *on_x) / on_x->area;
}

ExposedParts::ExposedParts(const PatchTree& tree, std::span<const PatchSurface> surfaces)
    : tree_(tree), surfaces_(surfaces), parts_(tree.nodes().size()) {
    for (auto i = static_cast<uint32_t>(parts_.size()); i-- > 0;) {
        const PatchNode& n = tree[i];
        if (!n.is_leaf()) {
            parts_[i] = {n.child, parts_[n.child].area + parts_[n.child + 1].area};
        } else {
            const float share = surfaces.empty() ? 1 : surfaces[i].unknown() ? 0 : surfaces[i].exposed;
            parts_[i] = {no_node, n.area * share};
        }
    }
}

PointPair ExposedParts::sample_pair(uint32_t a, uint32_t b, uint32_t seed, uint32_t index, uint32_t count) const {
    struct Point {
        Vec3 position;
        const PatchNode* on;
    };
    // The descent chooses each half with a probability equal to its share; the rest of `u` is again uniform and chooses
    // a point of a list.
    const auto point_on = [this](uint32_t node, float u, Vec2 at) {
        while (parts_[node].child != no_node) {
            const uint32_t child = parts_[node].child;
            const float first = parts_[child].area / (parts_[child].area + parts_[child + 1].area);
            const bool second = u >= first;
            u = clamp(second ? (u - first) / (1 - first) : u / first, 0, 0x1.fffffep-1f);
            node = child + second;
        }
        const Vec2 anywhere = square_to_triangle(at);
        const Vec2 exposed = surfaces_.empty() ? anywhere : surfaces_[node].exposed_point(anywhere, u);
        return Point{tree_[node].point(exposed), &tree_[node]};
    };
    Sampler sampler(seed, hash(a, b, count), index);
    const Vec2 u = sampler.next_2d(), v = sampler.next_2d(), parts = sampler.next_2d();
    const Point p = point_on(a, parts.x, u), q = point_on(b, parts.y, v);
    return {p.position, p.on->normal, q.position, q.on->normal, p.on, q.on};
}

bool may_see(const PatchNode& a, const PatchNode& b) { return looks_towards(a, b) && looks_towards(b, a); }

}  // namespace eclat
