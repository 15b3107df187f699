// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The materials of patches, and the light that they receive from lights that are not patches.

#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/progress.h"
#include "methods/radiosity/patches.h"
#include "transport/world.h"

namespace eclat {

struct PatchSurface {
    Color albedo;  // mean over the patch, as if it reflected diffusely all that it reflects; without transmission
    Color transmittance;  // share of the other side's irradiance that it lets through diffusely, mean over the patch
    Color emitted;        // radiosity of its own light, π L_e, W m⁻²
    Color lights;         // irradiance of the exposed part from points, spots, suns and the environment, W m⁻²
    float opacity = 1;
    float closure = 1;        // share of its exposed part's form factors that other patches have: the rest is sky
    float closure_error = 0;  // two deviations of that; none where no ray met anything else

    // What stands on a patch hides parts of it from each other: it is cut. These parts may have light of their own, and only
    // that of the largest is known. It is what is called exposed; the rest takes no light and passes none on.
    bool cut = false;
    float exposed = 1;  // share of the patch that is, and does not lie inside a solid
    static constexpr size_t most_points = 12;
    uint8_t point_count = 0;  // of exposed points, where not all of it is
    std::array<std::array<uint8_t, 2>, most_points>
        points{};  // barycentric weights of its second and third corner, over 255

    /// Hardly anything of it is exposed.
    bool unknown() const { return point_count == 0 && exposed < 1; }

    /// Barycentric weights of a point: `anywhere`, or one that is exposed, chosen by `u`.
    Vec2 exposed_point(Vec2 anywhere, float u) const {
        if (point_count == 0) return anywhere;
        const auto& p =
            points[std::min(static_cast<size_t>(u * static_cast<float>(point_count)), point_count - size_t(1))];
        return {static_cast<float>(p[0]) / 255, static_cast<float>(p[1]) / 255};
    }
};

struct SurfaceOptions {
    int light_samples = 64;  // of lights that are no patches, per patch
    int closure_rays = 32;   // that look for other patches
    uint32_t seed = 0;
    int threads = 0;
};

/// Fills `surfaces` (one a node) at `patches`.
void measure_surfaces(const World& world, const PatchTree& tree, std::span<const uint32_t> patches,
                      const SurfaceOptions& options, std::span<PatchSurface> surfaces, Progress& progress);

/// The hit on a triangle at a point of it.
Hit hit_on_triangle(const Geometry& geometry, uint32_t triangle, Vec3 position);

}  // namespace eclat
