// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The results of sampling and evaluating lights, which all files of this folder use.

#pragma once

#include "base/color.h"
#include "base/frame.h"
#include "sampling/warp.h"
#include "scene/ray.h"

namespace eclat {

/// Light that arrives at a point from a direction chosen by a light.
struct LightSample {
    Vec3 wi;                    // towards the light
    float distance = 0;         // to the light; infinite for infinite lights
    Color radiance;             // arriving along wi, if nothing is in between; a delta light's irradiance facing it
    float pdf_solid_angle = 0;  // with the choice of the light; 0 = nothing here; delta: the choice's probability
    bool delta = false;         // no BSDF sample can find this light
    uint32_t triangle = no_triangle;  // of the scene, that emits
    Vec3 clearance{};  // from the point of the light to where rays towards it end, so that they do not hit the light
};

/// A photon that leaves a light.
struct PhotonSample {
    Vec3 origin, direction;
    Color power;                      // W, already divided by the density of all choices; black = nothing was emitted
    uint32_t triangle = no_triangle;  // of the scene, that it starts on
    float importance = 1;             // of where it starts: 1 before the places where surfaces exchange light, 0 … 1
};

}  // namespace eclat
