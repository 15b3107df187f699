// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A ceiling with a bright patch and a dark plate below it, seen from the floor: gathers, and the irradiance in closed form
// (Lambert's polygon formula).

#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "hemisphere/hemisphere.h"
#include "sampling/rng.h"

namespace eclat {

struct Rectangle {
    float x0, x1, y0, y1, z;
    float radiance;
};

// A ceiling with a bright patch, and a dark plate that hides a part of both.
inline const std::array<Rectangle, 3> scene{
    {{-40, 40, -40, 40, 1.0f, 1.0f}, {0.2f, 1.1f, -0.5f, 0.6f, 0.999f, 3.0f}, {-0.7f, 0.1f, -0.3f, 0.5f, 0.5f, 0.0f}}};

/// ∫ n·w dω over a polygon seen from the origin [Lambert]; vertices in either order.
inline double form(const std::vector<std::array<double, 3>>& v, std::array<double, 3> n) {
    double sum = 0;
    for (size_t i = 0; i < v.size(); ++i) {
        const auto &a = v[i], &b = v[(i + 1) % v.size()];
        const std::array<double, 3> c{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
        const double length = std::sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
        const double dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        sum += std::atan2(length, dot) * (n[0] * c[0] + n[1] * c[1] + n[2] * c[2]) / length;
    }
    return std::fabs(sum) / 2;
}

inline double form(double x0, double x1, double y0, double y1, double z, double px, double py,
                   std::array<double, 3> n) {
    return form({{x0 - px, y0 - py, z}, {x1 - px, y0 - py, z}, {x1 - px, y1 - py, z}, {x0 - px, y1 - py, z}}, n);
}

/// Irradiance at (x, y, 0): ceiling + 2 × patch, minus what the plate hides of them: its shadow on the ceiling.
inline double exact(double x, double y, std::array<double, 3> n = {0, 0, 1}) {
    const auto rect = [&](const Rectangle& r) { return form(r.x0, r.x1, r.y0, r.y1, r.z, x, y, n); };
    const Rectangle &patch = scene[1], &plate = scene[2];
    // The plate, projected from (x, y, 0) onto the patch's plane, cut with the patch.
    const double scale = double(patch.z) / plate.z;
    const auto project = [&](double c, double p) { return p + (c - p) * scale; };
    const double x0 = std::max<double>(patch.x0, project(plate.x0, x)),
                 x1 = std::min<double>(patch.x1, project(plate.x1, x));
    const double y0 = std::max<double>(patch.y0, project(plate.y0, y)),
                 y1 = std::min<double>(patch.y1, project(plate.y1, y));
    const double hidden_patch = x1 > x0 && y1 > y0 ? form(x0, x1, y0, y1, patch.z, x, y, n) : 0;
    return rect(scene[0]) + 2 * rect(patch) - rect(plate) - 2 * hidden_patch;
}

struct Seen {
    float radiance = 0, distance = infinity;
    Vec3 normal{0, 0, -1};
};

/// A gather in which direction w shows `look(w)`.
template <class F>
HemisphereSamples look_around(int rows, uint32_t seed, const F& look) {
    HemisphereSamples s;
    s.rows = rows;
    s.columns = columns_for(rows);
    s.frame = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    Rng rng(7, seed);
    for (int j = 0; j < s.rows; ++j)
        for (int k = 0; k < s.columns; ++k) {
            const float u1 = rng.next(), u2 = rng.next();
            const Vec3 w = cell_direction(s.rows, s.columns, j, k, {u1, u2});
            const Seen seen = look(w);
            s.radiance.emplace_back(seen.radiance);
            s.distance.push_back(seen.distance);
            s.direction.push_back(w);
            s.hit_normal.push_back(seen.normal);
        }
    return s;
}

inline HemisphereSamples gather(int rows, float x, float y, uint32_t seed = 1) {
    return look_around(rows, seed, [&](Vec3 w) {
        Seen seen;
        for (const Rectangle& r : scene) {
            const float t = r.z / w.z, hx = x + t * w.x, hy = y + t * w.y;
            if (t < seen.distance && hx > r.x0 && hx < r.x1 && hy > r.y0 && hy < r.y1) seen = {r.radiance, t};
        }
        return seen;
    });
}

}  // namespace eclat
