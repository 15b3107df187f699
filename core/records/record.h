// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>

#include "hemisphere/gradients.h"

namespace eclat {

/// Irradiance at a point, with what is needed to extrapolate it to its surroundings [Ward88, WardHeckbert92].
struct IrradianceRecord {
    Vec3 position, normal;
    Color irradiance;
    Color excess;  // irradiance from rays too few and too bright for one record to judge: read as neighbours' mean
    RotationGradient rotation;
    TranslationGradient translation;
    float distance = 0;    // ℓ_k: the length that its radius follows, see records/spacing.cpp
    float radius = 0;      // within which it is valid: a part of ℓ_k, clamped to its neighbours and its bounds
    float elongation = 1;  // how much farther it is valid along its long axis
    float axis = 0;        // angle of that axis in Frame::around(normal)
    float curvature = 0;   // larger second derivative of E's luminance in the tangent plane, W·m⁻⁴
    float least_radius = 0, largest_radius = infinity;  // its bounds, from the size of a pixel there
    /// Per sector of azimuth in Frame::around(normal): how far one can walk before geometry stands in the way. What
    /// lies beyond may be another room.
    std::array<float, 12> clearance{};
    float noise = 0;         // relative, as if its gather had the usual number of rays
    float own_noise = 0;     // relative, of what is read there with the rays that it had
    float excess_noise = 0;  // standard error of the excess's luminance, W·m⁻²
    float enclosed = 0;      // 1: inside solids, unseen, most rays meeting backs of one-sided surfaces; never read
};
static_assert(sizeof(IrradianceRecord) <= 212);

}  // namespace eclat
