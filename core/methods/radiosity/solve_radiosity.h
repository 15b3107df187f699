// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Radiosity of a scene. Front door of this folder: patches, links and the equation are in the files beside it.

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"
#include "methods/radiosity/patches.h"
#include "transport/world.h"

namespace eclat {

enum class RadiositySolver : uint8_t { gathering, shooting };

struct RadiosityOptions {
    float patch_size = 0;      // longest edge of a patch, metres; 0: such that there are about `patches`
    size_t patches = 20000;    // after all refinements, besides one for each side
    int refinements = 2;       // times that patches are divided where light changes fast
    float tolerance = 0.003f;  // of a link's irradiance, in units of the mean radiosity, or more: links are bounded
    RadiositySolver solver = RadiositySolver::gathering;
    int bounces = -1;  // of light that is counted, from lights to patches: 1 is direct light; −1 unlimited
    uint32_t seed = 0;
    int threads = 0;
};

struct SolvedPatch {
    PatchName name;
    Color direct, total;    // irradiance, W m⁻²
    Color albedo, emitted;  // mean albedo; radiosity of its own light, W m⁻²
    Color transmitted;      // radiosity of what it lets through from its other side, W m⁻²
    bool unknown = false;   // its light, somewhere on it: it lies inside a solid, or a wall parts it
};

struct SolvedRadiosity {
    std::vector<SolvedPatch> patches;  // by triangle, side and path
    uint64_t links = 0;
    uint64_t sweeps = 0;      // of the solution, or steps of shooting
    float residual = 0;       // power not reflected yet, relative to all
    float closure_error = 0;  // of the sums of form factors before they were balanced: mean of |sum − closure|, by flux
    float tolerance = 0;      // that held: the one asked for, or more where that takes too many links
};

/// The corners of patches in the order of their triangle, from their names.
std::vector<std::array<Vec3, 3>> patch_corners(const Geometry& geometry, std::span<const SolvedPatch> patches);

SolvedRadiosity solve_radiosity(const World& world, const RadiosityOptions& options, Progress& progress);

}  // namespace eclat
