// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <array>

#include "hemisphere/gradients.h"

namespace eclat {

/// The irradiance at a point, with the data by which it is extrapolated to neighbouring points [Ward88,
/// WardHeckbert92].
struct IrradianceRecord {
    Vec3 position, normal;
    Color irradiance;
    Color excess;  // irradiance from a few bright rays, which the records around share
    RotationGradient rotation;
    TranslationGradient translation;
    float distance = 0;    // ℓ_k, the length to which the radius is proportional, see records/spacing.cpp
    float radius = 0;      // radius of validity: a share of ℓ_k, clamped by neighbours and bounds
    float elongation = 1;  // ratio of the radius along the long axis to the radius across it
    float axis = 0;        // angle of the long axis in Frame::around(normal)
    float curvature = 0;   // larger second derivative of E's luminance in the tangent plane, W·m⁻⁴
    float least_radius = 0, largest_radius = infinity;  // bounds of the radius, from the width of a pixel there
    /// For each sector of azimuth in Frame::around(normal), the distance along the surface at which geometry is in the
    /// way. Beyond it there may be another room.
    std::array<float, 12> clearance{};
    float noise = 0;         // relative noise that a gather with the usual number of rays would have
    float own_noise = 0;     // relative noise of the value read here, with the actual number of rays
    float excess_noise = 0;  // standard error of the luminance of the excess, W·m⁻²
    float enclosed =
        0;  // 1 if it is inside a solid (most rays hit backs of one-sided surfaces); such records are never read
};
static_assert(sizeof(IrradianceRecord) <= 212);

}  // namespace eclat
