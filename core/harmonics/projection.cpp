// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "harmonics/projection.h"

#include <cstdlib>

#include "harmonics/quadrature.h"

namespace eclat {

std::vector<double> project(Basis basis, int order, std::span<const Direction> directions,
                            std::span<const double> values, std::span<const double> weights, int channels) {
    require_order(order);
    const size_t count = size_t(coefficient_count(order)), width = size_t(channels);
    std::vector<double> out(count * width), B(count);
    for (size_t i = 0; i < directions.size(); ++i) {
        evaluate_harmonics(basis, order, directions[i], B.data());
        const double weight = weights.empty() ? 1 : weights[i];
        for (size_t j = 0; j < count; ++j)
            for (size_t c = 0; c < width; ++c) out[j * width + c] += weight * B[j] * values[i * width + c];
    }
    return out;
}

std::vector<double> reconstruct(Basis basis, int order, std::span<const double> coefficients,
                                std::span<const Direction> directions, int channels) {
    require_order(order);
    const size_t count = size_t(coefficient_count(order)), width = size_t(channels);
    std::vector<double> out(directions.size() * width), B(count);
    for (size_t i = 0; i < directions.size(); ++i) {
        evaluate_harmonics(basis, order, directions[i], B.data());
        for (size_t j = 0; j < count; ++j)
            for (size_t c = 0; c < width; ++c) out[i * width + c] += B[j] * coefficients[j * width + c];
    }
    return out;
}

HemisphereFit::HemisphereFit(int order, double tikhonov)
    : order_(order), gram_(size_t(order) * size_t(order) * size_t(order)), factors_(gram_.size()) {
    require_order(order);
    const auto at = [&](int l, int k, int m) { return size_t((m * order_ + l) * order_ + k); };
    // Products of two Legendre functions of equal m are polynomials of degree 2 order − 2 at most: exact.
    std::vector<double> P(size_t(polar_count(order)));
    for (const QuadratureNode& node : gauss_legendre(order)) {
        legendre(order, node.x, std::sqrt(1 - node.x * node.x), P.data());
        for (int m = 0; m < order; ++m)
            for (int l = m; l < order; ++l)
                for (int k = m; k < order; ++k)
                    gram_[at(l, k, m)] += node.weight * pi_double * (m == 0 ? 2 : 1) * P[size_t(polar_index(l, m))] *
                                          P[size_t(polar_index(k, m))];
    }
    // Cholesky factors; those of smaller orders are their upper left corners.
    for (int m = 0; m < order; ++m)
        for (int l = m; l < order; ++l)
            for (int k = m; k <= l; ++k) {
                double sum = gram_[at(l, k, m)] + (l == k ? tikhonov : 0);
                for (int i = m; i < k; ++i) sum -= factors_[at(l, i, m)] * factors_[at(k, i, m)];
                if (l == k) {
                    require(sum > 0,
                            "the Gram matrix on the hemisphere is singular in double precision: use a larger "
                            "Tikhonov factor or a lower order");
                    factors_[at(l, l, m)] = std::sqrt(sum);
                } else {
                    factors_[at(l, k, m)] = sum / factors_[at(k, k, m)];
                }
            }
}

double HemisphereFit::gram(int l, int k, int m) const {
    const int n = std::abs(m);
    return l < n || k < n ? 0 : gram_[size_t((n * order_ + l) * order_ + k)];
}

void HemisphereFit::fit(int order, std::span<double> coefficients) const {
    orthonormalize(order, coefficients);
    for (int m = 1 - order; m < order; ++m) {
        const int n = std::abs(m);
        const auto c = [&](int l) -> double& { return coefficients[size_t(coefficient_index(l, m))]; };
        for (int l = order - 1; l >= n; --l) {
            for (int k = l + 1; k < order; ++k) c(l) -= factor(k, l, n) * c(k);
            c(l) /= factor(l, l, n);
        }
    }
}

void HemisphereFit::orthonormalize(int order, std::span<double> inner_products) const {
    for (int m = 1 - order; m < order; ++m) {
        const int n = std::abs(m);
        const auto c = [&](int l) -> double& { return inner_products[size_t(coefficient_index(l, m))]; };
        for (int l = n; l < order; ++l) {
            for (int k = n; k < l; ++k) c(l) -= factor(l, k, n) * c(k);
            c(l) /= factor(l, l, n);
        }
    }
}

void HemisphereFit::to_inner_products(int order, std::span<double> orthonormal) const {
    for (int m = 1 - order; m < order; ++m) {
        const int n = std::abs(m);
        const auto c = [&](int l) -> double& { return orthonormal[size_t(coefficient_index(l, m))]; };
        for (int l = order - 1; l >= n; --l) {
            c(l) *= factor(l, l, n);
            for (int k = n; k < l; ++k) c(l) += factor(l, k, n) * c(k);
        }
    }
}

std::vector<double> HemisphereFit::energies(std::span<const double> inner_products) const {
    // With G = L Lᵀ, bᵀ G⁻¹ b = |L⁻¹ b|², and the first rows of L⁻¹ b are those of the smaller orders.
    std::vector<double> bands(inner_products.size() / size_t(order_)), y(bands.size());
    for (int m = 1 - order_; m < order_; ++m) {
        const int n = std::abs(m);
        for (int l = n; l < order_; ++l) {
            double sum = inner_products[size_t(coefficient_index(l, m))];
            for (int k = n; k < l; ++k) sum -= factor(l, k, n) * y[size_t(k)];
            y[size_t(l)] = sum / factor(l, l, n);
            bands[size_t(l)] += y[size_t(l)] * y[size_t(l)];
        }
    }
    for (int l = 1; l < order_; ++l) bands[size_t(l)] += bands[size_t(l) - 1];
    return bands;
}

}  // namespace eclat
