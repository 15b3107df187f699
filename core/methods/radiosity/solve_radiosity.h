// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The radiosity of a scene. This is the interface of the folder; patches, links and the equation are in the other
// files.

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
    float patch_size = 0;    // longest edge of a patch, m; 0 chooses it so that there are about `patches`
    size_t patches = 20000;  // number of patches after all refinements, in addition to one for each side
    int refinements = 2;     // number of times that patches are divided where light changes quickly
    /// Tolerated error of a link relative to the mean radiosity, which is increased if there are too many links.
    float tolerance = 0.003f;
    RadiositySolver solver = RadiositySolver::gathering;
    int bounces = -1;  // greatest number of edges from lights to patches: 1 is direct light; −1 means unlimited
    uint32_t seed = 0;
    int threads = 0;
};

struct SolvedPatch {
    PatchName name;
    Color direct, total;    // irradiance, W m⁻²
    Color albedo, emitted;  // mean albedo; radiosity of the emitted light, W m⁻²
    Color transmitted;      // radiosity of the light transmitted from the other side, W m⁻²
    bool unknown = false;  // whether light on a part of it is unknown: inside a solid, or behind a wall that divides it
};

struct SolvedRadiosity {
    std::vector<SolvedPatch> patches;  // in the order of triangle, side and path
    uint64_t links = 0;
    uint64_t sweeps = 0;      // number of sweeps of gathering or steps of shooting
    float residual = 0;       // power that has not been reflected yet, relative to the total
    float closure_error = 0;  // mean of |sum of form factors − closure| before balancing, weighted by flux
    float tolerance = 0;      // tolerance that was used: the requested one, or more if that takes too many links
};

/// Computes the corners of patches, in the order of their triangles, from their names.
std::vector<std::array<Vec3, 3>> patch_corners(const Geometry& geometry, std::span<const SolvedPatch> patches);

SolvedRadiosity solve_radiosity(const World& world, const RadiosityOptions& options, Progress& progress);

}  // namespace eclat
