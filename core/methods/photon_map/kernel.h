// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The weight of a photon as a function of its distance from the centre of the disc in which light is estimated.

#pragma once

#include <cmath>
#include <cstdint>

#include "base/vec.h"

namespace eclat {

enum class Kernel : uint8_t { uniform, cone, epanechnikov };

/// Returns the weight at the squared distance `x2`, in units of the squared radius of the disc (0 ≤ x2 ≤ 1). Its
/// integral over the disc of radius 1 is 1. The cone is that of [Jensen01] with k = 1; the kernel of Epanechnikov in
/// two dimensions is in [Silverman86].
inline float kernel_weight(Kernel kernel, float x2) {
    switch (kernel) {
        case Kernel::cone: return 3 * inv_pi * (1 - std::sqrt(x2));
        case Kernel::epanechnikov: return 2 * inv_pi * (1 - x2);
        default: return inv_pi;
    }
}

/// Returns the squared distance from the centre within which the fraction `u` of the kernel's integral lies.
inline float kernel_quantile2(Kernel kernel, float u) {
    switch (kernel) {
        case Kernel::cone: {
            // 3 x² − 2 x³ = u is a cubic with one root in [0, 1]: the inverse of a smooth step.
            const float x = 0.5f - std::sin(std::asin(1 - 2 * u) / 3);
            return x * x;
        }
        case Kernel::epanechnikov: return 1 - std::sqrt(1 - u);
        default: return u;
    }
}

}  // namespace eclat
