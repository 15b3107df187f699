// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The surfaces and lights that light transport needs.

#pragma once

#include "lights/light.h"
#include "scene/scene.h"

namespace eclat {

constexpr uint32_t not_emitting = ~0u;

struct World {
    const Geometry& geometry;
    const Lights& lights;
    const std::vector<uint32_t>& emitter_of_triangle;  // empty when nothing emits

    uint32_t emitter(uint32_t triangle) const {
        return emitter_of_triangle.empty() ? not_emitting : emitter_of_triangle[triangle];
    }
};

}  // namespace eclat
