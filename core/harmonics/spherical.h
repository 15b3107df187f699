// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Real spherical harmonics, conventions in harmonics.h.
//
// Symbol       name here    meaning
//   P_l^m      legendre     associated Legendre function with the normalisation of Y_l^m folded in, so that no number
//                           grows with the order
//   t, s       –            cosθ and what stands for sinθ

#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace eclat {

constexpr double pi_double = 3.14159265358979323846;

/// Enough for rotating hemispherical harmonics of order 12 through spherical ones of several times that order.
constexpr int max_harmonic_order = 48;

constexpr int coefficient_count(int order) { return order * order; }
constexpr int coefficient_index(int l, int m) { return l * l + l + m; }

/// Pairs (l, m) with 0 ≤ m ≤ l < order: what a function symmetric in φ needs.
constexpr int polar_count(int order) { return order * (order + 1) / 2; }
constexpr int polar_index(int l, int m) { return l * (l + 1) / 2 + m; }

/// A unit vector in double precision.
struct Direction {
    double x = 0, y = 0, z = 1;
};

namespace detail {

/// Factors of the recurrences, which depend on l and m only.
struct LegendreFactors {
    std::array<double, size_t(polar_count(max_harmonic_order))> a{}, b{};
    std::array<double, size_t(max_harmonic_order)> diagonal{};

    LegendreFactors() {
        for (int m = 0; m < max_harmonic_order; ++m) {
            diagonal[size_t(m)] = std::sqrt((2.0 * m + 3) / (2.0 * m + 2));
            for (int l = m + 1; l < max_harmonic_order; ++l) {
                const double l2 = double(l) * l, m2 = double(m) * m, k2 = (l - 1.0) * (l - 1.0);
                a[size_t(polar_index(l, m))] = std::sqrt((4 * l2 - 1) / (l2 - m2));
                b[size_t(polar_index(l, m))] = std::sqrt((k2 - m2) / (4 * k2 - 1));
            }
        }
    }
};

inline const LegendreFactors& legendre_factors() {
    static const LegendreFactors factors;
    return factors;
}

}  // namespace detail

/// Y_l^m = P[polar_index(l, m)] cos mφ and Y_l^−m = P[…] sin mφ where s = sinθ; with s = 1, what is left when sinᵐθ is
/// taken out. The √2 of m ≠ 0 is inside.
inline void legendre(int order, double t, double s, double* P) {
    const auto& factors = detail::legendre_factors();
    constexpr double mean = 0.28209479177387814347;  // √(1 / 4π)
    double diagonal = mean;
    for (int m = 0; m < order; ++m) {
        P[polar_index(m, m)] = m == 0 ? mean : diagonal * std::sqrt(2.0);
        double before = 0, last = P[polar_index(m, m)];
        // P_l = a_l (t P_{l−1} − b_l P_{l−2}), the three-term recurrence of orthonormal polynomials.
        for (int l = m + 1; l < order; ++l) {
            const size_t i = size_t(polar_index(l, m));
            const double next = factors.a[i] * (t * last - factors.b[i] * before);
            P[i] = next;
            before = last;
            last = next;
        }
        diagonal *= s * factors.diagonal[size_t(m)];
    }
}

/// All Y_l^m of `order` in direction `w`. No angle is formed, so the pole is a direction like any other.
inline void spherical_harmonics(int order, Direction w, double* out) {
    std::array<double, size_t(polar_count(max_harmonic_order))> P;
    legendre(order, w.z, 1, P.data());
    double re = 1, im = 0;  // (x + i·y)ᵐ = sinᵐθ (cos mφ + i·sin mφ)
    for (int m = 0; m < order; ++m) {
        for (int l = m; l < order; ++l) {
            const double p = P[size_t(polar_index(l, m))];
            out[coefficient_index(l, m)] = p * re;
            if (m > 0) out[coefficient_index(l, -m)] = p * im;
        }
        const double next = re * w.x - im * w.y;
        im = re * w.y + im * w.x;
        re = next;
    }
}

}  // namespace eclat
