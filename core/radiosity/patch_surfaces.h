// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// What patches are made of and what falls on them from lights that are no patches.

#pragma once

#include <span>
#include <vector>

#include "base/progress.h"
#include "radiosity/patches.h"
#include "transport/world.h"

namespace eclat {

struct PatchSurface {
    Color albedo;   // mean over the patch, as if it reflected diffusely all that it reflects; without transmission
    Color emitted;  // radiosity of its own light, π L_e, W m⁻²
    Color lights;   // irradiance of the exposed part from points, spots, suns and the environment, W m⁻²
    float opacity = 1;
    float closure = 1;        // share of its exposed part's form factors that other patches have: the rest is sky
    float closure_error = 0;  // two deviations of that; none where no ray met anything else

    bool cut = false;  // something stands on it that hides parts of it from each other

    /// Its light is not known: hardly anything of it is exposed, or a wall parts it, whose two sides have light of their own
    /// and would share it. It takes none and passes none on.
    bool unknown() const { return exposed < 0.25f || cut; }
    float exposed = 1;  // share of the patch that does not lie inside a solid
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
