// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The errors of single-precision coordinates and distances, and the offsets that rays need because of them.

#pragma once

namespace eclat {

/// The offset of ray origins from surfaces, as a fraction of the largest coordinate. Intersections are exact to a few
/// units in the last place of a float; an offset of eight to sixteen units keeps rays from hitting the surface that
/// they leave, at any scale of the scene.
constexpr float coordinate_resolution = 0x1p-20f;

/// A shadow ray is shortened by this fraction of its length, so that it does not hit the light itself. A point that is
/// sampled in solid angle is computed by intersecting the light's plane, with an error of about a hundred units in the
/// last place.
constexpr float shadow_shortening = 1 - 0x1p-13f;

}  // namespace eclat
