// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "lights/area.h"

#include <algorithm>
#include <limits>

#include "base/precision.h"

namespace eclat {

AreaLight::AreaLight(const EmitterTriangle& triangle, uint32_t emission_index)
    : p0_(triangle.p0),
      e1_(triangle.p1 - triangle.p0),
      e2_(triangle.p2 - triangle.p0),
      uv0_(triangle.uv0),
      uv1_(triangle.uv1 - triangle.uv0),
      uv2_(triangle.uv2 - triangle.uv0),
      emission_(emission_index),
      triangle_id_(triangle.triangle_id),
      two_sided_(triangle.two_sided),
      textured_(!triangle.emission.is_constant()) {
    // In double: the squared area of a millimetre's thousandth leaves the range of float.
    const double x = double(e1_.y) * e2_.z - double(e1_.z) * e2_.y, y = double(e1_.z) * e2_.x - double(e1_.x) * e2_.z,
                 z = double(e1_.x) * e2_.y - double(e1_.y) * e2_.x;
    const double twice = std::sqrt(x * x + y * y + z * z);
    area_ = static_cast<float>(twice / 2);
    if (!(area_ > 0) || !std::isfinite(area_)) {
        area_ = 0;
    } else {
        normal_ = {static_cast<float>(x / twice), static_cast<float>(y / twice), static_cast<float>(z / twice)};
    }
    const auto largest = [](Vec3 p) { return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}); };
    const float extent = std::max({largest(triangle.p0), largest(triangle.p1), largest(triangle.p2)});
    clearance_ = coordinate_resolution * extent;
    rounding_ = 2 * std::numeric_limits<float>::epsilon() * extent;
    center_ = p0_ + (e1_ + e2_) * (1.0f / 3);
    // Ω ≤ area / (distance to the nearest point)²: beyond this distance from the centre it is too small. Over a sliver,
    // which is small in solid angle already at its ends, distances vary at least threefold nearer than twice its reach.
    const Vec3 c = center_ - p0_;
    const float reach = std::max(length(c), std::max(length(e1_ - c), length(e2_ - c)));
    near_squared_ = sqr(reach + std::max(reach, std::sqrt(area_ / far_solid_angle)));
    if (!textured_) radiance_ = max(triangle.emission.color(Vec2()), Color(0.0f));
}

Vec2 AreaLight::barycentric(Vec3 on) const {
    const Vec3 d = on - p0_;
    const float b1 = clamp(dot(cross(d, e2_), normal_) / (2 * area_), 0, 1);
    const float b2 = clamp(dot(cross(e1_, d), normal_) / (2 * area_), 0, 1 - b1);
    return {b1, b2};
}

LightSample AreaLight::sample(std::span<const Value> emissions, Vec3 from, Vec2 u) const {
    // Heights are in double, too: near the horizon they are small. The side must be that from which the solid angle is
    // seen, or a point of the lamp itself, which rounding puts behind it, would see the lamp above its own horizon.
    const Vec3d normal = cross(Vec3d(e1_), Vec3d(e2_));
    const double above = dot(normal, Vec3d(from) - Vec3d(p0_));  // times twice the area
    const auto height = static_cast<float>(above / length(normal));
    if (!(two_sided_ ? std::abs(height) > rounding_ : height > 0)) return {};
    if (is_near(from)) {
        const SphericalTriangle seen = seen_from(from);
        if (seen.solid_angle > least_solid_angle) {
            const Vec3d w = seen.sample(u);
            const auto distance = static_cast<float>(-above / dot(normal, w));
            if (!(distance > 0) || !std::isfinite(distance)) return {};  // rounding at the horizon
            const Vec3 wi(w);
            const Vec2 bary = textured_ ? barycentric(from + wi * distance) : Vec2();
            const auto pdf = static_cast<float>(1 / seen.solid_angle);
            return {wi, distance, radiance(emissions, bary), pdf, false, triangle_id_, clearance(height)};
        }
    }
    const Vec2 bary = square_to_triangle(u);
    const Vec3 to = (p0_ - from) + e1_ * bary.x + e2_ * bary.y;
    const float pdf = pdf_of_area(to);
    if (!(pdf > 0)) return {};
    const float distance = length(to);
    const Vec3 wi = to * (1 / distance);
    return {wi, distance, emitted(emissions, bary, -wi), pdf, false, triangle_id_, clearance(height)};
}

PhotonSample AreaLight::emit(std::span<const Value> emissions, Vec2 u_position, Vec2 u_direction) const {
    float side = 1;
    if (two_sided_) {
        side = u_direction.x < 0.5f ? 1 : -1;
        u_direction.x = u_direction.x < 0.5f ? 2 * u_direction.x : 2 * u_direction.x - 1;
    }
    const Vec2 bary = square_to_triangle(u_position);
    const Vec3 normal = normal_ * side;
    const Vec3 w = Frame::around(normal).to_world(square_to_cosine_hemisphere(u_direction));
    const float etendue = pi * area_ * (two_sided_ ? 2 : 1);
    return {p0_ + e1_ * bary.x + e2_ * bary.y, w, radiance(emissions, bary) * etendue, triangle_id_};
}

}  // namespace eclat
