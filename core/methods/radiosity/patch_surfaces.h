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
    Color albedo;             // mean albedo, in which all reflection counts as diffuse; without transmission
    Color transmittance;      // mean share of the irradiance of the other side that is transmitted diffusely
    Color emitted;            // radiosity of the emitted light, π L_e, W m⁻²
    Color lights;             // irradiance of the exposed part from points, spots, suns and the environment, W m⁻²
    float opacity = 1;        // share of the light that it stops, of all that arrives: less than 1 for panes and holes
    float stops = 1;          // the same without holes, so 1 but for panes, which let light straight through
    float closure = 1;        // sum of the form factors of its exposed part to other patches; the rest is sky
    float closure_error = 0;  // two standard deviations of the closure; 0 if all rays hit patches

    // Objects that stand on a patch divide it into parts that do not see each other. These parts may have different
    // light, and only that of the largest part, which is called exposed, is known. The other parts receive no light and
    // reflect none.
    bool cut = false;
    float exposed = 1;  // share of the patch that is exposed and not inside a solid
    static constexpr size_t most_points = 12;
    uint8_t point_count = 0;  // number of exposed points, if not all of the patch is exposed
    std::array<std::array<uint8_t, 2>, most_points>
        points{};  // barycentric weights of its second and third corner, over 255

    /// Returns whether hardly any of the patch is exposed.
    bool unknown() const { return point_count == 0 && exposed < 1; }

    /// Returns the barycentric weights of a point: `anywhere` if all is exposed, and otherwise an exposed point chosen
    /// by `u`.
    Vec2 exposed_point(Vec2 anywhere, float u) const {
        if (point_count == 0) return anywhere;
        const auto& p =
            points[std::min(static_cast<size_t>(u * static_cast<float>(point_count)), point_count - size_t(1))];
        return {static_cast<float>(p[0]) / 255, static_cast<float>(p[1]) / 255};
    }
};

struct SurfaceOptions {
    int light_samples = 64;  // samples per patch of lights that are no patches
    int closure_rays = 32;   // rays per patch that search for other patches
    uint32_t seed = 0;
    int threads = 0;
};

/// Computes the entries of `patches` in `surfaces`, which has one entry per node.
void measure_surfaces(const World& world, const PatchTree& tree, std::span<const uint32_t> patches,
                      const SurfaceOptions& options, std::span<PatchSurface> surfaces, Progress& progress);

/// Returns the share of light along `direction` that a surface does not let straight through, in units of `stops`, its mean
/// over directions weighted by cosine.
float stopped(const Geometry& geometry, uint32_t triangle, float stops, Vec3 position, Vec3 direction);

/// Makes a hit at a point of a triangle.
Hit hit_on_triangle(const Geometry& geometry, uint32_t triangle, Vec3 position);

}  // namespace eclat
