// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The second derivatives of irradiance in the tangent plane, computed from one gather. Their size determines how far a
// first-order extrapolation is accurate [Jarosz12, Schwarzhaupt12].

#pragma once

#include "hemisphere/hemisphere.h"

namespace eclat {

/// What a gather's cells are taken for when their second derivatives are added up.
enum class Curvature : uint8_t {
    occlusion,    // a mesh through all hits: also what hides and appears counts [Schwarzhaupt12]
    radiometric,  // patches that stay visible, each with its own radiance [Jarosz12]
    geometric,    // the same, all of one radiance
};

/// Second derivatives along u and v of a gather's frame; symmetric.
struct TangentHessian {
    float uu = 0, uv = 0, vv = 0;
};

/// The Hessian of the irradiance's luminance [W m⁻⁴]. Whatever lies farther than `far` counts as that far.
///
/// Needs directions, and hit normals where the curvature is not that of occlusion.
TangentHessian irradiance_hessian(const HemisphereSamples& samples, Curvature curvature, float far);

/// What the edge between two vertices of the mesh adds where the side that a × b points to is brighter by 1: `a` and `b`
/// are unit directions, `near_a` and `near_b` one over the distances in them. The sum over the edges of a polygon, in the
/// order in which that side is inside, is the Hessian of its irradiance for a radiance of 1.
TangentHessian edge_hessian(Vec3 a, float near_a, Vec3 b, float near_b);

/// Both eigenvalues by size, and the direction of the larger one as an angle from u.
struct PrincipalCurvatures {
    float larger = 0, smaller = 0;  // absolute values
    float angle = 0;
};
PrincipalCurvatures principal_curvatures(const TangentHessian& hessian);

}  // namespace eclat
