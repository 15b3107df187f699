// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Names for the shapes of arrays that are passed between Python and the core, and their conversions.

#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <array>
#include <vector>

#include "base/color.h"
#include "transport/point_irradiance.h"

namespace nb = nanobind;

namespace eclat {

template <class T, nb::ssize_t... Shape>
using Array = nb::ndarray<const T, nb::shape<Shape...>, nb::c_contig, nb::device::cpu>;
using Points = Array<float, -1, 3>;
using Uvs = Array<float, -1, 2>;
using Colors = Array<float, -1, 4>;
using Tangents = Array<float, -1, 4>;
using Triangles = Array<uint32_t, -1, 3>;
using Bytes3 = Array<uint8_t, -1, -1, -1>;
using Floats2 = Array<float, -1, -1>;
using Floats3 = Array<float, -1, -1, -1>;

inline Vec3 vec3(const std::array<float, 3>& a) { return {a[0], a[1], a[2]}; }
inline Color color(const std::array<float, 3>& a) { return {a[0], a[1], a[2]}; }

inline std::vector<Vec3> vec3s(const Points& a) {
    std::vector<Vec3> out(a.shape(0));
    for (size_t i = 0; i < out.size(); ++i) out[i] = {a(i, 0), a(i, 1), a(i, 2)};
    return out;
}
inline std::vector<Vec2> vec2s(const Uvs& a) {
    std::vector<Vec2> out(a.shape(0));
    for (size_t i = 0; i < out.size(); ++i) out[i] = {a(i, 0), a(i, 1)};
    return out;
}

inline std::vector<PointNormal> points_with_normals(const Points& positions, const Points& normals) {
    if (positions.shape(0) != normals.shape(0)) throw std::invalid_argument("expected as many normals as points");
    std::vector<PointNormal> out(positions.shape(0));
    for (size_t i = 0; i < out.size(); ++i)
        out[i] = {{positions(i, 0), positions(i, 1), positions(i, 2)}, {normals(i, 0), normals(i, 1), normals(i, 2)}};
    return out;
}

/// Makes a NumPy array of `shape` that `fill(float* data)` fills.
template <class Fill>
nb::ndarray<nb::numpy, float> float_array(std::initializer_list<size_t> shape, Fill&& fill) {
    size_t size = 1;
    for (size_t n : shape) size *= n;
    auto* data = new float[size];
    nb::capsule owner(data, [](void* p) noexcept { delete[] static_cast<float*>(p); });
    fill(data);
    return {data, shape, owner};
}

/// (values, 3).
inline auto color_array(const std::vector<Color>& values) {
    return float_array({values.size(), 3}, [&](float* data) {
        for (const Color& c : values)
            for (int k = 0; k < 3; ++k) *data++ = c[k];
    });
}

}  // namespace eclat
