// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// An emissive triangle, which is sampled uniformly in area from far points and uniformly in solid angle from near points.
//
// Sampling and density decide between the two by the same function of the same numbers, so they always agree.

#pragma once

#include <span>

#include "base/frame.h"
#include "lights/light_sample.h"
#include "sampling/spherical_triangle.h"
#include "sampling/warp.h"
#include "scene/texture.h"

namespace eclat {

struct EmitterTriangle {
    Vec3 p0, p1, p2;
    Vec2 uv0{}, uv1{}, uv2{};  // of the set that `emission.uv_set` names
    Value emission;            // radiance on the side of the counter-clockwise normal
    bool two_sided = false;
    uint32_t triangle_id = no_triangle;  // in the scene
};

class AreaLight {
  public:
    /// `emission_index` is the index of a textured emission in the list that the other functions take.
    AreaLight(const EmitterTriangle& triangle, uint32_t emission_index);

    /// Radiance towards `wo` (away from the surface); `bary` are the weights of the second and third vertex.
    Color emitted(std::span<const Value> emissions, Vec2 bary, Vec3 wo) const {
        return shines_towards(wo) ? radiance(emissions, bary) : Color();
    }

    /// Samples a point of the triangle as seen from `from`; the density is 0 if only a dark back is visible.
    LightSample sample(std::span<const Value> emissions, Vec3 from, Vec2 u) const;

    /// Returns the density of `sample` for the point `on` of the triangle.
    float pdf_solid_angle(Vec3 from, Vec3 on) const {
        if (is_near(from)) {
            const SphericalTriangle seen = seen_from(from);
            if (seen.solid_angle > least_solid_angle) return static_cast<float>(1 / seen.solid_angle);
        }
        return pdf_of_area(on - from);
    }

    PhotonSample emit(std::span<const Value> emissions, Vec2 u_position, Vec2 u_direction) const;

    float area() const { return area_; }
    bool two_sided() const { return two_sided_; }
    uint32_t triangle_id() const { return triangle_id_; }

  private:
    /// Beyond the distance from which a triangle fills at most this many steradians, cosine and distance hardly vary
    /// over it: sampling its area is as good and twice as fast. Nearer, they vary even where the solid angle is small,
    /// because the point lies near the triangle's plane or the triangle is a sliver.
    static constexpr float far_solid_angle = 0.05f;
    /// What fills fewer steradians is less than the rounding errors of doubles near the horizon.
    static constexpr double least_solid_angle = 1e-12;

    /// The radiance of the side that shines.
    Color radiance(std::span<const Value> emissions, Vec2 bary) const {
        return textured_ ? max(emissions[emission_].color(uv_at(bary)), Color(0.0f)) : radiance_;
    }
    /// Rays to the triangle end this far from it on the side of an observer at `height` over it, and not behind that.
    Vec3 clearance(float height) const { return normal_ * clamp(0.5f * height, -clearance_, clearance_); }
    bool shines_towards(Vec3 w) const { return two_sided_ ? area_ > 0 : dot(w, normal_) > 0; }
    bool is_near(Vec3 from) const { return length_squared(center_ - from) < near_squared_; }
    SphericalTriangle seen_from(Vec3 from) const {
        return SphericalTriangle::seen(Vec3d(p0_) - Vec3d(from), Vec3d(e1_), Vec3d(e2_));
    }
    /// 1 / area in solid angle, for the vector from the observer to the point.
    float pdf_of_area(Vec3 to) const {
        const float d2 = length_squared(to), cosine = std::abs(dot(to, normal_)) / std::sqrt(d2);
        return cosine > 0 ? d2 / (cosine * area_) : 0;
    }
    Vec2 uv_at(Vec2 bary) const { return uv0_ + bary.x * uv1_ + bary.y * uv2_; }
    Vec2 barycentric(Vec3 on) const;

    Vec3 p0_, e1_, e2_, normal_, center_;
    float area_, near_squared_, clearance_;
    float rounding_;        // bound of the height of points that were computed to lie in the plane
    Vec2 uv0_, uv1_, uv2_;  // at the first vertex, and the edges'
    Color radiance_;        // radiance of an untextured triangle
    uint32_t emission_, triangle_id_;
    bool two_sided_, textured_;
};

}  // namespace eclat
