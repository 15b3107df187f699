// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <cstdint>

#include "base/vec.h"

namespace eclat {

struct Ray {
    Vec3 origin;
    float t_min = 0;
    Vec3 direction;
    float t_max = infinity;
};

constexpr uint32_t no_triangle = ~0u;

struct Hit {
    uint32_t triangle = no_triangle;
    float t = infinity;
    float u = 0, v = 0;  // barycentric weights of the second and third vertex

    bool missed() const { return triangle == no_triangle; }
};

}  // namespace eclat
