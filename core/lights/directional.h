// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Light from infinity: parallel (a delta), or from a small disc such as the sun's.

#pragma once

#include "base/error.h"
#include "base/frame.h"
#include "lights/emission_discs.h"
#include "sampling/warp.h"

namespace eclat {

class DirectionalLight {
  public:
    /// `direction` is where the light travels to; `irradiance` of a surface that faces it, W m^-2; `angular_radius` in
    /// degrees, 0 ≤ angular_radius < 90.
    DirectionalLight(Vec3 direction, Color irradiance, float angular_radius)
        : frame_(Frame::around(-normalize(direction))), irradiance_(irradiance) {
        require(is_finite(frame_.n), "directional light: expected a direction of positive, finite length");
        require(0 <= angular_radius && angular_radius < 90,
                "directional light: angular radius must be in [0, 90) degrees, got " + std::to_string(angular_radius));
        if (angular_radius == 0) return;
        const double angle = angular_radius * (M_PI / 180), sine = std::sin(angle / 2);
        drop_ = static_cast<float>(2 * sine * sine);
        // ∫ cos θ dω over the cap is π sin².
        radiance_ = irradiance * static_cast<float>(1 / (M_PI * std::sin(angle) * std::sin(angle)));
    }

    bool is_delta() const { return drop_ == 0; }
    Color irradiance() const { return irradiance_; }
    /// Radiance of the disc.
    Color radiance() const { return radiance_; }

    /// Returns whether the disc covers `w`. This is computed from the chord, because a cosine in float would move the
    /// sun's edge by half a percent.
    bool covers(Vec3 w) const { return length_squared(w - frame_.n) <= 2 * drop_; }
    float pdf_solid_angle() const { return uniform_cone_pdf_solid_angle(drop_); }

    LightSample sample(Vec2 u) const {
        if (is_delta()) return {frame_.n, infinity, irradiance_, 1, true};
        return {frame_.to_world(square_to_uniform_cone(u, drop_)), infinity, radiance_, pdf_solid_angle(), false};
    }

    PhotonSample emit(const EmissionDiscs& discs, Vec2 u_position, Vec2 u_direction) const {
        return discs.emit(sample(u_direction), u_position);
    }

    /// Returns the flux through a disc perpendicular to the light.
    Color power(float area) const {
        const Color through = is_delta() ? irradiance_ : radiance_ * (1 / pdf_solid_angle());
        return through * area;
    }

  private:
    Frame frame_;  // z points towards the light
    Color irradiance_, radiance_;
    float drop_ = 0;  // 1 − cos of the angular radius
};

}  // namespace eclat
