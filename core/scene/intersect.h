// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Rays against triangles, in batches. Straight-through opacity is decided here, so that masked leaves are invisible to
// whoever asks: a candidate hit counts with probability `opacity`, drawn from a hash of the ray and the hit.
//
// So are culled backs: single-sided surfaces of glTF are not there for rays that come from behind [glTF 2.0, 3.9.6]. A ray
// runs the way one looks: from eyes, and from points towards what lights them. All estimates of radiance and irradiance
// rest on such rays, shadow rays included, so that they agree: what is seen is what lights. Who follows light the other
// way has to ask whether where it arrives sees where it came from.

#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "base/color.h"
#include "base/vec.h"
#include "scene/ray.h"

namespace eclat {

/// Opacity in [0, 1] of a triangle at barycentric weights (u, v).
using OpacityFunction = std::function<float(uint32_t triangle, float u, float v)>;

/// What a pane lets straight through of light that runs along `direction`, at barycentric weights (u, v).
using PaneFunction = std::function<Color(uint32_t triangle, float u, float v, Vec3 direction)>;

enum class Coherence { none, camera };

/// Whether rays pass through culled backs, or meet them.
enum class Backs : uint8_t { culled, met };

/// What rays have to ask of a triangle before they meet it.
struct Sieve {
    bool translucent = false;  // its opacity
    bool back_culled = false;  // from which side they come
    bool pane = false;         // what it lets straight through, where light is asked for
};

class Intersector {
  public:
    struct Triangle {
        uint32_t v[3];
    };

    /// `sieves[i]` is of triangle i. `vertices` is borrowed, must outlive this object, and must own one element more than
    /// it shows (wide loads read past the last).
    Intersector(std::span<const Vec3> vertices, std::span<const Triangle> triangles, std::span<const Sieve> sieves,
                OpacityFunction opacity, PaneFunction pane = {});
    ~Intersector();
    Intersector(const Intersector&) = delete;

    /// Closest hit of each ray. Rays are taken eight at a time in order, so results depend on a batch's order only.
    /// A ray with NaN, or with components beyond 1.8e18, meets nothing, and no light passes along it.
    void intersect(std::span<const Ray> rays, std::span<Hit> hits, Coherence coherence = Coherence::none,
                   Backs backs = Backs::culled) const;
    /// out[i] = 1 where anything lies between t_min and t_max.
    void occluded(std::span<const Ray> rays, std::span<uint8_t> out, Backs backs = Backs::culled) const;
    /// out[i] = what panes and partial opacity let straight through between t_min and t_max; black where more lies there.
    void transmitted(std::span<const Ray> rays, std::span<Color> out) const;

    /// Whether any triangle's back is culled.
    bool culls_backs() const;

    struct Impl;

  private:
    std::unique_ptr<Impl> impl_;
};

}  // namespace eclat
