// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Rays against triangles, in batches. Straight-through opacity is decided here, so that masked leaves are invisible to
// whoever asks: a candidate hit counts with probability `opacity`, drawn from a hash of the ray and the hit.
// Culled backs are also decided here: single-sided surfaces of glTF are invisible to rays that come from behind [glTF
// 2.0, 3.9.6]. Rays run in the direction of view: from the camera, and from points towards the lights. All estimates of
// radiance and irradiance use such rays, including shadow rays, so that they are consistent: a surface lights a point
// exactly if it is visible from the point. Code that follows light in the opposite direction, such as photon tracing,
// must test whether the point of arrival sees the origin.

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

/// The share of light along `direction` that passes straight through a pane at the barycentric weights (u, v).
using PaneFunction = std::function<Color(uint32_t triangle, float u, float v, Vec3 direction)>;

/// Rays that a camera sends are coherent, and they pass through what is hidden from cameras.
enum class Coherence { none, camera };

/// Whether rays pass through culled backs or hit them.
enum class Backs : uint8_t { culled, met };

/// The tests that decide whether a ray hits a triangle.
struct Sieve {
    bool translucent = false;  // depends on its opacity
    bool back_culled = false;  // depends on the side from which the ray comes
    bool pane = false;         // shadow rays pass straight through it
    bool hidden_from_camera = false;
};

class Intersector {
  public:
    struct Triangle {
        uint32_t v[3];
    };

    /// `sieves[i]` belongs to triangle i. `vertices` must outlive this object, and its memory must extend one element
    /// beyond its end, because wide loads read past the last element.
    Intersector(std::span<const Vec3> vertices, std::span<const Triangle> triangles, std::span<const Sieve> sieves,
                OpacityFunction opacity, PaneFunction pane = {});
    ~Intersector();
    Intersector(const Intersector&) = delete;

    /// Finds the closest hit of each ray. Rays are traced eight at a time in their order, so the results depend only on
    /// the order of the batch. A ray with components that are NaN or beyond 1.8e18 hits nothing, and no light passes
    /// along it.
    void intersect(std::span<const Ray> rays, std::span<Hit> hits, Coherence coherence = Coherence::none,
                   Backs backs = Backs::culled) const;
    /// Sets out[i] to 1 if ray i hits anything between t_min and t_max.
    void occluded(std::span<const Ray> rays, std::span<uint8_t> out, Backs backs = Backs::culled) const;
    /// Sets out[i] to the transmittance of panes and partly opaque surfaces between t_min and t_max; it is black if
    /// anything else is hit.
    void transmitted(std::span<const Ray> rays, std::span<Color> out, Backs backs = Backs::culled) const;

    /// Whether any triangle's back is culled.
    bool culls_backs() const;

    struct Impl;

  private:
    std::unique_ptr<Impl> impl_;
};

}  // namespace eclat
