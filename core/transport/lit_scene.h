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

/// Makes a scene with the given lights and those of all triangles whose material emits. The triangles and the bounding
/// sphere in `lights` are set here.
LitScene light_scene(std::unique_ptr<Geometry> geometry, LightInputs lights = {});

}  // namespace eclat
