// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "bsdf/rgl.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace eclat {

namespace {

constexpr Slices only{{0}, {1}, 1};  // for tables that do not depend on the viewer

float place_of_theta(float theta) { return std::sqrt(theta * (2 / pi)); }
float place_of_phi(float phi) { return (phi + pi) / (2 * pi); }
float theta_of_place(float u) { return u * u * (pi / 2); }
float phi_of_place(float v) { return (2 * v - 1) * pi; }

float theta_of(Vec3 w) { return std::atan2(std::sqrt(w.x * w.x + w.y * w.y), w.z); }
float phi_of(Vec3 w) { return std::atan2(w.y, w.x); }

BilinearTable table(const RglTable& t, size_t slices) { return {t.width, t.height, slices, t.values}; }
BilinearWarp warp(const RglTable& t, size_t slices) { return {t.width, t.height, slices, t.values}; }

/// The area on the square of directions of light by that of half vectors: dω_i = 4 (ω_o · ω_m) dω_m, and
/// dω_m = sin θ dθ dφ = 2 π² u sin θ du dv.
float jacobian(float u, float theta, float cosine_of_view) {
    return std::max(2 * pi * pi * u * std::sin(theta), 1e-6f) * 4 * cosine_of_view;
}

}  // namespace

RglBrdf::RglBrdf(RglData data)
    : isotropic_(data.nodes[0].size() <= 2), jacobian_(data.jacobian), nodes_(std::move(data.nodes)) {
    for (const auto& nodes : nodes_)
        require(!nodes.empty() && std::adjacent_find(nodes.begin(), nodes.end(), std::greater_equal<>()) == nodes.end(),
                "measured BRDF: expected ascending angles of the viewer");
    if (!isotropic_) {
        symmetries_ = static_cast<int>(std::lround(2 * pi / (nodes_[0].back() - nodes_[0].front())));
        require(symmetries_ == 1 || symmetries_ == 2 || symmetries_ == 4,
                "measured BRDF: expected azimuths of a whole, half or quarter circle");
    }
    const size_t slices = nodes_[0].size() * nodes_[1].size();
    normals_ = table(data.normals, 1);
    projected_ = table(data.projected, 1);
    visible_ = warp(data.visible, slices);
    luminance_ = warp(data.luminance, slices);
    for (size_t i = 0; i < 3; ++i) channels_[i] = table(data.channels[i], slices);
    integrate();
}

RglBrdf::View RglBrdf::view_of(Vec3 wo) const {
    const float theta = theta_of(wo), phi = phi_of(wo);
    return {phi, {place_of_theta(theta), place_of_phi(phi)}, slices_among(nodes_, phi, theta)};
}

Vec2 RglBrdf::signs(Vec3 wo) const {
    if (symmetries_ == 1) return {1, 1};
    const float y = wo.y >= 0 ? -1.0f : 1.0f;
    return {symmetries_ == 2 ? y : wo.x >= 0 ? -1.0f : 1.0f, y};
}

EvalPdf RglBrdf::eval(Vec3 wo, Vec3 wi) const {
    if (!(wo.z > 0 && wi.z > 0)) return {};
    const Vec2 sign = signs(wo);
    wo.x *= sign.x, wo.y *= sign.y, wi.x *= sign.x, wi.y *= sign.y;
    const Vec3 half = normalize(wo + wi);
    const View view = view_of(wo);
    const float theta = theta_of(half);
    Vec2 place{place_of_theta(theta), place_of_phi(isotropic_ ? phi_of(half) - view.phi : phi_of(half))};
    place.y -= std::floor(place.y);
    const auto [u, visible] = visible_.invert(place, view.slices);
    float facets = 1 / wi.z;
    if (jacobian_) {
        const float area = 4 * projected_.eval(view.place, only);
        if (!(area > 0)) return {};
        facets *= normals_.eval(place, only) / area;
    }
    Color f;
    for (int i = 0; i < 3; ++i) f[i] = std::max(0.0f, channels_[size_t(i)].eval(u, view.slices) * facets);
    return {f, visible * luminance_.eval(u, view.slices) / jacobian(place.x, theta, dot(wo, half))};
}

Vec3 RglBrdf::direction(Vec3 wo, Vec2 u) const {
    const Vec2 sign = signs(wo);
    wo.x *= sign.x, wo.y *= sign.y;
    const View view = view_of(wo);
    const Vec2 place = visible_.sample(luminance_.sample(u, view.slices).at, view.slices).at;
    const float theta = theta_of_place(place.x), phi = phi_of_place(place.y) + (isotropic_ ? view.phi : 0);
    const Vec3 half{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
    const Vec3 wi = reflected(wo, half);
    return {sign.x * wi.x, sign.y * wi.y, wi.z};
}

}  // namespace eclat
