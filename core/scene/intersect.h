// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Rays against triangles, in batches. Straight-through opacity is decided here, so that masked leaves are invisible to
// whoever asks: a candidate hit counts with probability `opacity`, drawn from a hash of the ray and the hit.

#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "base/vec.h"
#include "scene/ray.h"

namespace eclat {

/// Opacity in [0, 1] of a triangle at barycentric weights (u, v).
using OpacityFunction = std::function<float(uint32_t triangle, float u, float v)>;

enum class Coherence { none, camera };

class Intersector {
  public:
    struct Triangle {
        uint32_t v[3];
    };

    /// `translucent[i]` says that triangle i needs `opacity`. The arrays are borrowed and must outlive this object;
    /// `vertices` must own one element more than it shows (wide loads read past the last).
    Intersector(std::span<const Vec3> vertices, std::span<const Triangle> triangles,
                const std::vector<uint8_t>& translucent, OpacityFunction opacity);
    ~Intersector();
    Intersector(const Intersector&) = delete;

    /// Closest hit of each ray. Rays are taken eight at a time in order, so results depend on a batch's order only.
    void intersect(std::span<const Ray> rays, std::span<Hit> hits, Coherence coherence = Coherence::none) const;
    /// out[i] = 1 where anything lies between t_min and t_max.
    void occluded(std::span<const Ray> rays, std::span<uint8_t> out) const;

    struct Impl;

  private:
    std::unique_ptr<Impl> impl_;
};

}  // namespace eclat
