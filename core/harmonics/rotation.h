// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Rotation of coefficients: those of w ↦ f(Rᵀ w) from those of f.
//
// References   [IvanicRuedenberg96, IvanicRuedenberg98] recurrence of rotation matrices, [Gautron04] hemispherical ones
//
// Four ways, for four uses:
//   rotate_about_z         any angle about the normal: two multiplications a number, exact in both bases
//   SphericalRotation      any rotation, as a matrix a band: O(n³) to make, O(n³) to apply; many vectors of coefficients
//   rotate_by_series       one vector, small tilt of the axis and any turn about it: a series, O(n²) a term
//   HemisphericalRotation  through spherical harmonics, with losses: docs/algorithms/radiance_cache.md

#pragma once

#include <array>
#include <span>
#include <vector>

#include "harmonics/harmonics.h"

namespace eclat {

/// The matrix, row by row.
using Matrix3 = std::array<double, 9>;

/// Throws std::invalid_argument unless `R` is a rotation to within 1e-6.
void require_rotation(const Matrix3& R);

/// In place; either basis.
void rotate_about_z(int order, double angle, std::span<double> coefficients);

class SphericalRotation {
  public:
    SphericalRotation(int order, const Matrix3& R);

    int order() const { return order_; }
    /// The number that takes coefficient (l, column) to (l, row).
    double entry(int l, int row, int column) const { return entries_[index(l, row, column)]; }
    /// `in` and `out` must not overlap.
    void apply(std::span<const double> in, std::span<double> out) const;

  private:
    static size_t index(int l, int row, int column) {
        // Bands below l fill Σ (2k + 1)² = l (4l² − 1) / 3 places.
        return size_t(l * (4 * l * l - 1) / 3 + (row + l) * (2 * l + 1) + column + l);
    }
    double product(int i, int l, int m, int column) const;
    double recurrence(int l, int m, int column) const;

    int order_;
    std::vector<double> entries_;
};

/// R = R_z(alpha) R_y(beta) R_z(gamma), 0 ≤ beta ≤ π.
struct TurnTiltTurn {
    double alpha = 0, beta = 0, gamma = 0;
};
TurnTiltTurn turn_tilt_turn(const Matrix3& R);

/// Rotate spherical coefficients in place, by a series in the tilt that stops where the rest is below `tolerance` times
/// their norm. Meant for tilts with beta (order − 1) below 8, beyond which digits cancel.
void rotate_by_series(int order, const TurnTiltTurn& rotation, double tolerance, std::span<double> coefficients);

/// The values of the function below the horizon, parts of which rotate above it when the hemisphere tilts.
enum class Horizon : uint8_t {
    continued,  ///< the smooth continuation of the function by least squares on the hemisphere
    dark,  ///< nothing, as [Gautron04] has it: exact for a function that is 0 below, but its step costs more than it
           ///< saves, see docs/algorithms/radiance_cache.md
};

class HemisphericalRotation {
  public:
    /// Many functions on the sphere agree on the hemisphere up to the Tikhonov factor; `continued` takes the least of them:
    /// tuned to errors and to noise, which a smaller factor lets grow below the horizon (measured on the page).
    static constexpr double continuation_tikhonov = 1e-3;
    /// Returns the best spherical order for a horizon.
    static int spherical_order_for(Horizon horizon, int order) {
        return horizon == Horizon::continued ? order + 2 : 2 * order;
    }

    HemisphericalRotation(int order, Horizon horizon, int spherical_order);
    HemisphericalRotation(int order, Horizon horizon)
        : HemisphericalRotation(order, horizon, spherical_order_for(horizon, order)) {}

    /// In place.
    void apply(const Matrix3& R, std::span<double> coefficients) const;

    /// Spherical coefficients of the function continued below the horizon.
    std::vector<double> to_spherical(std::span<const double> hemispherical) const;
    /// Hemispherical coefficients of the upper half of a function on the sphere.
    void from_spherical(std::span<const double> spherical, std::span<double> hemispherical) const;

  private:
    size_t index(int l, int L, int m) const { return size_t((m * order_ + l) * spherical_order_ + L); }

    int order_, spherical_order_;
    std::vector<double> overlaps_;    // ∫ H_l^m Y_L^m over the hemisphere; different m do not meet
    std::vector<double> expansions_;  // H_l^m continued = Σ_L expansion Y_L^m
};

}  // namespace eclat
