// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Conversion of functions to coefficients and back.
//
// Three representations of a function on the hemisphere:
//   hemispherical   inner products with H_l^m, which are its best approximation as well
//   spherical       inner products with Y_l^m over the hemisphere: those of the function continued by 0
//   least squares   the sum of Y_l^m that comes closest on the hemisphere, whatever it does below; HemisphereFit makes
//                   it from the second
// For two functions f and g of which one is given by inner products b (second) and the other by a fit c (third),
// ∫ f g = Σ b c up to what the fit leaves.

#pragma once

#include <span>
#include <vector>

#include "harmonics/harmonics.h"

namespace eclat {

/// Σ_i weight_i value_i B(direction_i) for each of `channels` interleaved values a direction: (order², channels).
/// Without weights, they are 1.
std::vector<double> project(Basis basis, int order, std::span<const Direction> directions,
                            std::span<const double> values, std::span<const double> weights, int channels);

/// Σ c B(direction_i): (directions, channels) from (order², channels).
std::vector<double> reconstruct(Basis basis, int order, std::span<const double> coefficients,
                                std::span<const Direction> directions, int channels);

/// Least squares on the hemisphere: c minimises ∫ (f − Σ c Y)² + λ Σ c², λ the Tikhonov factor [TikhonovArsenin77].
/// Without it, orders above 8 would answer rounding errors with huge coefficients below the horizon.
class HemisphereFit {
  public:
    static constexpr double default_tikhonov = 1e-6;

    explicit HemisphereFit(int order, double tikhonov = default_tikhonov);

    /// ∫ Y_l^m Y_k^m over the hemisphere.
    double gram(int l, int k, int m) const;

    /// From inner products over the hemisphere, up to any order that is not above the constructor's, in place.
    void fit(int order, std::span<double> coefficients) const;

    /// From inner products over the hemisphere to coefficients of an orthonormal basis there, in place: c ↦ L⁻¹ c with
    /// G + λ = L Lᵀ. Its first n² functions span the harmonics of order n, so that any order may be cut out, and the
    /// product integral of two functions is the dot product of theirs.
    void orthonormalize(int order, std::span<double> inner_products) const;
    /// Back: c ↦ L c.
    void to_inner_products(int order, std::span<double> orthonormal) const;
    /// Lower triangle of the Cholesky factor L for azimuthal number m ≥ 0.
    double factor(int l, int k, int m) const { return factors_[size_t((m * order_ + l) * order_ + k)]; }

    /// ‖fit of order n‖² for n = 1 … order on the hemisphere, from inner products; λ's part is below its bias.
    std::vector<double> energies(std::span<const double> inner_products) const;

  private:
    int order_;
    std::vector<double> gram_, factors_;
};

}  // namespace eclat
