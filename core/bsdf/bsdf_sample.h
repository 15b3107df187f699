// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The results of sampling and evaluating a lobe or a BSDF. All directions are unit vectors in the local shading frame.

#pragma once

#include "base/color.h"
#include "base/vec.h"

namespace eclat {

/// Value without the cosine, and the density of `sample` in the same direction; both 0 for delta distributions.
struct EvalPdf {
    Color f;
    float pdf_solid_angle = 0;
};

struct BsdfSample {
    Vec3 wi;
    Color weight;               ///< f · |cos| / pdf
    float pdf_solid_angle = 0;  ///< a discrete probability where `delta`
    bool delta = false;
    bool transmission = false;
    bool straight = false;  ///< through a thin sheet: light goes on as if nothing were there, as shadow rays do
    float eta_ratio = 1;    ///< index of refraction on the side of wi over the side of wo
};

inline float abs_cos(Vec3 w) { return std::abs(w.z); }

/// `w` on the other side of the surface.
inline Vec3 mirrored(Vec3 w) { return {w.x, w.y, -w.z}; }

/// Mirror image of `w` about the unit vector `m`.
inline Vec3 reflected(Vec3 w, Vec3 m) { return m * (2 * dot(w, m)) - w; }

}  // namespace eclat
