// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The interface for functions on the sphere and the hemisphere, represented by coefficients of real harmonics.
//
// "Order n" means n bands l = 0 … n − 1, hence n² coefficients; that of (l, m), −l ≤ m ≤ l, stands at l² + l + m.
// m > 0 goes with √2 cos mφ, m < 0 with √2 sin |m|φ. There is no Condon–Shortley phase: band 1 of the spherical
// harmonics is √(3/4π) (y, z, x).
// Everything here is double precision: coefficients are made once and stored as float by their users.
//
// References   [Gautron04] hemispherical harmonics, [IvanicRuedenberg96, IvanicRuedenberg98] rotation
// Held to      tests/core/harmonics/test_harmonics.cpp, tests/core/harmonics/test_rotation.cpp, tests/core/harmonics/test_projection.cpp,
//              tests/python/test_harmonics.py

#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "base/error.h"
#include "harmonics/hemispherical.h"
#include "harmonics/spherical.h"

namespace eclat {

enum class Basis : uint8_t {
    spherical,      ///< orthonormal on the sphere
    hemispherical,  ///< orthonormal on the hemisphere z ≥ 0, and 0 below
};

/// All harmonics of `order` in direction `w`: coefficient_count(order) numbers.
inline void evaluate_harmonics(Basis basis, int order, Direction w, double* out) {
    if (basis == Basis::spherical)
        spherical_harmonics(order, w, out);
    else
        hemispherical_harmonics(order, w, out);
}

inline void require_order(int order) {
    require(order >= 1 && order <= max_harmonic_order,
            "order must be in [1, " + std::to_string(max_harmonic_order) + "], got " + std::to_string(order));
}

/// Factors per band against ringing, 1 for l = 0 so that the mean stays.
enum class Window : uint8_t { hanning, lanczos };

inline double window_factor(Window window, int order, int l) {
    const double x = pi_double * l / order;
    if (window == Window::hanning) return 0.5 * (1 + std::cos(x));
    return l == 0 ? 1 : std::sin(x) / x;
}

/// Multiply each band of `coefficients` by its factor.
inline void apply_window(Window window, int order, std::span<double> coefficients) {
    for (int l = 0; l < order; ++l) {
        const double factor = window_factor(window, order, l);
        for (int m = -l; m <= l; ++m) coefficients[size_t(coefficient_index(l, m))] *= factor;
    }
}

}  // namespace eclat
