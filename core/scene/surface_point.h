// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "base/frame.h"
#include "base/precision.h"
#include "bsdf/bsdf.h"
#include "scene/ray.h"

namespace eclat {

/// The share of a uniform hemisphere's irradiance that is left where a shading normal bends by an angle α from the geometric
/// one: light is measured by its cosine to the shading normal, and what is above the surface but below that brings none. It
/// is (1 + cos α) / 2, and 1 where both are the same.
inline float even_share(Vec3 normal, Vec3 shading) {
    return shading == normal ? 1 : 0.5f * (1 + clamp(dot(normal, shading), -1, 1));
}

/// The point at which a ray hit a surface, and the scattering there.
struct SurfacePoint {
    Vec3 position;
    Vec3 normal;       // geometric unit normal, on the side of the viewer unless the material refracts
    Frame frame;       // shading frame, whose z axis is on the side of `bsdf`
    Vec2 uv;           // of the emitter's texture set
    float offset = 0;  // distance from the surface at which rays start, so that they do not hit it again
    uint32_t triangle = no_triangle;
    Bsdf bsdf;

    /// Returns the geometric normal on the side of `bsdf`.
    Vec3 normal_towards_shading() const { return dot(normal, frame.n) >= 0 ? normal : -normal; }

    /// The share of a uniform hemisphere's irradiance that its shading normal leaves.
    float even_share() const { return eclat::even_share(normal_towards_shading(), frame.n); }

    /// Returns the same point as seen from the other side of the surface, without a BSDF.
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

    /// A shadow ray to the point of a light that lies in `direction` at `distance`. It starts off this surface and ends
    /// at `clearance` from the light's, and its direction is that between these two: close to a light, the offsets are no
    /// small part of the distance, so that a ray of the given direction and length would hit the light itself.
    Ray ray_to_light(Vec3 direction, float distance, Vec3 clearance) const {
        if (distance == infinity) return ray(direction);
        const float side = dot(direction, normal) >= 0 ? offset : -offset;
        return ray_between(position, normal * side, direction * distance + clearance);
    }

    /// The shadow ray that starts at `start` from `position` and ends at `end` from it.
    static Ray ray_between(Vec3 position, Vec3 start, Vec3 end) {
        const Vec3 to = end - start;
        const float distance = length(to);
        return {position + start, 0, distance > 0 ? to / distance : Vec3{0, 0, 1}, distance * shadow_shortening};
    }
};

}  // namespace eclat
