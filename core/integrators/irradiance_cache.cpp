// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Irradiance caching: indirect light on diffuse surfaces, computed at few points, interpolated between them.
// Irradiance changes slowly where surfaces are far away, so records may be sparse there and must be dense in corners.
//
// References   [Ward88], [WardHeckbert92], [Tabellion04], [Krivanek06], [Schwarzhaupt12]
//
// Symbol       name here            meaning                                      unit
//   E_i        record.irradiance    irradiance at record i                       W m⁻²
//   ℓ_i        record.distance      the length that its radius follows, see cache/spacing.cpp   m
//   M, N       rows, columns        rows and columns of a gather                 1
//
// Departures   Filled in coarse-to-fine passes against a frozen cache instead of on demand, so that it does not depend
//              on timing. Gather rays end in a second, coarse cache of far points wherever that is not too near.
// Bias         Interpolation blurs indirect shadows narrower than a record's radius.
// Held to      tests/integrators/test_irradiance_cache.py

#include "integrators/irradiance_cache.h"

#include <cmath>

#include "base/parallel.h"

namespace eclat {

namespace {

constexpr uint32_t chain_stream = 4;
constexpr float coarsest = 32;  // pixels between the candidates of the first pass

/// Pixel centres, or places between them, of one class of a lattice: the three finer points of each cell of `2 · step`, or
/// all of the first. `step`: a power of two.
std::vector<Vec2> lattice(const Camera& camera, float step, int kind) {
    std::vector<Vec2> out;
    const auto dx = static_cast<float>(kind & 1), dy = static_cast<float>(kind >> 1);
    const float period = kind == 0 ? step : 2 * step;
    for (float y = 0.5f + dy * step; y < static_cast<float>(camera.height); y += period)
        for (float x = 0.5f + dx * step; x < static_cast<float>(camera.width); x += period) out.push_back({x, y});
    return out;
}

/// Pixels between the candidates of the last passes: one, or fewer where records may be smaller than that.
float finest_step(const IrradianceCacheOptions& options) {
    float step = 1;
    while (step > options.least_pixels) step /= 2;
    return step;
}

/// Where a place in the picture, behind so many mirrors, is weighed: a square of sixteen pixels. In space, the cells of a grid
/// would not be the same in a scene that was scaled or turned. 0 for the places of coarser passes, which say nothing of single
/// pixels, and for those between pixels, where records were asked for that are smaller.
uint32_t region_of(Vec2 at, int edge) {
    constexpr uint32_t side = 16, most_columns = 1 << 14;
    const uint32_t x = static_cast<uint32_t>(at.x), y = static_cast<uint32_t>(at.y);
    const bool between = at.x != static_cast<float>(x) + 0.5f || at.y != static_cast<float>(y) + 0.5f;
    if (between || (x % 2 == 0 && y % 2 == 0)) return 0;
    return 1 + static_cast<uint32_t>(edge) + 4 * (x / side + most_columns * (y / side));
}

/// Of a place in the picture, as random numbers are keyed: pixel centres by their pixel.
uint32_t key_of(Vec2 at, int edge) {
    const auto part = [](float x) { return static_cast<uint32_t>(8 * (x - std::floor(x))) ^ 4u; };
    const uint32_t parts = part(at.x) | part(at.y) << 3;
    return hash(static_cast<uint32_t>(at.x), static_cast<uint32_t>(at.y), static_cast<uint32_t>(edge) | parts << 8);
}

}  // namespace

Candidate seen_candidate(const SurfacePoint& point, const Camera& camera, float length, Vec2 at, int edge) {
    Candidate out(point, camera.pixel_size_at(length), key_of(at, edge));
    out.seen = true;
    out.region = region_of(at, edge);
    return out;
}

std::vector<Candidate> camera_candidates(const World& world, const Camera& camera, std::span<const Vec2> pixels,
                                         const IrradianceCacheOptions& options, Progress& progress) {
    constexpr int longest_chain = 4;  // mirrors and glossy bounces that are followed to find candidates
    constexpr size_t block = 1024;
    std::vector<std::vector<Candidate>> found((pixels.size() + block - 1) / block);
    parallel_for(found.size(), options.threads, [&](size_t b) {
        progress.check();
        const auto some = pixels.subspan(b * block, std::min(block, pixels.size() - b * block));
        struct Chain {
            uint32_t pixel;
            float length;
        };
        std::vector<Ray> rays;
        std::vector<Chain> chains;
        for (uint32_t i = 0; i < some.size(); ++i) {
            rays.push_back(camera.ray(some[i].x, some[i].y, {0.5f, 0.5f}));
            chains.push_back({i, 0});
        }
        for (int edge = 0; edge < longest_chain && !rays.empty(); ++edge) {
            std::vector<Hit> hits(rays.size());
            world.geometry.rays().intersect(rays, hits, edge == 0 ? Coherence::camera : Coherence::none);
            progress.count_rays(rays.size());
            std::vector<Ray> next;
            std::vector<Chain> next_chains;
            for (size_t i = 0; i < rays.size(); ++i) {
                if (hits[i].missed()) continue;
                const Vec3 wo = -rays[i].direction;
                const SurfacePoint point = world.geometry.surface_point(hits[i], wo);
                const float length = chains[i].length + hits[i].t;
                const Vec3 wo_local = point.frame.to_local(wo);
                if (!is_black(point.bsdf.diffuse_albedo(wo_local))) {
                    const Vec2 at = some[chains[i].pixel];
                    found[b].push_back(seen_candidate(point, camera, length, at, edge));
                }
                const auto pixel = static_cast<uint32_t>(b * block) + chains[i].pixel;
                Sampler sampler(options.seed ^ hash(chain_stream), pixel, static_cast<uint32_t>(edge));
                const float u_lobe = sampler.next_1d();
                const auto sample = point.bsdf.sample(wo_local, u_lobe, sampler.next_2d(), LobeSet::glossy);
                if (!sample) continue;
                next.push_back(point.ray(point.frame.to_world(sample->wi)));
                next_chains.push_back({chains[i].pixel, length});
            }
            rays.swap(next);
            chains.swap(next_chains);
        }
    });
    std::vector<Candidate> out;
    for (auto& f : found) out.insert(out.end(), f.begin(), f.end());
    return out;
}

void for_each_lattice(const Camera& camera, const IrradianceCacheOptions& options,
                      const std::function<void(std::span<const Vec2>)>& pass) {
    pass(lattice(camera, coarsest, 0));
    for (float step = coarsest / 2; step >= finest_step(options); step /= 2)
        for (int kind : {1, 2, 3}) pass(lattice(camera, step, kind));
}

void solve_irradiance_cache(const World& world, const Camera& camera, const IrradianceCacheOptions& options,
                            SolvedCaches& caches, Progress& progress, const std::function<void()>& before_near) {
    constexpr int far_sources = 16;  // between the points from which the far cache is found
    caches = empty_caches(options);
    const auto sweep = 1 + 3 * static_cast<uint64_t>(std::ilogb(coarsest / finest_step(options)));
    progress.begin(far_passes(options) + (before_near ? 2 : 1) * sweep);
    solve_far(world, camera_candidates(world, camera, lattice(camera, far_sources, 0), options, progress), options,
              caches, progress);
    if (before_near) before_near();
    for_each_lattice(camera, options, [&](std::span<const Vec2> pixels) {
        add_near(world, camera_candidates(world, camera, pixels, options, progress), options, caches, progress);
    });
}

CachedIrradiance read_near(const SolvedCaches& caches) {
    return [&caches](const SurfacePoint& point, float) {
        return caches.near.interpolate(point.position, point.normal_towards_shading(), point.frame.n);
    };
}

}  // namespace eclat
