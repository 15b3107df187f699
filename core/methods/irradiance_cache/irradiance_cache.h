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

/// Marks the lobes of a point that another cache serves, for light that leaves towards `wo`, which is in the point's
/// frame.
using MarkCached = std::function<void(SurfacePoint& point, Vec3 wo)>;

/// The cameras whose pictures share one cache, such as those along a path. Each pass visits all of them, one after the
/// other, before the next finer pass begins, and a camera's candidates are looked up among the records of those before
/// it. So all pictures want the same records, and none has a seam against the next.
using Cameras = std::span<const Camera>;

/// Fills both caches for the surfaces that `cameras` see. After an exception or a cancellation, the caches hold the
/// passes that were finished. `progress` counts passes.
void solve_irradiance_cache(const World& world, Cameras cameras, const IrradianceCacheOptions& options,
                            SolvedCaches& caches, Progress& progress);

// These are the steps of the solve, between which another cache can be filled in a separate sweep.

/// Returns the number of passes of a solve for that number of cameras with that number of sweeps over the pixels.
uint64_t camera_passes(const IrradianceCacheOptions& options, size_t cameras, int sweeps);
/// Fills the far cache.
void solve_far_for_cameras(const World& world, Cameras cameras, const IrradianceCacheOptions& options,
                           RecordSolve& solve, Progress& progress);
/// Fills the near cache in one sweep. Chains do not follow lobes that `mark` marks.
void solve_near_for_cameras(const World& world, Cameras cameras, const IrradianceCacheOptions& options,
                            RecordSolve& solve, Progress& progress, const MarkCached& mark = {});

/// Pixel centres (x, y) that are `step` pixels apart, of the camera with that index.
struct LatticePart {
    std::span<const Vec2> pixels;
    float step = 0;
    size_t camera = 0;
};

/// Performs one pass of that sweep, with the candidates that the pixels of `part` see.
void add_near_of_lattice(const World& world, const Camera& camera, const LatticePart& part,
                         const IrradianceCacheOptions& options, RecordSolve& solve, Progress& progress,
                         const MarkCached& mark = {});

/// Returns the pixel centres, or positions between them, of one pass: the three new points of each lattice cell of `2 ·
/// step` by `kind` from 1 to 3, or all points of the lattice for the kind 0. `step` is a power of two.
std::vector<Vec2> lattice(const Camera& camera, float step, int kind);

/// Makes the random numbers and the region of a candidate of the camera with the given index its own. Those of the first
/// camera stay as they are.
void set_camera(Candidate& candidate, size_t camera);

/// A pass over some pixel centres (x, y) of the camera with the given index, `step` pixels apart.
using LatticePass = std::function<void(size_t camera, std::span<const Vec2> pixels, float step)>;

/// Calls `pass` for pixel centres from coarse to fine, so that each pixel of each camera occurs once, and all cameras in
/// turn at each fineness. If records may be smaller than pixels, positions between the centres follow, because an edge
/// inside a pixel would otherwise never have records on both sides.
void for_each_lattice(Cameras cameras, const IrradianceCacheOptions& options, const LatticePass& pass);

/// The number of paths that continue from a visible vertex that no record serves. A single path would appear as a
/// bright dot among pixels without noise. In a furnished room, two paths reach the same noise in 0.92 of the time of
/// one path, and four take 1.04 of it; in two halls with few such pixels four would be best. With more than one light
/// sample or glossy direction at such a vertex, a denoised picture has a larger error after the same time.
constexpr int cached_miss_paths = 2;

/// Returns the options of paths that read the caches, with `near` at vertices that the camera sees.
CachedIrradiance read_near(const SolvedCaches& caches);

/// Returns the diffuse points that pixels with the centres (x, y) see, directly or by way of mirrors and glossy lobes,
/// except lobes that `mark` marks.
std::vector<Candidate> camera_candidates(const World& world, const Camera& camera, std::span<const Vec2> pixels,
                                         const IrradianceCacheOptions& options, Progress& progress,
                                         const MarkCached& mark = {});

}  // namespace eclat
