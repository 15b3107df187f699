// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Microfacet normal distributions, anisotropic: GGX [Walter07 eq. 33] and Beckmann [Walter07 eq. 25], with separable
// Smith masking, sampled by visible normals (GGX, [Heitz18]) or by normals (Beckmann).

#pragma once

#include "base/vec.h"

namespace eclat {

struct Microfacets {
    float ax = 0.1f, ay = 0.1f;
    bool beckmann = false;

    float d(Vec3 h) const {
        if (h.z <= 0) return 0;
        const float x = h.x / ax, y = h.y / ay, z2 = h.z * h.z;
        if (beckmann) return std::exp(-(x * x + y * y) / z2) / (pi * ax * ay * z2 * z2);
        const float s = x * x + y * y + z2;
        return 1 / (pi * ax * ay * s * s);
    }

    /// Smith masking of one direction; zero where it sees the micro-normal's back.
    float g1(Vec3 w, Vec3 h) const {
        if (dot(w, h) * w.z <= 0) return 0;
        const float slope2 = (sqr(ax * w.x) + sqr(ay * w.y)) / (w.z * w.z);
        if (slope2 == 0) return 1;
        if (!beckmann) return 2 / (1 + std::sqrt(1 + slope2));
        const float a = 1 / std::sqrt(slope2);
        if (a >= 1.6f) return 1;
        // Rational fit of the error-function form, relative error below 0.35 % [Walter07 eq. 27].
        return (3.535f * a + 2.181f * a * a) / (1 + 2.276f * a + 2.577f * a * a);
    }

    /// A micro-normal for `w` with w.z > 0.
    Vec3 sample(Vec3 w, Vec2 u) const {
        if (beckmann) {
            const float phi = 2 * pi * u.y, r = std::sqrt(-std::log(1 - u.x));
            return normalize({ax * r * std::cos(phi), ay * r * std::sin(phi), 1});
        }
        const Vec3 v = normalize({ax * w.x, ay * w.y, w.z});
        const float l2 = v.x * v.x + v.y * v.y;
        const Vec3 t1 = l2 > 0 ? Vec3{-v.y, v.x, 0} / std::sqrt(l2) : Vec3{1, 0, 0}, t2 = cross(v, t1);
        const float r = std::sqrt(u.x), phi = 2 * pi * u.y, s = 0.5f * (1 + v.z);
        const float p1 = r * std::cos(phi);
        const float p2 = (1 - s) * safe_sqrt(1 - p1 * p1) + s * r * std::sin(phi);
        const Vec3 n = t1 * p1 + t2 * p2 + v * safe_sqrt(1 - p1 * p1 - p2 * p2);
        return normalize({ax * n.x, ay * n.y, std::max(1e-6f, n.z)});
    }

    /// Density of `sample` over micro-normals.
    float pdf(Vec3 w, Vec3 h) const {
        if (beckmann) return d(h) * h.z;
        return g1(w, h) * std::fabs(dot(w, h)) * d(h) / std::fabs(w.z);
    }
};

}  // namespace eclat
