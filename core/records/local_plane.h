// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A plane is fitted by weighted least squares to noisy values at places around a point, and read at the point. A weighted mean
// would give the value at the mean of the places, which lies to one side of the point at the border of a face and where the
// places are denser on one side. The value of the plane is a weighted sum, too, whose weights the places determine:
//   Σ w_i (1 − s · (x_i − x̄)) v_i / Σ w_i ,  s = C⁻¹ x̄ .
// For values of equal noise, its variance is 1 + x̄ · C⁻¹ x̄ times that of the mean if all
// weights are equal, and a little more if they fall outwards.
//
// Symbol   name here       meaning                                                    unit
//   x_i    x, y            way from the point to a place, in the tangent plane        m
//   w_i    weight          weight of a place                                          1
//   x̄, C   mean, xx …      weighted mean and covariance of the ways                   m, m²
//   s      slope           how fast the weights fall along the mean way               m⁻¹
//   n      –               effective number of places, (Σ w_i)² / Σ w_i²              1
//
// References   [Fan92] the fit, whose error does not depend on how the places lie, at a border neither
// Held to      tests/core/records/test_local_plane.cpp

#pragma once

#include <cmath>

#include "base/frame.h"

namespace eclat {

/// Weights with which values at places around a point give the value of their plane at the point.
class LocalPlane {
  public:
    /// `tangents` spans the plane in which the places lie by its u and v.
    explicit LocalPlane(const Frame& tangents) : u_(tangents.u), v_(tangents.v) {}

    /// Counts a place at `way` from the point. All must have been added before `share` is called.
    void add(Vec3 way, float weight) {
        const double x = dot(way, u_), y = dot(way, v_), w = weight;
        weights_ += w;
        squares_ += w * w;
        x_ += w * x;
        y_ += w * y;
        xx_ += w * x * x;
        xy_ += w * x * y;
        yy_ += w * y * y;
    }

    /// Ends the additions.
    void fit() {
        if (!(weights_ > 0)) return;
        x_ /= weights_;
        y_ /= weights_;
        const double xx = xx_ / weights_ - x_ * x_, xy = xy_ / weights_ - x_ * y_, yy = yy_ / weights_ - y_ * y_;
        // Places that all but coincide tell nothing of a slope; what is left of their variance is rounding.
        if (!(xx + yy > 1e-6 * (x_ * x_ + y_ * y_))) return;
        // The mean variance of n ways is known to its share 1 / n. Adding this keeps few places from giving a slope of noise, and
        // places in a line from giving one across it.
        const double unknown = 0.5 * (xx + yy) * squares_ / (weights_ * weights_);
        const double a = xx + unknown, b = yy + unknown, determinant = a * b - xy * xy;
        slope_x_ = (b * x_ - xy * y_) / determinant;
        slope_y_ = (a * y_ - xy * x_) / determinant;
        const double added = slope_x_ * x_ + slope_y_ * y_;
        if (added <= most_added) return;
        slope_x_ *= std::sqrt(most_added / added);
        slope_y_ *= std::sqrt(most_added / added);
    }

    /// Returns the share of the value at `way` in the sum. The shares of all places add up to 1; some may be negative.
    float share(Vec3 way, float weight) const {
        const double fall = slope_x_ * (dot(way, u_) - x_) + slope_y_ * (dot(way, v_) - y_);
        return static_cast<float>(weight / weights_ * (1 - fall));
    }

  private:
    /// Most that the fit adds to the variance of the mean, as a share of it. Where the places lie more to one side, the fit is drawn
    /// towards the mean: it would add 1.85 at the straight border of a face and 3.8 in a corner (weights (1 − e)² up to e = 1).
    static constexpr double most_added = 1;

    Vec3 u_, v_;
    // In double precision: the variance of places far from the point is a small difference of large numbers.
    double weights_ = 0, squares_ = 0, x_ = 0, y_ = 0, xx_ = 0, xy_ = 0, yy_ = 0, slope_x_ = 0, slope_y_ = 0;
};

}  // namespace eclat
