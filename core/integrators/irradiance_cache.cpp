// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Irradiance caching: indirect light on diffuse surfaces, computed at few points, interpolated between them.
// Irradiance changes slowly where surfaces are far away, so records may be sparse there and must be dense in corners.
//
// References   [Ward88], [WardHeckbert92], [Tabellion04], [Krivanek06]
//
// Symbol       name here            meaning                                      unit
//   E_i        record.irradiance    irradiance at record i                       W m⁻²
//   R_i        record.distance      least or harmonic mean distance to what it sees   m
//   M, N       rows, columns        rows and columns of a gather                 1
//
// Departures   Filled in coarse-to-fine passes against a frozen cache instead of on demand, so that it does not depend
//              on timing. Gather rays end in a second, coarse cache of far points wherever that is not too near.
// Bias         Interpolation blurs indirect shadows narrower than a record's radius.
// Held to      tests/integrators/test_irradiance_cache.py

#include "integrators/irradiance_cache.h"

#include <bit>

#include "base/parallel.h"
#include "cache/hemisphere.h"

namespace eclat {

namespace {

enum Stream : uint32_t { camera_stream = 1, far_stream, near_stream, chain_stream };

// A far record must not be read closer than its own radius: nearby, its neighbours' error would be seen from corners.
CachedIrradiance read_far(const RecordCache& far) {
    return [&far](const SurfacePoint& point, float distance) -> std::optional<Color> {
        float radius = 0;
        auto E = far.interpolate(point.position, point.normal_towards_shading(), point.frame.n, &radius);
        if (!E || distance < radius) return std::nullopt;
        return E;
    };
}

IrradianceRecord gather(const World& world, const Candidate& candidate, const RecordCache& far,
                        const IrradianceCacheOptions& options, uint32_t stream, int rows, Progress& progress) {
    const Vec3 p = candidate.position;
    HemisphereSamples samples;
    samples.rows = rows;
    samples.columns = columns_for(rows);
    const size_t count = size_t(samples.rows) * samples.columns;
    // A random turn of the grid, or neighbouring records would share the pattern of their error.
    const auto bits = [](float x) { return std::bit_cast<uint32_t>(x); };
    const uint32_t key = hash(hash(bits(p.x), bits(p.y), bits(p.z)), stream);
    const float turn = 2 * pi * to_unit_float(hash(key, options.seed));
    const Frame around = Frame::around(candidate.normal);
    const Vec3 u = around.u * std::cos(turn) + around.v * std::sin(turn);
    samples.frame = {u, cross(around.n, u), around.n};

    std::vector<PathRay> rays;
    rays.reserve(count);
    for (int j = 0; j < samples.rows; ++j)
        for (int k = 0; k < samples.columns; ++k) {
            const auto index = static_cast<uint32_t>(j * samples.columns + k);
            Sampler sampler(options.seed ^ hash(stream), key, index);
            const Vec3 w = cell_direction(samples.rows, samples.columns, j, k, sampler.next_2d());
            rays.push_back({candidate.ray(samples.frame.to_world(w)), sampler});
        }
    PathOptions paths;
    paths.max_depth = options.max_depth < 0 ? -1 : options.max_depth - 1;
    paths.roulette_depth = 2;
    paths.light_set = LightSet::without_environment_image;
    paths.emission_at_first_hit = false;
    if (options.max_depth < 0 && !far.records().empty()) paths.cache = read_far(far);
    std::vector<PathResult> results(count);
    trace_paths(world, rays, paths, results, progress);
    for (size_t i = 0; i < count; ++i) {
        samples.radiance.push_back(results[i].radiance);
        samples.distance.push_back(results[i].distance);
        samples.apart.push_back(stands_apart(candidate.shading_normal, rays[i].ray.direction, results[i].normal));
    }

    IrradianceRecord record;
    record.excess = take_excess(samples);
    record.position = p;
    record.normal = samples.frame.n;
    record.irradiance = irradiance(samples);
    record.rotation = rotation_gradient(samples);
    record.translation = translation_gradient(samples);
    record.distance = options.distance == Spacing::minimum ? minimum_distance(samples) : harmonic_mean_distance(samples);
    record.clearance = sector_clearance(samples);
    record.least_radius = options.least_pixels * candidate.footprint;
    record.largest_radius = options.largest_pixels * candidate.footprint;
    return record;
}

// The gradient limits the radius, and the radius, once its lower bound has raised it, the gradient [Krivanek06].
void limit_gradient(IrradianceRecord& record, const IrradianceCacheOptions& options) {
    Vec3 gradient;
    for (int c = 0; c < 3; ++c) gradient += record.translation.channel[c] * (c == 0 ? 0.2126f : c == 1 ? 0.7152f : 0.0722f);
    const float steepness = length(gradient), E = luminance(record.irradiance);
    if (options.gradient_limit && steepness > 0) record.distance = std::min(record.distance, E / steepness);
    record.radius = clamp(options.spacing * record.distance, record.least_radius, record.largest_radius);
    const float raised = options.spacing * record.distance / record.radius;
    if (raised < 1)
        for (Vec3& g : record.translation.channel) g = g * raised;
}

std::vector<Candidate> unserved(const RecordCache& cache, std::vector<Candidate> candidates, int threads) {
    std::vector<uint8_t> served(candidates.size());
    parallel_blocks(candidates.size(), 256, threads, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            served[i] = cache.serves(candidates[i].position, candidates[i].normal);
    });
    size_t kept = 0;
    for (size_t i = 0; i < candidates.size(); ++i)
        if (!served[i]) candidates[kept++] = candidates[i];
    candidates.resize(kept);
    return candidates;
}

/// Points that gather rays will meet: one cosine-distributed ray from each of a coarse grid of visible points.
std::vector<Candidate> far_candidates(const World& world, std::span<const Candidate> seen, uint32_t round,
                                      const IrradianceCacheOptions& options, Progress& progress) {
    std::vector<Ray> rays;
    for (uint32_t i = 0; i < seen.size(); ++i) {
        Sampler sampler(options.seed ^ hash(far_stream), i, round);
        rays.push_back(seen[i].ray(Frame::around(seen[i].normal).to_world(square_to_cosine_hemisphere(sampler.next_2d()))));
    }
    std::vector<Hit> hits(rays.size());
    world.geometry.rays().intersect(rays, hits);
    progress.count_rays(rays.size());
    std::vector<Candidate> out;
    for (size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].missed()) continue;
        const SurfacePoint point = world.geometry.surface_point(hits[i], -rays[i].direction);
        if (point.bsdf.has(LobeSet::diffuse)) out.emplace_back(point, 0.0f);
    }
    return out;
}

RecordCache solve_far(const World& world, std::span<const Candidate> seen, const IrradianceCacheOptions& options,
                      Progress& progress) {
    CacheOptions reading = options.cache;
    reading.relaxation = 1.4f;
    reading.rotation_gradient = false;
    RecordCache far(reading);
    if (seen.empty() || options.far_records == 0) return far;
    const RecordCache none;
    const int rounds = std::max(4, static_cast<int>(4 * options.far_records / seen.size()));
    // Far records only feed averages over whole hemispheres, so they may be coarse: never finer than a hundredth of
    // the scene.
    const float least = 0.01f * world.geometry.radius();
    for (int round = 0; round < rounds; ++round) {
        auto wanted = unserved(far, far_candidates(world, seen, static_cast<uint32_t>(round), options, progress), options.threads);
        // Thin what one round finds, in order: two points close to each other need one record.
        std::vector<Candidate> thinned;
        for (const Candidate& c : wanted) {
            bool alone = true;
            for (const Candidate& t : thinned)
                alone = alone && !(length_squared(t.position - c.position) < sqr(2 * least) &&
                                   dot(t.shading_normal, c.shading_normal) > 0.9f);
            if (alone) thinned.push_back(c);
        }
        auto records = gather_records(world, thinned, none, options, far_stream, options.far_rows, progress);
        for (auto& r : records) {
            r.least_radius = least;
            r.largest_radius = 0.2f * world.geometry.radius();
            r.radius = clamp(0.5f * r.distance, r.least_radius, r.largest_radius);
        }
        far.insert(records, 0.5f, options.threads);
        progress.advance();
    }
    return far;
}

/// Pixel centres of one class of a lattice: the three finer points of each cell of `2 · step`, or all of the first.
std::vector<Vec2> lattice(const Camera& camera, int step, int kind) {
    std::vector<Vec2> out;
    const int dx = kind & 1, dy = kind >> 1;
    const int period = kind == 0 ? step : 2 * step;
    for (int y = dy * step; y < camera.height; y += period)
        for (int x = dx * step; x < camera.width; x += period)
            out.push_back({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f});
    return out;
}

}  // namespace

std::vector<IrradianceRecord> gather_records(const World& world, std::span<const Candidate> candidates,
                                             const RecordCache& far, const IrradianceCacheOptions& options,
                                             uint32_t stream, int rows, Progress& progress) {
    return parallel_map<IrradianceRecord>(candidates.size(), options.threads, [&](size_t i) {
        progress.check();
        IrradianceRecord record = gather(world, candidates[i], far, options, stream, rows, progress);
        limit_gradient(record, options);
        return record;
    });
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
                if (!is_black(point.bsdf.diffuse_albedo(wo_local))) found[b].emplace_back(point, camera.pixel_size_at(length));
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

SolvedCaches solve_irradiance_cache(const World& world, const Camera& camera, const IrradianceCacheOptions& options,
                                    Progress& progress) {
    SolvedCaches caches{RecordCache(options.cache), {}};
    constexpr int coarsest = 32;  // pixels between the candidates of the first pass
    const auto coarse = camera_candidates(world, camera, lattice(camera, 16, 0), options, progress);
    progress.begin(4 + 1 + 3 * 5);
    caches.far = solve_far(world, coarse, options, progress);
    for (int step = coarsest; step >= 1; step /= 2)
        for (int kind = step == coarsest ? 0 : 1; kind < (step == coarsest ? 1 : 4); ++kind) {
            auto wanted = unserved(caches.near, camera_candidates(world, camera, lattice(camera, step, kind), options, progress),
                                   options.threads);
            const auto records = gather_records(world, wanted, caches.far, options, near_stream, options.rows, progress);
            caches.near.insert(records, options.spacing, options.threads);
            progress.advance();
        }
    return caches;
}

CachedIrradiance read_near(const SolvedCaches& caches) {
    return [&caches](const SurfacePoint& point, float) {
        return caches.near.interpolate(point.position, point.normal_towards_shading(), point.frame.n);
    };
}

}  // namespace eclat
