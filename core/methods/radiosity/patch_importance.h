// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// How finely the sides of a scene need patches: a ground that reaches to the horizon, or a part astray, exchanges hardly any light
// with the rest, but would take most patches by its area.

#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene.h"

namespace eclat {

/// By side (2 · triangle + back): how much longer its patches may be than those of sides that exchange light, at least 1.
/// Empty where most of the area is of sides that do: then all patches are of one size.
std::vector<float> patch_scales(const Geometry& geometry, uint32_t seed);

}  // namespace eclat
