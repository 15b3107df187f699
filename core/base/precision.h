// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The errors of single-precision coordinates and distances, and the offsets that rays need because of them.

#pragma once

namespace eclat {

/// Where a computed point may lie, as a fraction of its largest coordinate. Intersections are exact to some units in the last
/// place of a float; eight to sixteen of them keep rays from meeting the surface that they leave, at any scale of the scene.
constexpr float coordinate_resolution = 0x1p-20f;

/// A shadow ray ends this fraction of its length short of the light, so that it does not meet the light itself: a point
/// that was sampled in solid angle is found by intersecting the light's plane, to some hundred units in the last place.
constexpr float shadow_shortening = 1 - 0x1p-13f;

}  // namespace eclat
