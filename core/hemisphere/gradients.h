// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>

#include "base/color.h"

namespace eclat {

/// The rotation gradient of irradiance per channel, in W·m⁻² per radian: a rotation of the normal from n_k to n changes
/// the irradiance by (n_k × n) · gradient.
struct RotationGradient {
    std::array<Vec3, 3> channel;
};

/// The translation gradient of irradiance in the tangent plane per channel, in W·m⁻³.
struct TranslationGradient {
    std::array<Vec3, 3> channel;
};

}  // namespace eclat
