// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The second derivatives of irradiance in the tangent plane, computed from one gather. Their size determines how far a
// first-order extrapolation is accurate [Jarosz12, Schwarzhaupt12].

#pragma once

#include "hemisphere/hemisphere.h"

namespace eclat {

/// The model of the surroundings from which the second derivatives are computed.
enum class Curvature : uint8_t {
    occlusion,    // a mesh through all hits, which includes occlusion [Schwarzhaupt12]
    radiometric,  // patches that always stay visible, each with its own radiance [Jarosz12]
    geometric,    // patches that always stay visible, all with the same radiance
};

/// Second derivatives along u and v of a gather's frame; symmetric.
struct TangentHessian {
    float uu = 0, uv = 0, vv = 0;
};

/// Computes the Hessian of the irradiance's luminance in W m⁻⁴. Distances above `far` count as `far`.
/// It needs directions, and also hit normals unless the model is `occlusion`.
TangentHessian irradiance_hessian(const HemisphereSamples& samples, Curvature curvature, float far);

/// Returns the contribution of the edge between two vertices of the mesh if the radiance on the side of a × b is larger
/// by 1. `a` and `b` are unit directions, and `near_a` and `near_b` are the inverse distances in these directions. The
/// sum over the edges of a polygon, in the order in which that side is inside, is the Hessian of its irradiance for a
/// radiance of 1.
TangentHessian edge_hessian(Vec3 a, float near_a, Vec3 b, float near_b);

/// The two eigenvalues by size, and the direction of the larger one as an angle from u.
struct PrincipalCurvatures {
    float larger = 0, smaller = 0;  // absolute values
    float angle = 0;
};
PrincipalCurvatures principal_curvatures(const TangentHessian& hessian);

}  // namespace eclat
