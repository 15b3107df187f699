// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The places of a scene where surfaces exchange light: rooms, streets, what stands on a ground that reaches to the horizon.

#pragma once

#include <vector>

#include "lights/emission_discs.h"
#include "scene/scene.h"

namespace eclat {

/// Returns up to eight balls around the places where surfaces exchange most light, or none if they are as wide as the scene.
std::vector<Ball> busy_places(const Geometry& geometry);

}  // namespace eclat
