// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>

#include "base/color.h"

namespace eclat {

/// How irradiance changes when the normal turns: per channel, used as (n_k × n) · gradient. W·m⁻² per radian.
struct RotationGradient {
    std::array<Vec3, 3> channel;
};

/// How irradiance changes when the point moves in its tangent plane: per channel. W·m⁻³.
struct TranslationGradient {
    std::array<Vec3, 3> channel;
};

}  // namespace eclat
