// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Filling irradiance caches without a camera, for given points or for all diffuse surfaces.

#pragma once

#include <functional>
#include <span>
#include <vector>

#include "records/record_passes.h"
#include "transport/point_irradiance.h"
#include "records/surface_points.h"

namespace eclat {

/// Fills `caches`, which must be empty, with what serves each point on the side of its normal. Whatever stops it (an
/// exception, a cancelled progress) leaves the passes that were finished. `progress` counts passes.
void solve_at_points(const World& world, std::span<const PointNormal> points, const IrradianceCacheOptions& options,
                     SolvedCaches& caches, Progress& progress);

/// The same for all diffuse surfaces, on each side that reflects: candidates are spread evenly over their area, and
/// doubled until the records serve almost all new ones.
void solve_everywhere(const World& world, const IrradianceCacheOptions& options, SolvedCaches& caches,
                      Progress& progress);

// Its steps, between which another cache can be filled in a sweep of its own; `surface` must not be empty.

/// The most passes of a solve with so many sweeps over the surfaces.
uint64_t surface_passes(const IrradianceCacheOptions& options, int sweeps);
void solve_far_everywhere(const World& world, const SurfacePoints& surface, const IrradianceCacheOptions& options,
                          RecordSolve& solve, Progress& progress);
void solve_near_everywhere(const World& world, const SurfacePoints& surface, const IrradianceCacheOptions& options,
                           RecordSolve& solve, Progress& progress);

/// Points spread evenly over the same surfaces, about `count` of them, but not those that a solve looked at.
std::vector<PointNormal> points_everywhere(const World& world, size_t count, uint32_t seed);

}  // namespace eclat
