// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Symbols and references as in integrators/irradiance_cache.cpp.

#include "integrators/record_passes.h"

#include <algorithm>

#include "base/parallel.h"
#include "cache/hemisphere.h"

namespace eclat {

namespace {

enum Stream : uint32_t { far_stream = 2, near_stream, radiance_stream = 6 };

constexpr float usual_rows = 14;         // of the gather whose noise records keep
constexpr uint32_t far_round = 1024;     // rays of one round of far candidates
constexpr uint32_t rays_for_record = 4;  // that look for a far candidate, since most find what is served

// What stands low beside the point, or hangs close under the ceiling that it is part of, fills so little of the hemisphere
// that a gather meets it by luck; yet light ends behind it. Rays along the horizon look for it in every direction.
void look_along_horizon(const World& world, const Candidate& candidate, IrradianceRecord& record, Metric metric,
                        Progress& progress) {
    constexpr float degree = pi / 180;
    constexpr size_t turns = 24;
    const Frame frame = Frame::around(candidate.normal);
    std::vector<Ray> rays;
    for (float elevation : {1.5f * degree, 5 * degree})
        for (size_t k = 0; k < turns; ++k) {
            const float phi = 2 * pi * (static_cast<float>(k) + 0.5f) / turns;
            rays.push_back(candidate.ray(frame.u * (std::cos(elevation) * std::cos(phi)) +
                                         frame.v * (std::cos(elevation) * std::sin(phi)) +
                                         frame.n * std::sin(elevation)));
        }
    std::vector<Hit> hits(rays.size());
    world.geometry.rays().intersect(rays, hits);
    progress.count_rays(rays.size());
    for (size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].missed()) continue;
        const Vec3 there = world.geometry.surface_point(hits[i], -rays[i].direction).frame.n;
        if (!stands_apart(candidate.shading_normal, rays[i].direction, there)) continue;
        // A wall goes on between two rays, and is nearest at one side of a sector: its neighbours' sectors hear of it too.
        const size_t ring = i / turns * turns, k = i % turns;
        for (size_t heard : {k, (k + 1) % turns, (k + turns - 1) % turns}) {
            float& clearance = record.clearance[clearance_sector(frame, rays[ring + heard].direction)];
            clearance = std::min(clearance, hits[i].t);
        }
        if (metric != Metric::harmonic) record.distance = std::min(record.distance, hits[i].t);
    }
}

/// Radiance and distance in each cell of a hemisphere of `rows` rows around a candidate.
HemisphereSamples sample_hemisphere(const World& world, const Candidate& candidate, const RecordCache& far,
                                    const IrradianceCacheOptions& options, uint32_t stream, int rows, Rows kind,
                                    Progress& progress) {
    HemisphereSamples samples;
    samples.rows = rows;
    samples.kind = kind;
    samples.columns = columns_for(rows);
    const size_t count = size_t(samples.rows) * samples.columns;
    // A random turn of the grid, or neighbouring records would share the pattern of their error.
    const uint32_t key = hash(candidate.key, stream);
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
            const Vec3 w = cell_direction(samples.rows, samples.columns, j, k, sampler.next_2d(), kind);
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
        samples.direction.push_back(samples.frame.to_local(rays[i].ray.direction));
        samples.hit_normal.push_back(samples.frame.to_local(results[i].normal));
        samples.apart.push_back(stands_apart(candidate.shading_normal, rays[i].ray.direction, results[i].normal));
    }
    return samples;
}

// How E bends at the record, and along which axis less.
void bend(const HemisphereSamples& samples, Curvature curvature, float far, IrradianceRecord& record) {
    const auto bends = principal_curvatures(irradiance_hessian(samples, curvature, far));
    record.curvature = bends.larger;
    record.elongation = elongation(bends);
    // The long axis lies across that of the larger curvature.
    const Vec3 axis = samples.frame.v * std::cos(bends.angle) - samples.frame.u * std::sin(bends.angle);
    const Frame frame = Frame::around(record.normal);
    record.axis = std::atan2(dot(axis, frame.v), dot(axis, frame.u));
}

IrradianceRecord gather(const World& world, const Candidate& candidate, const RecordCache& far,
                        const IrradianceCacheOptions& options, uint32_t stream, int rows, Progress& progress,
                        Rows kind = Rows::cosine, const std::function<void(const HemisphereSamples&)>& keep = {}) {
    HemisphereSamples samples = sample_hemisphere(world, candidate, far, options, stream, rows, kind, progress);
    IrradianceRecord record;
    record.excess = take_excess(samples);
    // Stratified samples in the plane converge with the power 3/4 of their number, which goes with the square of rows.
    record.noise = relative_noise(samples) * std::pow(static_cast<float>(rows) / usual_rows, 1.5f);
    record.position = candidate.position;
    record.normal = samples.frame.n;
    record.irradiance = irradiance(samples);
    record.distance = options.metric == Metric::harmonic ? harmonic_mean_distance(samples) : minimum_distance(samples);
    record.clearance = sector_clearance(samples);
    record.least_radius = options.least_pixels * candidate.footprint;
    record.largest_radius = options.largest_pixels * candidate.footprint;
    // What touches the point, like the surface itself by rounding, would move infinitely fast.
    keep_off(samples, std::max(record.least_radius, 1e-5f * world.geometry.radius()));
    if (keep) keep(samples);
    record.rotation = rotation_gradient(samples);
    record.translation = translation_gradient(samples);
    // Beyond twenty scene radii nothing has parallax.
    if (const auto curvature = curvature_of(options.metric))
        bend(samples, *curvature, 20 * world.geometry.radius(), record);
    look_along_horizon(world, candidate, record, options.metric, progress);
    return record;
}

/// `mean`: luminance of the irradiance in the scene, 0 while it is unknown.
template <class Rows>
std::vector<IrradianceRecord> gather_each(const World& world, std::span<const Candidate> candidates,
                                          const RecordCache& far, const IrradianceCacheOptions& options,
                                          uint32_t stream, const Rows& rows, float mean, Progress& progress) {
    return parallel_map<IrradianceRecord>(candidates.size(), options.threads, [&](size_t i) {
        progress.check();
        IrradianceRecord record = gather(world, candidates[i], far, options, stream, rows(candidates[i]), progress);
        space(record, candidates[i].footprint, mean, {options.metric, options.spacing, options.gradient_limit});
        return record;
    });
}

std::vector<Candidate> thinned(std::span<const Candidate> candidates, float distance) {
    constexpr float same_side = 0.9f;  // cosine, about the angle at which a record's validity ends
    std::vector<Candidate> out;
    for (const Candidate& c : candidates)
        if (std::none_of(out.begin(), out.end(), [&](const Candidate& o) {
                return length_squared(o.position - c.position) < sqr(distance) && dot(o.normal, c.normal) > same_side;
            }))
            out.push_back(c);
    return out;
}

/// Rows of a gather at the candidate, by the noise that finished records around it found. Not by its own: to repeat gathers
/// that look noisy would lose the light that made them so.
int rows_for(const Candidate& candidate, const RecordCache& cache, const IrradianceCacheOptions& options) {
    const auto noise = cache.noise_around(candidate.position, candidate.normal);
    if (!noise) return options.rows;
    constexpr float wanted_noise = 0.04f;  // at which a gather takes just the rows that were asked for
    const float factor = clamp(std::pow(*noise / wanted_noise, 2 / 3.0f), 0.75f, 2);
    return std::max(2, static_cast<int>(std::lround(static_cast<float>(options.rows) * factor)));
}

}  // namespace

std::vector<Candidate> unserved(const RecordCache& cache, std::span<const Candidate> candidates, int threads) {
    std::vector<uint8_t> served(candidates.size());
    parallel_blocks(candidates.size(), 256, threads, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) served[i] = cache.serves(candidates[i].position, candidates[i].normal);
    });
    std::vector<Candidate> out;
    for (size_t i = 0; i < candidates.size(); ++i)
        if (!served[i]) out.push_back(candidates[i]);
    return out;
}

std::vector<IrradianceRecord> gather_records(const World& world, std::span<const Candidate> candidates,
                                             const RecordCache& far, const IrradianceCacheOptions& options,
                                             uint32_t stream, int rows, Progress& progress) {
    return gather_each(world, candidates, far, options, stream, [&](const Candidate&) { return rows; }, 0, progress);
}

std::vector<IrradianceRecord> gather_records(const World& world, std::span<const Candidate> candidates,
                                             const RecordCache& far, const IrradianceCacheOptions& options,
                                             const GatherPlan& plan, Progress& progress) {
    return parallel_map<IrradianceRecord>(candidates.size(), options.threads, [&](size_t i) {
        progress.check();
        IrradianceRecord record = gather(world, candidates[i], far, options, radiance_stream, plan.count, progress,
                                         plan.kind, [&](const HemisphereSamples& s) { plan.keep(i, s); });
        space(record, candidates[i].footprint, plan.mean, {options.metric, options.spacing, options.gradient_limit});
        return record;
    });
}

CacheOptions far_reading(const CacheOptions& near) {
    CacheOptions far = near;
    far.relaxation = 1.4f;
    far.rotation_gradient = false;
    return far;
}

CachedIrradiance read_far(const RecordCache& far) {
    return [&far](const SurfacePoint& point, float distance) -> std::optional<Color> {
        float radius = 0;
        auto E = far.interpolate(point.position, point.normal_towards_shading(), point.frame.n, &radius);
        if (!E || distance < radius) return std::nullopt;
        return E;
    };
}

SolvedCaches empty_caches(const IrradianceCacheOptions& options) {
    return {RecordCache(options.cache), RecordCache(far_reading(options.cache)), {}};
}

void add_far(const World& world, std::span<const Candidate> candidates, const IrradianceCacheOptions& options,
             RecordCache& far, Progress& progress) {
    // Far records only feed averages over whole hemispheres, so they may be coarse: never finer than a hundredth of the
    // scene, unless finer spacing is asked for.
    const float unit = options.far_spacing / usual_far_spacing * world.geometry.radius();
    const float least = 0.01f * unit, largest = 0.2f * unit;
    const RecordCache none;
    IrradianceCacheOptions coarse = options;
    if (curvature_of(coarse.metric)) coarse.metric = Metric::minimum;  // they are no wider than that anyway
    auto records = gather_records(world, thinned(unserved(far, candidates, options.threads), 2 * least), none, coarse,
                                  far_stream, options.far_rows, progress);
    for (IrradianceRecord& r : records) {
        r.least_radius = least;
        r.largest_radius = largest;
        r.radius = clamp(options.far_spacing * r.distance, least, largest);
    }
    far.insert(records, options.far_spacing, options.threads);
    progress.advance();
}

std::vector<Candidate> far_candidates(const World& world, std::span<const Candidate> seen, uint32_t first, uint32_t end,
                                      const IrradianceCacheOptions& options, Progress& progress) {
    constexpr double golden_ratio = 0.6180339887498949;  // its multiples are spread evenly, however many there are
    std::vector<Ray> rays;
    for (uint32_t i = first; i < end; ++i) {
        const double turns = golden_ratio * i;
        const auto from = static_cast<size_t>((turns - std::floor(turns)) * static_cast<double>(seen.size()));
        Sampler sampler(options.seed ^ hash(far_stream), 0, i);
        const Frame around = Frame::around(seen[from].normal);
        rays.push_back(seen[from].ray(around.to_world(square_to_cosine_hemisphere(sampler.next_2d()))));
    }
    std::vector<Hit> hits(rays.size());
    world.geometry.rays().intersect(rays, hits);
    progress.count_rays(rays.size());
    std::vector<Candidate> out;
    for (uint32_t i = 0; i < rays.size(); ++i) {
        if (hits[i].missed()) continue;
        const SurfacePoint point = world.geometry.surface_point(hits[i], -rays[i].direction);
        if (point.bsdf.has(LobeSet::diffuse)) out.emplace_back(point, 0.0f, first + i);
    }
    return out;
}

uint64_t far_passes(const IrradianceCacheOptions& options) {
    const uint64_t rays =
        options.max_depth < 0 ? uint64_t(rays_for_record) * static_cast<uint64_t>(options.far_records) : 0;
    return (rays + far_round - 1) / far_round;
}

void solve_far(const World& world, std::span<const Candidate> seen, const IrradianceCacheOptions& options,
               RecordCache& far, Progress& progress) {
    if (seen.empty()) return;
    for (uint32_t round = 0; round < far_passes(options); ++round)
        add_far(world, far_candidates(world, seen, round * far_round, (round + 1) * far_round, options, progress),
                options, far, progress);
}

size_t add_near(const World& world, std::span<const Candidate> candidates, const IrradianceCacheOptions& options,
                SolvedCaches& caches, Progress& progress) {
    const auto wanted = unserved(caches.near, candidates, options.threads);
    const auto records = gather_each(
        world, wanted, caches.far, options, near_stream,
        [&](const Candidate& c) { return rows_for(c, caches.near, options); }, caches.near.mean_luminance(), progress);
    caches.near.insert(records, options.spacing, options.threads);
    progress.advance();
    return wanted.size();
}

}  // namespace eclat
