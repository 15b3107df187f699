// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Pinhole, thin-lens and orthographic cameras in glTF's convention: they look along local −z, +y up, +x right.

#pragma once

#include "base/vec.h"
#include "sampling/warp.h"
#include "scene/ray.h"

namespace eclat {

struct Camera {
    Vec3 right, up, backward, position;  // columns of the camera-to-world matrix
    int width = 0, height = 0;
    float half_width = 1, half_height = 1;  // of the image plane at distance 1, or in metres (orthographic)
    Vec2 shift;                             // of the principal point, in fractions of width and height
    float aperture_radius = 0, focus_distance = 1;
    bool orthographic = false;

    /// The ray through raster position (x, y) in pixels, (0, 0) being the image's top-left corner.
    Ray ray(float x, float y, Vec2 u_lens) const {
        const float sx = (2 * (x / static_cast<float>(width) + shift.x) - 1) * half_width;
        const float sy = (1 - 2 * (y / static_cast<float>(height) + shift.y)) * half_height;
        if (orthographic) return {position + right * sx + up * sy, 0, normalize(-backward), infinity};
        const Vec3 through = right * sx + up * sy - backward;
        if (aperture_radius == 0) return {position, 0, normalize(through), infinity};
        const Vec2 d = square_to_concentric_disk(u_lens);
        const Vec3 lens = (right * d.x + up * d.y) * aperture_radius;
        return {position + lens, 0, normalize(through * focus_distance - lens), infinity};
    }

    /// Width of a pixel at distance 1 from the pinhole (orthographic: in metres, at any distance).
    float pixel_size() const { return 2 * half_height / static_cast<float>(height); }
    float pixel_size_at(float distance) const { return orthographic ? pixel_size() : pixel_size() * distance; }
};

}  // namespace eclat
