// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Filling irradiance caches without a camera, for given points or for all diffuse surfaces.
//
// Departures   Without a camera there are no pixels to bound a record's radius. A share of the distance that the record
//              sees stands for one (`pixel_share`), as if it was looked at from there; the bounds in pixels keep their
//              meaning.
// Held to      tests/methods/test_solve_points.py

#include "methods/irradiance_cache/solve_points.h"

#include <algorithm>
#include <bit>

#include "base/parallel.h"

namespace eclat {

namespace {

constexpr size_t first_pass = 64;  // candidates of the coarsest pass; each later pass doubles their total number

constexpr size_t far_round = 512;  // number of far candidates that are tried together

using Candidates = std::vector<Candidate>;

/// Points at which irradiance is needed, on each side that reflects or transmits it.
Candidates diffuse_candidates(const SurfacePoints& surface, const PlacesPart& part, uint32_t seed) {
    Candidates out;
    for (const auto& [hit, key] : surface.spread(part, seed)) {
        Candidates wanted;
        surface.for_each_side(
            hit, [&](const SurfacePoint& point, Vec3 wo) { add_sides(point, wo, Candidate(point, 0.0f, 0), wanted); });
        Candidates sides;  // each side once, although both sides of a curtain need both
        for (const Candidate& c : wanted)
            if (std::ranges::none_of(sides, [&](const Candidate& o) { return dot(o.normal, c.normal) > 0; }))
                sides.push_back(c);
        for (Candidate& c : sides) {
            c.key = hash(key, static_cast<uint32_t>(out.size() & 1));
            out.push_back(c);
        }
    }
    return out;
}

}  // namespace

void solve_at_points(const World& world, std::span<const PointNormal> points, const IrradianceCacheOptions& options,
                     SolvedCaches& caches, Progress& progress) {
    constexpr int retries = 3;  // later records may shrink the record that served a point
    caches = empty_caches(options);
    RecordSolve solve{caches};
    size_t coarsest = 1;
    while (points.size() / coarsest > first_pass) coarsest *= 2;
    const auto passes = static_cast<uint64_t>(std::bit_width(coarsest));
    progress.begin(far_passes(options) + passes + retries);

    const auto every = [&](size_t step, size_t first) {
        Candidates out;
        for (size_t i = first; i < points.size(); i += step)
            out.emplace_back(bare_point(world, points[i]), 0.0f, static_cast<uint32_t>(i));
        return out;
    };
    solve_far(world, every(1, 0), options, solve, progress);
    // Each pass takes the points halfway between those of all previous passes.
    add_near(world, every(coarsest, 0), options, solve, progress);
    for (size_t step = coarsest; step > 1; step /= 2) add_near(world, every(step, step / 2), options, solve, progress);
    for (int retry = 0; retry < retries; ++retry) add_near(world, every(1, 0), options, solve, progress);
}

uint64_t surface_passes(const IrradianceCacheOptions& options, int sweeps) {
    return far_rounds(options) + static_cast<uint64_t>(sweeps) * most_place_passes;
}

uint32_t far_rounds(const IrradianceCacheOptions& options) {
    const bool wants_far = options.max_depth < 0 && !options.far_photons;
    const size_t count = wants_far ? static_cast<size_t>(options.far_records) : 0;
    return static_cast<uint32_t>((count + far_round - 1) / far_round);
}

void add_far_everywhere(const World& world, const SurfacePoints& surface, uint32_t round,
                        const IrradianceCacheOptions& options, RecordSolve& solve, Progress& progress) {
    const PlacesPart all{most_place_passes + round, far_round, 0, far_round};
    add_far(world, diffuse_candidates(surface, all, options.seed), options, solve, progress);
}

void solve_far_everywhere(const World& world, const SurfacePoints& surface, const IrradianceCacheOptions& options,
                          RecordSolve& solve, Progress& progress) {
    for (uint32_t round = 0; round < far_rounds(options); ++round)
        add_far_everywhere(world, surface, round, options, solve, progress);
}

PassCounts add_near_at_places(const World& world, const SurfacePoints& surface, const PlacesPart& part,
                              const IrradianceCacheOptions& options, RecordSolve& solve, Progress& progress) {
    const auto candidates = diffuse_candidates(surface, part, options.seed);
    return {candidates.size(), add_near(world, candidates, options, solve, progress)};
}

void solve_near_everywhere(const World& world, const SurfacePoints& surface, const IrradianceCacheOptions& options,
                           RecordSolve& solve, Progress& progress) {
    double_places([&](uint32_t pass, size_t count) {
        return add_near_at_places(world, surface, {pass, count, 0, count}, options, solve, progress);
    });
}

void solve_everywhere(const World& world, const IrradianceCacheOptions& options, SolvedCaches& caches,
                      Progress& progress) {
    caches = empty_caches(options);
    const SurfacePoints surface(world);
    if (surface.empty()) return;
    RecordSolve solve{caches};
    progress.begin(surface_passes(options, 1));
    solve_far_everywhere(world, surface, options, solve, progress);
    solve_near_everywhere(world, surface, options, solve, progress);
}

std::vector<PointNormal> points_everywhere(const World& world, size_t count, uint32_t seed) {
    constexpr uint32_t no_pass = 1u << 20;
    const SurfacePoints surface(world);
    std::vector<PointNormal> out;
    if (surface.empty()) return out;
    for (const Candidate& c : diffuse_candidates(surface, {no_pass, count, 0, count}, seed))
        out.push_back({c.position, c.normal});
    return out;
}

}  // namespace eclat
