// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The incident radiance of a gather as harmonic coefficients, with their derivatives along the tangent plane.
//
// References   [Krivanek05] radiance records, [WardHeckbert92] marginal areas of the gradient
//
// Symbol       name here    meaning
//   B_i        –            orthonormal on the hemisphere: HemisphereFit::orthonormalize of the spherical harmonics
//   λ_i        values       ∫ L B_i over the hemisphere                                   W m⁻²
//   ∂λ_i       gradients    its derivatives along the frame's u and v                     W m⁻³
//   M, N       rows, columns of the gather; L is taken for constant in a cell
//
// Departures   [Krivanek05] differentiates each sample by itself and misses what hides and appears. Here each wall between two
//              cells moves with the nearer of the two surfaces, as for irradiance in [WardHeckbert92], with B on the wall:
//              integrated along it between rows, and over the row between columns.
// Held to      tests/core/hemisphere/test_radiance_projection.cpp

#pragma once

#include <vector>

#include "hemisphere/hemisphere.h"
#include "harmonics/projection.h"

namespace eclat {

/// Orders of radiance records.
constexpr int max_radiance_order = 12;
/// The Tikhonov factor of the fit that makes the basis: small enough for irradiance to 10⁻⁴, large enough that what a tilt brings up from below
/// the horizon does not amplify noise.
constexpr double radiance_tikhonov = 1e-4;

/// Coefficients of one record, channel after channel, n² each.
struct RadianceCoefficients {
    std::vector<float> values;
    std::vector<float> gradients;  // along u, then along v, of Frame::around(normal)
};

/// For gathers of one shape: what depends on the grid only is made once.
class RadianceProjection {
  public:
    RadianceProjection(int order, Rows kind, int rows);

    int order() const { return order_; }
    int rows() const { return rows_; }
    Rows kind() const { return kind_; }
    const HemisphereFit& fit() const { return fit_; }

    RadianceCoefficients operator()(const HemisphereSamples& samples) const;

  private:
    /// Sums over the columns of a row times cos mφ and sin mφ, m = 0 … order: (2 order + 1) numbers, m < 0 the sines.
    using Series = std::vector<double>;

    void add_values(const HemisphereSamples& samples, int channel, std::vector<double>& b) const;
    void add_gradients(const HemisphereSamples& samples, int channel, std::vector<double>& along_x,
                       std::vector<double>& along_y) const;

    size_t harmonics() const { return size_t(2 * order_ + 1); }

    int order_, rows_, columns_;
    Rows kind_;
    HemisphereFit fit_;
    std::vector<double> over_height_;  // ∫ P dz of each row, polar_count each
    std::vector<double> over_angle_;   // ∫ P dθ of each row
    std::vector<double> on_wall_;      // sinθ cosθ P(θ) on the wall above each row
    std::vector<double> in_column_;    // ∫ of cos mφ, sin mφ over each column
    std::vector<double> at_column_;    // cos mφ, sin mφ on the lower wall of each column
};

}  // namespace eclat
