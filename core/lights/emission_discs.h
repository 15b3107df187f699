// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Where photons from infinity start: on a disc across their direction that covers the whole scene, most densely before the
// places where surfaces exchange light. Before a place the density is even; beyond, it falls with the squared distance, so
// that each ring twice as wide gets as many photons as the one before. A room is thus lit alike beside a yard and on a plain:
// evenly over the whole disc, a millionth of the photons would meet a room on a ground of some kilometres.
//
// Symbol   name here   meaning                                                            unit
//   r      radius      of a place                                                         m
//   R      reach       of the disc around it, which covers the whole scene               m
//   m      even        share of the photons within r: 1 / (1 + 2 ln(R / r))               1
//   d      distance    from the middle of the place, across the photon's direction        m
//   p      density     mean over the places of m / (π r²) · min(1, r² / d²)               m⁻²
//
// Held to      tests/core/lights/test_emission_discs.cpp

#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "lights/light_sample.h"

namespace eclat {

struct Ball {
    Vec3 center;
    float radius = 0;
};

class EmissionDiscs {
  public:
    EmissionDiscs() : EmissionDiscs({{}, 1}, {}) {}
    /// `whole` contains the scene. If there are no places, the whole scene is one.
    EmissionDiscs(Ball whole, const std::vector<Ball>& places) : whole_(whole) {
        for (const Ball& ball : places) add(ball, length(ball.center - whole.center) + whole.radius);
        if (places.empty()) add(whole, whole.radius);
    }

    /// Returns the area of the discs before the places, m², by which the power of infinite lights is compared with others'.
    float area() const { return area_; }

    /// Returns the photon that arrives along `s`; there is none where its disc reaches beyond the scene.
    PhotonSample emit(const LightSample& s, Vec2 u) const {
        if (s.pdf_solid_angle == 0) return {};
        const auto count = static_cast<float>(places_.size());
        const auto chosen = std::min(static_cast<size_t>(u.x * count), places_.size() - 1);
        const Place& place = places_[chosen];
        const Vec2 d = square_to_concentric_disk({u.x * count - static_cast<float>(chosen), u.y});
        const float stretch = place.stretch(d.x * d.x + d.y * d.y);
        const Frame frame = Frame::around(s.wi);
        const Vec3 across = frame.to_world({d.x * stretch, d.y * stretch, 0});
        const Vec3 position = place.ball.center + across;
        const Vec3 from_middle = position - whole_.center;
        const float depth = dot(from_middle, s.wi);
        if (!(length_squared(from_middle - s.wi * depth) <= sqr(whole_.radius * (1 + 1e-5f)))) return {};
        float density = 0, importance = 0;
        for (const Place& other : places_) {
            const Vec3 away = position - other.ball.center;
            const float here = other.falloff(length_squared(away - s.wi * dot(away, s.wi)));
            density += other.even / (pi * sqr(other.ball.radius)) * here;
            importance = std::max(importance, here);
        }
        PhotonSample photon;
        // One radius before the middle is outside; another keeps the start clear of whatever touches the sphere.
        photon.origin = position + s.wi * (2 * whole_.radius - depth);
        photon.direction = -s.wi;
        photon.power = s.radiance * (count / (density * s.pdf_solid_angle));
        photon.importance = importance;
        return photon;
    }

  private:
    struct Place {
        Ball ball;
        float reach, even;

        /// Returns the distance over the root of `part`, the uniform share of the photons that start nearer.
        float stretch(float part) const {
            if (part <= even) return ball.radius / std::sqrt(even);
            const float further = (part - even) / (1 - even);
            return ball.radius * std::pow(reach / ball.radius, further) / std::sqrt(part);
        }
        /// Returns the density over that before the place.
        float falloff(float distance2) const { return std::min(1.0f, sqr(ball.radius) / std::max(distance2, 1e-30f)); }
    };

    void add(Ball ball, float reach) {
        places_.push_back({ball, reach, 1 / (1 + 2 * std::log(reach / ball.radius))});
        area_ += pi * sqr(ball.radius);
    }

    Ball whole_;
    std::vector<Place> places_;
    float area_ = 0;
};

}  // namespace eclat
