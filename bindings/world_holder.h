// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A scene as Python holds it: owns everything that a World borrows.

#pragma once

#include <memory>
#include <vector>

#include "transport/world.h"

namespace eclat {

struct CoreScene {
    std::unique_ptr<Geometry> geometry;
    std::vector<EmitterTriangle> emitters;
    std::vector<uint32_t> emitter_of_triangle;
    Lights lights;

    World world() const { return {*geometry, lights, emitter_of_triangle}; }
};

}  // namespace eclat
