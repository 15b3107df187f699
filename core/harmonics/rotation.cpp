// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "harmonics/rotation.h"

#include <algorithm>

#include "harmonics/projection.h"
#include "harmonics/quadrature.h"

namespace eclat {

void require_rotation(const Matrix3& R) {
    double worst = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            double sum = i == j ? -1 : 0;
            for (int k = 0; k < 3; ++k) sum += R[size_t(3 * i + k)] * R[size_t(3 * j + k)];
            // Not fmax, which would pass over a NaN.
            worst = worst >= std::fabs(sum) ? worst : std::fabs(sum);
        }
    require(worst <= 1e-6, "a rotation must be orthogonal: R Rᵀ differs from the identity by " + std::to_string(worst));
    const double determinant =
        R[0] * (R[4] * R[8] - R[5] * R[7]) - R[1] * (R[3] * R[8] - R[5] * R[6]) + R[2] * (R[3] * R[7] - R[4] * R[6]);
    require(determinant > 0, "a rotation must have determinant 1, got a reflection");
}

void rotate_about_z(int order, double angle, std::span<double> coefficients) {
    for (int m = 1; m < order; ++m) {
        const double c = std::cos(m * angle), s = std::sin(m * angle);
        for (int l = m; l < order; ++l) {
            double& with_cos = coefficients[size_t(coefficient_index(l, m))];
            double& with_sin = coefficients[size_t(coefficient_index(l, -m))];
            const double turned = c * with_cos - s * with_sin;
            with_sin = s * with_cos + c * with_sin;
            with_cos = turned;
        }
    }
}

// --- matrices, band from band ---------------------------------------------------------------------------------------

SphericalRotation::SphericalRotation(int order, const Matrix3& R)
    : order_(order), entries_(size_t(order * (4 * order * order - 1) / 3)) {
    require_order(order);
    require_rotation(R);
    entries_[0] = 1;
    if (order == 1) return;
    // Band 1 is (y, z, x): the rotation itself in that order.
    constexpr std::array<size_t, 3> axis{1, 2, 0};
    for (int row = -1; row <= 1; ++row)
        for (int column = -1; column <= 1; ++column)
            entries_[index(1, row, column)] = R[3 * axis[size_t(row + 1)] + axis[size_t(column + 1)]];
    for (int l = 2; l < order; ++l)
        for (int m = -l; m <= l; ++m)
            for (int column = -l; column <= l; ++column) entries_[index(l, m, column)] = recurrence(l, m, column);
}

/// The functions P of [IvanicRuedenberg96]: products of band 1 with band l − 1.
double SphericalRotation::product(int i, int l, int m, int column) const {
    const auto below = [&](int c) { return entry(l - 1, m, c); };
    if (column == l) return entry(1, i, 1) * below(l - 1) - entry(1, i, -1) * below(1 - l);
    if (column == -l) return entry(1, i, 1) * below(1 - l) + entry(1, i, -1) * below(l - 1);
    return entry(1, i, 0) * below(column);
}

/// u U + v V + w W of [IvanicRuedenberg96], as corrected by [IvanicRuedenberg98].
double SphericalRotation::recurrence(int l, int m, int column) const {
    const int k = m < 0 ? -m : m;
    const double d = column == l || column == -l ? 2.0 * l * (2 * l - 1) : double(l + column) * (l - column);
    const auto P = [&](int i, int row) { return product(i, l, row, column); };

    double sum = 0;
    if (k < l) sum += std::sqrt((l + m) * (l - m) / d) * P(0, m);
    if (m == 0) return sum - 0.5 * std::sqrt(2.0 * (l - 1) * l / d) * (P(1, 1) + P(-1, -1));
    const double v = 0.5 * std::sqrt((l + k - 1.0) * (l + k) / d);
    if (m > 0)
        sum += v * (m == 1 ? std::sqrt(2.0) * P(1, 0) : P(1, m - 1) - P(-1, 1 - m));
    else
        sum += v * (m == -1 ? std::sqrt(2.0) * P(-1, 0) : P(1, m + 1) + P(-1, -m - 1));
    if (k + 1 < l) {
        const double w = -0.5 * std::sqrt((l - k - 1.0) * (l - k) / d);
        sum += w * (m > 0 ? P(1, m + 1) + P(-1, -m - 1) : P(1, m - 1) - P(-1, 1 - m));
    }
    return sum;
}

void SphericalRotation::apply(std::span<const double> in, std::span<double> out) const {
    for (int l = 0; l < order_; ++l)
        for (int row = -l; row <= l; ++row) {
            double sum = 0;
            for (int column = -l; column <= l; ++column)
                sum += entry(l, row, column) * in[size_t(coefficient_index(l, column))];
            out[size_t(coefficient_index(l, row))] = sum;
        }
}

// --- small tilts ----------------------------------------------------------------------------------------------------

TurnTiltTurn turn_tilt_turn(const Matrix3& R) {
    TurnTiltTurn out;
    // No std::hypot, whose newest version would need glibc 2.35; where the squares underflow, the tilt is none.
    const double sin_beta = std::sqrt(R[2] * R[2] + R[5] * R[5]);
    out.beta = std::atan2(sin_beta, R[8]);
    out.alpha = sin_beta > 0 ? std::atan2(R[5], R[2]) : 0;
    // The second row of R_z(−alpha) R is (sin gamma, cos gamma, 0), whichever alpha a tiny tilt has led to.
    const double c = std::cos(out.alpha), s = std::sin(out.alpha);
    out.gamma = std::atan2(c * R[3] - s * R[0], c * R[4] - s * R[1]);
    return out;
}

namespace {

/// d/dβ of a rotation about y, which links neighbouring m of a band only: out = J in.
void tilt_generator(int order, std::span<const double> in, std::span<double> out) {
    for (int l = 0; l < order; ++l)
        for (int m = -l; m <= l; ++m) {
            const int k = m < 0 ? -m : m, side = m < 0 ? -1 : 1;
            const auto at = [&](int j) { return in[size_t(coefficient_index(l, side * j))]; };
            double sum = 0;
            // Ladder operators of angular momentum between |m| and its neighbours; √2 where cos 0φ = 1 meets √2 cos φ.
            if (k > 1 || (k == 1 && m > 0)) sum += std::sqrt((l + k) * (l - k + 1.0) * (k == 1 ? 2 : 1)) * at(k - 1);
            if (k < l) sum -= std::sqrt((l - k) * (l + k + 1.0) * (k == 0 ? 2 : 1)) * at(k + 1);
            out[size_t(coefficient_index(l, m))] = 0.5 * sum;
        }
}

}  // namespace

void rotate_by_series(int order, const TurnTiltTurn& rotation, double tolerance, std::span<double> coefficients) {
    rotate_about_z(order, rotation.gamma, coefficients);
    // exp(β J) = Σ (β J)ᵏ / k!. J is skew with eigenvalues up to i (order − 1), so the rest after term k is at most
    // (β (order − 1))ᵏ⁺¹ / (k + 1)!.
    const double reach = rotation.beta * (order - 1);
    std::vector<double> term(coefficients.begin(), coefficients.end()), next(term.size());
    double rest = reach;
    for (int k = 1; rest > tolerance; ++k) {
        tilt_generator(order, term, next);
        for (size_t i = 0; i < term.size(); ++i) {
            term[i] = next[i] * (rotation.beta / k);
            coefficients[i] += term[i];
        }
        rest *= reach / (k + 1);
    }
    rotate_about_z(order, rotation.alpha, coefficients);
}

// --- hemispherical harmonics ----------------------------------------------------------------------------------------

HemisphericalRotation::HemisphericalRotation(int order, Horizon horizon, int spherical_order)
    : order_(order),
      spherical_order_(spherical_order),
      overlaps_(size_t(order) * size_t(order) * size_t(spherical_order)) {
    require_order(order);
    require_order(spherical_order);
    require(spherical_order >= order, "rotation: expected a spherical order of at least " + std::to_string(order) +
                                          ", the hemispherical order, got " + std::to_string(spherical_order));
    std::vector<double> H(size_t(polar_count(order))), Y(size_t(polar_count(spherical_order)));
    // Smooth in √z (hemisphere_heights): with that many nodes the error is that of rounding.
    for (const QuadratureNode& node : hemisphere_heights(2 * (order + spherical_order))) {
        hemispherical_legendre(order, node.x, H.data());
        legendre(spherical_order, node.x, std::sqrt(1 - node.x * node.x), Y.data());
        for (int m = 0; m < order; ++m) {
            // ∫ cos² mφ dφ = π; the √2 of either function are in H and Y.
            const double weight = node.weight * pi_double * (m == 0 ? 2 : 1);
            for (int l = m; l < order; ++l)
                for (int L = m; L < spherical_order; ++L)
                    overlaps_[index(l, L, m)] += weight * H[size_t(polar_index(l, m))] * Y[size_t(polar_index(L, m))];
        }
    }
    expansions_ = overlaps_;
    if (horizon == Horizon::dark) return;
    const HemisphereFit fit(spherical_order, continuation_tikhonov);
    std::vector<double> one(size_t(coefficient_count(spherical_order)));
    for (int l = 0; l < order; ++l) {
        // All m are processed at once, because they do not interact.
        std::fill(one.begin(), one.end(), 0.0);
        for (int m = 0; m <= l; ++m)
            for (int L = m; L < spherical_order; ++L) one[size_t(coefficient_index(L, m))] = overlaps_[index(l, L, m)];
        fit.fit(spherical_order, one);
        for (int m = 0; m <= l; ++m)
            for (int L = m; L < spherical_order; ++L)
                expansions_[index(l, L, m)] = one[size_t(coefficient_index(L, m))];
    }
}

std::vector<double> HemisphericalRotation::to_spherical(std::span<const double> hemispherical) const {
    std::vector<double> out(size_t(coefficient_count(spherical_order_)));
    for (int m = 1 - order_; m < order_; ++m) {
        const int k = m < 0 ? -m : m;
        for (int L = k; L < spherical_order_; ++L) {
            double sum = 0;
            for (int l = k; l < order_; ++l)
                sum += expansions_[index(l, L, k)] * hemispherical[size_t(coefficient_index(l, m))];
            out[size_t(coefficient_index(L, m))] = sum;
        }
    }
    return out;
}

void HemisphericalRotation::from_spherical(std::span<const double> spherical, std::span<double> hemispherical) const {
    for (int m = 1 - order_; m < order_; ++m) {
        const int k = m < 0 ? -m : m;
        for (int l = k; l < order_; ++l) {
            double sum = 0;
            for (int L = k; L < spherical_order_; ++L)
                sum += overlaps_[index(l, L, k)] * spherical[size_t(coefficient_index(L, m))];
            hemispherical[size_t(coefficient_index(l, m))] = sum;
        }
    }
}

void HemisphericalRotation::apply(const Matrix3& R, std::span<double> coefficients) const {
    require_rotation(R);
    const TurnTiltTurn rotation = turn_tilt_turn(R);
    if (rotation.beta == 0) return rotate_about_z(order_, rotation.gamma, coefficients);
    std::vector<double> spherical = to_spherical(coefficients);
    if (rotation.beta * (spherical_order_ - 1) < 8) {
        rotate_by_series(spherical_order_, rotation, 1e-12, spherical);
    } else {
        std::vector<double> turned(spherical.size());
        SphericalRotation(spherical_order_, R).apply(spherical, turned);
        spherical.swap(turned);
    }
    from_spherical(spherical, coefficients);
}

}  // namespace eclat
