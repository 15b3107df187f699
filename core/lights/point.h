// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A point light that emits equally in all directions.

#pragma once

#include "lights/light_sample.h"
#include "sampling/warp.h"

namespace eclat {

struct PointLight {
    Vec3 position;
    Color intensity;  // W sr^-1

    LightSample sample(Vec3 from) const {
        const Vec3 to = position - from;
        const float d2 = length_squared(to);
        if (!(d2 > 0)) return {};
        const float distance = std::sqrt(d2);
        return {to * (1 / distance), distance, intensity / d2, 1, true};
    }

    PhotonSample emit(Vec2 u) const { return {position, square_to_uniform_sphere(u), power()}; }

    Color power() const { return intensity * (4 * pi); }
};

}  // namespace eclat
