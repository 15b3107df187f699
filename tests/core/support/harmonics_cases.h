// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Directions, rotations and functions without symmetry, for the tests of harmonics.

#pragma once

#include <vector>

#include "harmonics/quadrature.h"
#include "harmonics/rotation.h"
#include "sampling/rng.h"

namespace eclat::test {

inline std::vector<double> random_coefficients(int order, uint32_t seed) {
    Rng rng(3, seed);
    std::vector<double> out(size_t(coefficient_count(order)));
    for (double& c : out) c = 2 * double(rng.next()) - 1;
    return out;
}

inline Direction direction_at(double theta, double phi) {
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

inline Matrix3 about_z(double a) { return {std::cos(a), -std::sin(a), 0, std::sin(a), std::cos(a), 0, 0, 0, 1}; }
inline Matrix3 about_y(double a) { return {std::cos(a), 0, std::sin(a), 0, 1, 0, -std::sin(a), 0, std::cos(a)}; }

inline Matrix3 operator*(const Matrix3& A, const Matrix3& B) {
    Matrix3 out{};
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j)
            for (size_t k = 0; k < 3; ++k) out[3 * i + j] += A[3 * i + k] * B[3 * k + j];
    return out;
}

/// Rᵀ w
inline Direction turned_back(const Matrix3& R, Direction w) {
    return {R[0] * w.x + R[3] * w.y + R[6] * w.z, R[1] * w.x + R[4] * w.y + R[7] * w.z,
            R[2] * w.x + R[5] * w.y + R[8] * w.z};
}

struct Node {
    Direction w;
    double weight;
};

/// Heights times 2 × `count` azimuths.
inline std::vector<Node> product_grid(const std::vector<QuadratureNode>& heights, int count) {
    std::vector<Node> out;
    for (const QuadratureNode& h : heights)
        for (int i = 0; i < 2 * count; ++i)
            out.push_back({direction_at(std::acos(h.x), pi_double * (i + 0.5) / count), h.weight * pi_double / count});
    return out;
}

inline std::vector<Node> sphere_grid(int count) {
    std::vector<QuadratureNode> heights = gauss_legendre(count);
    for (QuadratureNode& h : heights) h = {2 * h.x - 1, 2 * h.weight};
    return product_grid(heights, count);
}

inline std::vector<Node> hemisphere_grid(int count) { return product_grid(hemisphere_heights(count), count); }

inline double evaluated(Basis basis, int order, const std::vector<double>& c, Direction w) {
    std::vector<double> B(c.size());
    evaluate_harmonics(basis, order, w, B.data());
    double sum = 0;
    for (size_t i = 0; i < c.size(); ++i) sum += c[i] * B[i];
    return sum;
}

inline double distance(const std::vector<double>& a, const std::vector<double>& b) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
    return std::sqrt(sum);
}

inline double norm(const std::vector<double>& a) { return distance(a, std::vector<double>(a.size())); }

}  // namespace eclat::test
