// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "base/frame.h"
#include "bsdf/bsdf.h"
#include "scene/ray.h"

namespace eclat {

/// The share of a uniform hemisphere's irradiance that is left where a shading normal bends by an angle α from the geometric
/// one: light is measured by its cosine to the shading normal, and what is above the surface but below that brings none. It
/// is (1 + cos α) / 2, and 1 where both are the same.
inline float even_share(Vec3 normal, Vec3 shading) {
    return shading == normal ? 1 : 0.5f * (1 + clamp(dot(normal, shading), -1, 1));
}

/// Where a ray met a surface, and how that point scatters.
struct SurfacePoint {
    Vec3 position;
    Vec3 normal;       // geometric, unit, on the side of the viewer unless the material refracts
    Frame frame;       // of shading; its z is the side that `bsdf` looks at
    Vec2 uv;           // of the emitter's texture set
    float offset = 0;  // how far rays must start from the surface so that they do not meet it again
    uint32_t triangle = no_triangle;
    Bsdf bsdf;

    /// The geometric normal, on the side that `bsdf` looks at.
    Vec3 normal_towards_shading() const { return dot(normal, frame.n) >= 0 ? normal : -normal; }

    /// The share of a uniform hemisphere's irradiance that its shading normal leaves.
    float even_share() const { return eclat::even_share(normal_towards_shading(), frame.n); }

    /// The same place as it is seen from the other side of a sheet, without what scatters there.
    SurfacePoint other_side() const {
        SurfacePoint out;
        out.position = position;
        out.normal = -normal;
        out.frame = Frame::around(-frame.n);
        out.uv = uv;
        out.offset = offset;
        out.triangle = triangle;
        return out;
    }

    /// A ray that leaves towards `direction`.
    Ray ray(Vec3 direction, float t_max = infinity) const {
        const float side = dot(direction, normal) >= 0 ? offset : -offset;
        return {position + normal * side, 0, direction, t_max};
    }
};

}  // namespace eclat
