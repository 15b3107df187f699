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

/// Fills `caches`, which must be empty, with records that serve each point on the side of its normal. After an
/// exception or a cancellation, they hold the passes that were finished. `progress` counts passes.
void solve_at_points(const World& world, std::span<const PointNormal> points, const IrradianceCacheOptions& options,
                     SolvedCaches& caches, Progress& progress);

/// Fills the caches for all diffuse surfaces, on each side that reflects. Candidates are distributed evenly over the
/// area, and their number is doubled until the records serve almost all new ones.
void solve_everywhere(const World& world, const IrradianceCacheOptions& options, SolvedCaches& caches,
                      Progress& progress);

// These are the steps of the solve, between which another cache can be filled in a separate sweep. `surface` must not
// be empty.

/// Returns the greatest number of passes of a solve with that number of sweeps over the surfaces.
uint64_t surface_passes(const IrradianceCacheOptions& options, int sweeps);
/// Returns the number of rounds of far records.
uint32_t far_rounds(const IrradianceCacheOptions& options);
void add_far_everywhere(const World& world, const SurfacePoints& surface, uint32_t round,
                        const IrradianceCacheOptions& options, RecordSolve& solve, Progress& progress);
void solve_far_everywhere(const World& world, const SurfacePoints& surface, const IrradianceCacheOptions& options,
                          RecordSolve& solve, Progress& progress);
/// Makes near records at some points of a pass.
PassCounts add_near_at_places(const World& world, const SurfacePoints& surface, const PlacesPart& part,
                              const IrradianceCacheOptions& options, RecordSolve& solve, Progress& progress);
void solve_near_everywhere(const World& world, const SurfacePoints& surface, const IrradianceCacheOptions& options,
                           RecordSolve& solve, Progress& progress);

/// Returns about `count` points that are evenly distributed over the same surfaces and differ from those of a solve.
std::vector<PointNormal> points_everywhere(const World& world, size_t count, uint32_t seed);

}  // namespace eclat
