// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// An orthonormal frame around a normal; local z is the normal.

#pragma once

#include "base/vec.h"

namespace eclat {

struct Frame {
    Vec3 u, v, n;

    /// Makes a frame from a unit normal without branches [Duff17].
    static Frame around(Vec3 n) {
        const float sign = std::copysign(1.0f, n.z);
        const float a = -1 / (sign + n.z);
        const float b = n.x * n.y * a;
        return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
    }

    /// Makes a frame around `n` whose axis u is as close as possible to `tangent`; if they are parallel, it is any
    /// frame around `n`.
    static Frame along(Vec3 n, Vec3 tangent) {
        const Vec3 u = tangent - n * dot(n, tangent);
        const float l2 = length_squared(u);
        if (!(l2 > 0)) return around(n);
        const Vec3 unit = u * (1 / std::sqrt(l2));
        return {unit, cross(n, unit), n};
    }

    Vec3 to_local(Vec3 w) const { return {dot(w, u), dot(w, v), dot(w, n)}; }
    Vec3 to_world(Vec3 w) const { return u * w.x + v * w.y + n * w.z; }
};

}  // namespace eclat
