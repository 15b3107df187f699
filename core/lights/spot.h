// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A point light that emits into a cone.

#pragma once

#include "base/error.h"
#include "base/frame.h"
#include "lights/light_sample.h"
#include "sampling/warp.h"

namespace eclat {

class SpotLight {
  public:
    /// linear: by angle, as in Mitsuba; smooth: the square of a ramp in cosine, as in glTF's KHR_lights_punctual.
    enum class Falloff { linear, smooth };

    /// `intensity` on the axis, W sr^-1; angles in degrees from the axis, 0 ≤ inner ≤ outer ≤ 180.
    SpotLight(Vec3 position, Vec3 direction, Color intensity, float inner_angle, float outer_angle, Falloff falloff)
        : position_(position),
          frame_(Frame::around(normalize(direction))),
          intensity_(intensity),
          inner_(ramp_end(inner_angle, falloff)),
          outer_(ramp_end(outer_angle, falloff)),
          outer_drop_(ramp_end(outer_angle, Falloff::smooth)),
          falloff_(falloff),
          power_(intensity * static_cast<float>(2 * M_PI * mean_ramp(inner_angle, outer_angle, falloff))) {
        require(is_finite(frame_.n) && is_finite(position), "spot light: expected a finite position and a direction");
        require(0 <= inner_angle && inner_angle <= outer_angle && outer_angle <= 180,
                "spot light: expected 0 <= inner angle <= outer angle <= 180 degrees, got " +
                    std::to_string(inner_angle) + " and " + std::to_string(outer_angle));
    }

    LightSample sample(Vec3 from) const {
        const Vec3 to = position_ - from;
        const float d2 = length_squared(to);
        if (!(d2 > 0)) return {};
        const float distance = std::sqrt(d2);
        const Vec3 wi = to * (1 / distance);
        const float f = ramp(-wi);
        if (f == 0) return {};
        return {wi, distance, intensity_ * (f / d2), 1, true};
    }

    PhotonSample emit(Vec2 u) const {
        if (!(outer_drop_ > 0)) return {};
        const Vec3 w = frame_.to_world(square_to_uniform_cone(u, outer_drop_));
        return {position_, w, intensity_ * (ramp(w) / uniform_cone_pdf_solid_angle(outer_drop_))};
    }

    Color power() const { return power_; }

  private:
    /// What the ramp is linear in: the angle, or 1 − cosine (as 2 sin², which does not cancel).
    static float ramp_end(float degrees, Falloff falloff) {
        const double angle = degrees * (M_PI / 180), sine = std::sin(angle / 2);
        return static_cast<float>(falloff == Falloff::linear ? angle : 2 * sine * sine);
    }

    /// Intensity towards `w` over that on the axis.
    float ramp(Vec3 w) const {
        // By the chord between w and the axis: acos is blind near 0.
        const float chord2 = length_squared(w - frame_.n);
        const float x =
            falloff_ == Falloff::smooth ? chord2 * 0.5f : 2 * std::asin(std::min(1.0f, std::sqrt(chord2) / 2));
        if (x >= outer_) return 0;
        if (x <= inner_) return 1;
        const float t = (outer_ - x) / (outer_ - inner_);
        return falloff_ == Falloff::smooth ? t * t : t;
    }

    /// ∫ ramp(θ) sin θ dθ: the whole inner cap, then the ramp by parts.
    static double mean_ramp(double inner_degrees, double outer_degrees, Falloff falloff) {
        const double a = inner_degrees * (M_PI / 180), b = outer_degrees * (M_PI / 180);
        if (a >= b) return 1 - std::cos(b);
        if (falloff == Falloff::smooth) return 1 - std::cos(a) + (std::cos(a) - std::cos(b)) / 3;
        return 1 - (std::sin(b) - std::sin(a)) / (b - a);
    }

    Vec3 position_;
    Frame frame_;
    Color intensity_;
    float inner_, outer_;
    float outer_drop_;  // 1 − cos of the outer angle
    Falloff falloff_;
    Color power_;
};

}  // namespace eclat
