// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Irradiance caching: indirect light on diffuse surfaces is computed at few points and interpolated between them.

#pragma once

#include <functional>
#include <span>
#include <vector>

#include "records/record_passes.h"
#include "scene/camera.h"

namespace eclat {

/// Marks the lobes of a point that another cache answers for, for light that leaves towards `wo` (in the point's frame).
using MarkCached = std::function<void(SurfacePoint& point, Vec3 wo)>;

/// Fills both caches for what `camera` sees. Whatever stops it (an exception, a cancelled progress) leaves the passes that
/// were finished. `progress` counts passes.
void solve_irradiance_cache(const World& world, const Camera& camera, const IrradianceCacheOptions& options,
                            SolvedCaches& caches, Progress& progress);

// Its steps, between which another cache can be filled in a sweep of its own:

/// Passes of a solve with so many sweeps over the pixels.
uint64_t camera_passes(const IrradianceCacheOptions& options, int sweeps);
/// All of the far cache.
void solve_far_for_camera(const World& world, const Camera& camera, const IrradianceCacheOptions& options,
                          RecordSolve& solve, Progress& progress);
/// All of the near cache, in one sweep. Chains do not follow lobes that `mark` marks.
void solve_near_for_camera(const World& world, const Camera& camera, const IrradianceCacheOptions& options,
                           RecordSolve& solve, Progress& progress, const MarkCached& mark = {});

/// `pass(pixels)` for pixel centres (x, y) from coarse to fine: each pixel once in all. Where records may be smaller than
/// pixels, also for places between them, or what changes inside of a pixel would never get a record on both sides.
void for_each_lattice(const Camera& camera, const IrradianceCacheOptions& options,
                      const std::function<void(std::span<const Vec2>, float step)>& pass);

/// Paths that go on from a vertex that the camera sees where no record serves it: beside pixels without noise a single one
/// would show as a bright dot. In a furnished room two reach the same noise in 0.92 of one's time, and four need 1.04; in two
/// halls with few such pixels four would be best. More light samples or glossy directions at such a vertex than one leave more
/// error in a denoised picture of the same time.
constexpr int cached_miss_paths = 2;

/// How paths read the cache: `near` at vertices seen from the camera.
CachedIrradiance read_near(const SolvedCaches& caches);

/// Diffuse points that pixels see, at pixel centres (x, y), after mirrors and glossy bounces where there are any; not after
/// those that `mark` marks.
std::vector<Candidate> camera_candidates(const World& world, const Camera& camera, std::span<const Vec2> pixels,
                                         const IrradianceCacheOptions& options, Progress& progress,
                                         const MarkCached& mark = {});

}  // namespace eclat
