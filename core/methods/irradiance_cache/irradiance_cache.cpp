// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Irradiance caching: indirect light on diffuse surfaces is computed at few points and interpolated between them. Irradiance
// changes slowly where the surrounding surfaces are far away, so records may be sparse there and must be dense in corners.
// For a picture, the candidates are the surface points that its pixels see, directly or by way of mirrors. They are
// processed from coarse to fine: first every 32nd pixel, then the three points that halve the spacing of the lattice,
// and so on, until the spacing is at most the smallest radius of a record. This file has only the order of the passes;
// each step has its own file:
//
//   one gather                  records/gather.cpp, hemisphere/hemisphere.cpp     [Ward88], [WardHeckbert92]
//   the radius of a record      records/spacing.cpp                               [Schwarzhaupt12]
//   a pass                      records/record_passes.cpp                         [Tabellion04]
//   interpolation, clamping     records/record_cache.cpp, records/weight.h        [WardHeckbert92], [Krivanek06]
//
// Symbol       name here               meaning                                                     unit
//   s          step                    lattice constant of a pass: pixels between its candidates   pixel
//   s_0        coarsest                that of the first pass                                      pixel
//   R−         options.least_pixels    least radius of a record; the last s is no larger           pixel
//
// Departures   Filled in coarse-to-fine passes against a frozen cache instead of on demand, so that it does not depend
//              on timing. Gather rays end in a second, coarse cache of far points wherever that is not too near.
// Bias         Interpolation blurs indirect shadows narrower than a record's radius.
// Held to      tests/methods/test_irradiance_cache.py

#include "methods/irradiance_cache/irradiance_cache.h"

#include <cmath>

#include "records/camera_chains.h"

namespace eclat {

namespace {

// This is the distance in pixels between the candidates of the first pass, chosen by judgement: the power of two just
// below the largest radius of a record (40 pixels by default). A larger distance would give few records, and with a
// smaller one large records overlap.
constexpr float coarsest = 32;

/// Returns the distance in pixels between the candidates of the last passes, which is at most the radius of the
/// smallest records.
float finest_step(const IrradianceCacheOptions& options) {
    float step = coarsest;
    while (step > options.least_pixels) step /= 2;
    return step;
}

/// Returns the number of rows of the gathers of a pass, divided by the usual number. A new record serves a part of the
/// picture about as wide as the step of the pass, so its noise is visible in step² pixels. For a given total of rays,
/// the sum over records of that area times the variance, which is proportional to N^{-3/2} (records/record_passes.cpp),
/// is least if N^{5/2} ∝ step², so M ∝ step^{2/5}. The step with the usual number of rows and the bounds are tuned: in
/// `living-room` at 640 × 360 the denoised error decreases from 3.9 to 3.5 % with 3 % more rays; factors below 0.7 in
/// the last passes undo that.
float rows_share(float step) {
    constexpr float usual_step = 2, fewest = 0.7f, most = 2;
    return clamp(std::pow(step / usual_step, 0.4f), fewest, most);
}

}  // namespace

std::vector<Vec2> lattice(const Camera& camera, float step, int kind) {
    std::vector<Vec2> out;
    const auto dx = static_cast<float>(kind & 1), dy = static_cast<float>(kind >> 1);
    const float period = kind == 0 ? step : 2 * step;
    for (float y = 0.5f + dy * step; y < static_cast<float>(camera.height); y += period)
        for (float x = 0.5f + dx * step; x < static_cast<float>(camera.width); x += period) out.push_back({x, y});
    return out;
}

std::vector<Candidate> camera_candidates(const World& world, const Camera& camera, std::span<const Vec2> pixels,
                                         const IrradianceCacheOptions& options, Progress& progress,
                                         const MarkCached& mark) {
    return follow_chains<Candidate>(world, camera, pixels, Stream::camera_chains, options, progress,
                                    [&](SeenVertex& vertex, std::vector<Candidate>& found) {
                                        Bsdf& bsdf = vertex.point.bsdf;
                                        add_sides(vertex.point, vertex.wo, vertex.candidate(), found);
                                        if (!mark) return LobeSet::glossy;
                                        mark(vertex.point, vertex.wo);
                                        bsdf.set_cached(LobeSet::matte);
                                        return LobeSet::uncached;
                                    });
}

void for_each_lattice(Cameras cameras, const IrradianceCacheOptions& options, const LatticePass& pass) {
    const auto of_all = [&](float step, int kind) {
        for (size_t i = 0; i < cameras.size(); ++i) pass(i, lattice(cameras[i], step, kind), step);
    };
    of_all(coarsest, 0);
    for (float step = coarsest / 2; step >= finest_step(options); step /= 2)
        for (int kind : {1, 2, 3}) of_all(step, kind);
}

uint64_t camera_passes(const IrradianceCacheOptions& options, size_t cameras, int sweeps) {
    const auto sweep = 1 + 3 * static_cast<uint64_t>(std::ilogb(coarsest / finest_step(options)));
    return far_passes(options) + static_cast<uint64_t>(sweeps) * sweep * cameras;
}

void set_camera(Candidate& candidate, size_t camera) {
    if (camera == 0) return;
    const auto index = static_cast<uint32_t>(camera);
    candidate.key = hash(candidate.key, index);
    if (candidate.region != 0) candidate.region = hash(candidate.region, index);
}

void solve_far_for_cameras(const World& world, Cameras cameras, const IrradianceCacheOptions& options,
                           RecordSolve& solve, Progress& progress) {
    // This is the distance in pixels between the points from which far candidates are searched, chosen by judgement: a
    // picture of 512 × 512 has 1024 such points, so that 8000 rays start evenly from all visible surfaces. A smaller
    // distance would only take more camera rays. Several cameras share about that number of points.
    constexpr float far_sources = 16;
    const float step = std::round(far_sources * std::sqrt(static_cast<float>(cameras.size())));
    std::vector<Candidate> sources;
    for (size_t i = 0; i < cameras.size(); ++i)
        for (Candidate& c : camera_candidates(world, cameras[i], lattice(cameras[i], step, 0), options, progress)) {
            set_camera(c, i);
            sources.push_back(c);
        }
    solve_far(world, sources, options, solve, progress);
}

void solve_near_for_cameras(const World& world, Cameras cameras, const IrradianceCacheOptions& options,
                            RecordSolve& solve, Progress& progress, const MarkCached& mark) {
    solve.read_cells = true;
    for_each_lattice(cameras, options, [&](size_t index, std::span<const Vec2> pixels, float step) {
        add_near_of_lattice(world, cameras[index], {pixels, step, index}, options, solve, progress, mark);
    });
}

void add_near_of_lattice(const World& world, const Camera& camera, const LatticePart& part,
                         const IrradianceCacheOptions& options, RecordSolve& solve, Progress& progress,
                         const MarkCached& mark) {
    auto candidates = camera_candidates(world, camera, part.pixels, options, progress, mark);
    for (Candidate& c : candidates) set_camera(c, part.camera);
    add_near(world, candidates, options, solve, progress, rows_share(part.step));
}

void solve_irradiance_cache(const World& world, Cameras cameras, const IrradianceCacheOptions& options,
                            SolvedCaches& caches, Progress& progress) {
    caches = empty_caches(options);
    RecordSolve solve{caches};
    progress.begin(camera_passes(options, cameras.size(), 1));
    solve_far_for_cameras(world, cameras, options, solve, progress);
    solve_near_for_cameras(world, cameras, options, solve, progress);
}

CachedIrradiance read_near(const SolvedCaches& caches) {
    return [&caches](const SurfacePoint& point, float) {
        return caches.near.interpolate(point.position, point.normal_towards_shading(), point.frame.n);
    };
}

}  // namespace eclat
