// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A scene with its lights; it owns the data to which a World refers.

#pragma once

#include <memory>
#include <vector>

#include "transport/world.h"

namespace eclat {

struct LitScene {
    std::unique_ptr<Geometry> geometry;
    std::vector<EmitterTriangle> emitters;
    std::vector<uint32_t> emitter_of_triangle;  // empty when nothing emits
    Lights lights;

    World world() const { return {*geometry, lights, emitter_of_triangle}; }
};

/// Adds to `lights` all triangles whose material emits, and sets the bounding sphere of the scene.
LitScene light_scene(std::unique_ptr<Geometry> geometry, LightInputs lights = {});

}  // namespace eclat
