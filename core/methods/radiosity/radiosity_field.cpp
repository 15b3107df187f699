// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/radiosity/radiosity_field.h"

#include <array>

#include "base/parallel.h"
#include "methods/radiosity/patch_surfaces.h"

namespace eclat {

namespace {

constexpr size_t neighbors = 14;  // tuned: fewer show the patches, more blur shadows
constexpr float farthest = 6;     // largest distance of a neighbour, in radii of the patch

std::vector<PatchName> names_of(std::span<const SolvedPatch> patches) {
    std::vector<PatchName> names;
    names.reserve(patches.size());
    for (const SolvedPatch& p : patches) names.push_back(p.name);
    return names;
}

}  // namespace

RadiosityField::RadiosityField(const Geometry& geometry, std::span<const SolvedPatch> patches, int threads)
    : geometry_(geometry),
      tree_(geometry, names_of(patches)),
      light_(tree_.nodes().size()),
      unknown_(tree_.nodes().size(), 0) {
    std::vector<Vec3> centers;
    std::vector<uint32_t> nodes;
    for (const SolvedPatch& p : patches) {
        const uint32_t node = tree_.find(p.name);
        light_[node] = {p.direct, p.total};
        unknown_[node] = p.unknown;
        if (p.unknown) continue;
        centers.push_back(tree_[node].center);
        nodes.push_back(node);
    }
    centers_ = KdTree(centers, threads);
    node_of_.reserve(nodes.size());
    for (const uint32_t i : centers_.order()) node_of_.push_back(nodes[i]);
    find_beside(threads);
}

void RadiosityField::find_beside(int threads) {
    beside_.assign(tree_.nodes().size(), 0);
    std::vector<Vec3> centers;
    std::vector<uint32_t> nodes;
    for (const uint32_t i : tree_.leaves()) {
        if (!unknown_[i]) continue;
        centers.push_back(tree_[i].center);
        nodes.push_back(i);
    }
    if (nodes.empty()) return;
    const KdTree unknown(centers, threads);
    constexpr size_t block = 256;
    parallel_blocks(tree_.leaves().size(), block, threads, [&](size_t begin, size_t end) {
        std::vector<Neighbor> found;
        for (size_t l = begin; l < end; ++l) {
            const PatchNode& patch = tree_[tree_.leaves()[l]];
            const Disc disc{patch.center, patch.normal, farthest * patch.radius};
            unknown.nearest(disc, 1, found,
                            [&](uint32_t i) { return disc.same_side(tree_[nodes[unknown.order()[i]]].normal); });
            beside_[tree_.leaves()[l]] = !found.empty();
        }
    });
}

uint32_t RadiosityField::find(const SurfacePoint& point) const {
    if (point.triangle == no_triangle) return no_node;
    const bool back = dot(geometry_.geometric_normal(point.triangle), point.normal_towards_shading()) < 0;
    const Hit hit = hit_on_triangle(geometry_, point.triangle, point.position);
    return tree_.find(point.triangle, back, hit.u, hit.v);
}

std::optional<RadiosityField::OnPatch> RadiosityField::on_patch(const SurfacePoint& point) const {
    const uint32_t node = find(point);
    if (node == no_node || unknown_[node]) return std::nullopt;
    return OnPatch{light_[node].scaled(point.even_share()), tree_[node].radius};
}

std::optional<RadiosityField::Light> RadiosityField::smooth(const SurfacePoint& point) const {
    const uint32_t node = find(point);
    if (node == no_node) return std::nullopt;
    thread_local std::vector<Neighbor> found;
    const Disc disc{point.position, point.normal_towards_shading(), farthest * tree_[node].radius};
    const float radius = centers_.nearest(disc, neighbors, found, [&](uint32_t i) {
        const PatchNode& patch = tree_[node_of_[i]];
        return disc.same_sheet(patch.center, patch.normal);
    });
    if (beside_[node]) drop_hidden(point, disc, found);
    const Light light = found.empty() ? light_[node] : fit(disc, found, radius);
    return light.scaled(point.even_share());
}

void RadiosityField::drop_hidden(const SurfacePoint& point, const Disc& disc, std::vector<Neighbor>& found) const {
    constexpr float low_ray = 0.02f;  // the same as in patch_surfaces.cpp
    std::vector<Ray> rays;
    for (const Neighbor& n : found) {
        const PatchNode& patch = tree_[node_of_[n.index]];
        const float above = std::max(low_ray * patch.radius, point.offset);
        const Vec3 from = point.position + disc.normal * above, to = patch.center + patch.normal * above - from;
        const float distance = length(to);
        rays.push_back({from, 0, distance > 0 ? to / distance : disc.normal, distance});
    }
    std::vector<uint8_t> hidden(rays.size());
    geometry_.rays().occluded(rays, hidden);
    size_t kept = 0;
    for (size_t i = 0; i < found.size(); ++i)
        if (!hidden[i]) found[kept++] = found[i];
    found.resize(kept);
}

RadiosityField::Light RadiosityField::fit(const Disc& disc, std::span<const Neighbor> found, float radius) const {
    const Frame frame = Frame::around(disc.normal);
    // Sums of w, w x, w y, w x², w x y, w y² in units of the radius; double, since the determinant cancels.
    std::array<double, 6> m{};
    struct Weighed {
        double weight, x, y;
        const Light* light;
    };
    std::array<Weighed, neighbors> points;
    size_t count = 0;
    for (const Neighbor& n : found) {
        const PatchNode& patch = tree_[node_of_[n.index]];
        const Vec3 d = (patch.center - disc.position) / radius;
        const double w = sqr(std::max(0.0f, 1 - n.distance2 / sqr(radius))) * patch.area, x = dot(d, frame.u),
                     y = dot(d, frame.v);
        points[count++] = {w, x, y, &light_[node_of_[n.index]]};
        const std::array<double, 6> products{1, x, y, x * x, x * y, y * y};
        for (size_t k = 0; k < 6; ++k) m[k] += w * products[k];
    }
    if (!(m[0] > 0)) return *points[0].light;
    // The value of the plane at the point is a weighted sum of the values; the weights are the first row of the inverse
    // of the normal equations.
    const double c0 = m[3] * m[5] - m[4] * m[4], c1 = m[2] * m[4] - m[1] * m[5], c2 = m[1] * m[4] - m[2] * m[3];
    const double determinant = m[0] * c0 + m[1] * c1 + m[2] * c2;
    const bool plane = determinant > 1e-3 * m[0] * m[0] * m[0] * 0.01;
    Light out, low{Color(infinity), Color(infinity)}, high{Color(-infinity), Color(-infinity)};
    for (size_t i = 0; i < count; ++i) {
        const auto& [w, x, y, light] = points[i];
        const auto share = static_cast<float>(plane ? w * (c0 + c1 * x + c2 * y) / determinant : w / m[0]);
        out.direct += light->direct * share;
        out.total += light->total * share;
        low = {min(low.direct, light->direct), min(low.total, light->total)};
        high = {max(high.direct, light->direct), max(high.total, light->total)};
    }
    // The result is clamped to the range of the values, because a plane overshoots beside the edge of a shadow.
    return {max(low.direct, min(high.direct, out.direct)), max(low.total, min(high.total, out.total))};
}

}  // namespace eclat
