// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Random normals about +z.

#pragma once

#include <cmath>

#include "sampling/rng.h"
#include "sampling/warp.h"

namespace eclat {

/// A normal that leans against +z by up to `degrees`.
inline Vec3 leaning(Rng& rng, float degrees) {
    const float u = rng.next(), v = rng.next();
    return square_to_uniform_cone({u, v}, 1 - std::cos(degrees * pi / 180));
}

}  // namespace eclat
