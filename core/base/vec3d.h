// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Vectors of three doubles, for the few places where floats cancel.

#pragma once

#include <cmath>

#include "base/vec.h"

namespace eclat {

struct Vec3d {
    double x = 0, y = 0, z = 0;

    Vec3d() = default;
    Vec3d(double x, double y, double z) : x(x), y(y), z(z) {}
    explicit Vec3d(Vec3 v) : x(v.x), y(v.y), z(v.z) {}
    explicit operator Vec3() const { return {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)}; }
};

inline Vec3d operator+(Vec3d a, Vec3d b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3d operator-(Vec3d a, Vec3d b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3d operator*(Vec3d a, double s) { return {a.x * s, a.y * s, a.z * s}; }

inline double dot(Vec3d a, Vec3d b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3d cross(Vec3d a, Vec3d b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline double length_squared(Vec3d a) { return dot(a, a); }
inline double length(Vec3d a) { return std::sqrt(dot(a, a)); }

}  // namespace eclat
