// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Gauss–Legendre quadrature, and its product with a uniform azimuth.

#pragma once

#include <cmath>
#include <vector>

#include "harmonics/spherical.h"

namespace eclat {

struct QuadratureNode {
    double x = 0, weight = 0;
};

/// ∫ f dx over [0, 1] with `count` nodes in rising order: exact for polynomials of degree 2 count − 1.
inline std::vector<QuadratureNode> gauss_legendre(int count) {
    std::vector<QuadratureNode> nodes(static_cast<size_t>(count));
    for (int i = 0; i < count; ++i) {
        // Newton's method on P_count from the asymptotic position of its root.
        double x = std::cos(pi_double * (i + 0.75) / (count + 0.5)), slope = 0;
        for (int step = 0; step < 100; ++step) {
            double last = 1, before = 0;
            for (int l = 1; l <= count; ++l) {
                const double next = ((2 * l - 1) * x * last - (l - 1) * before) / l;
                before = last;
                last = next;
            }
            slope = count * (x * last - before) / (x * x - 1);
            const double change = last / slope;
            x -= change;
            if (std::fabs(change) < 1e-15) break;
        }
        // On [−1, 1] the weight is 2 / ((1 − x²) P′²).
        nodes[static_cast<size_t>(count - 1 - i)] = {0.5 * (1 + x), 1 / ((1 - x * x) * slope * slope)};
    }
    return nodes;
}

/// Heights z = cosθ of the hemisphere with weights for dz. Nodes are those of √z, which makes the half powers of z in
/// hemispherical harmonics smooth and sees lobes along the surface.
inline std::vector<QuadratureNode> hemisphere_heights(int count) {
    std::vector<QuadratureNode> nodes = gauss_legendre(count);
    for (QuadratureNode& node : nodes) node = {node.x * node.x, 2 * node.x * node.weight};
    return nodes;
}

}  // namespace eclat
