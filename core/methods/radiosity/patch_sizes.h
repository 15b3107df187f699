// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// How many patches there are if edges have a given length, and how long edges are for a given number of patches.

#pragma once

#include <cstddef>
#include <span>

#include "scene/scene.h"

namespace eclat {

/// Returns the number of sides that can be patches.
size_t count_sides(const Geometry& geometry);

/// Counts the patches with edges of at most `size` times the side's scale, up to `most`.
size_t count_patches(const Geometry& geometry, float size, size_t most, std::span<const float> scales = {});

/// Returns the area of all sides, m², each divided by the square of its scale.
double total_area(const Geometry& geometry, std::span<const float> scales = {});

/// Returns the length of the longest edge for which there are about `count` patches; it is infinite if there are that
/// many sides.
float patch_size_for(const Geometry& geometry, size_t count, std::span<const float> scales = {});

/// Returns the scale of a side (2 · triangle + back).
inline float scale_of(std::span<const float> scales, size_t side) { return scales.empty() ? 1 : scales[side]; }

}  // namespace eclat
