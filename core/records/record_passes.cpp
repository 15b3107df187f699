// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Symbols and references as in methods/irradiance_cache/irradiance_cache.cpp.

#include "records/record_passes.h"

#include <algorithm>

#include "base/parallel.h"
#include "records/gather.h"

namespace eclat {

namespace {

constexpr float bright_cell = 0.02f;     // of the scene's radius: what is aimed at
constexpr uint32_t far_round = 1024;     // rays of one round of far candidates
constexpr uint32_t rays_for_record = 4;  // that look for a far candidate, since most find what is served

/// `mean`: luminance of the irradiance in the scene, 0 while it is unknown.
template <class Rows>
std::vector<Gathered> gather_each(const World& world, std::span<const Candidate> candidates, const FarEnd& far,
                                  const BrightPlaces& bright, const IrradianceCacheOptions& options, Stream stream,
                                  const Rows& rows, float mean, Progress& progress) {
    return parallel_map<Gathered>(candidates.size(), options.threads, [&](size_t i) {
        progress.check();
        const Candidate& c = candidates[i];
        Gathered out = gather(world, c, far, bright, options, stream, rows(c), progress);
        space(out.record, c.footprint, mean,
              {options.metric, options.spacing, options.gradient_limit, options.balanced});
        return out;
    });
}

std::vector<IrradianceRecord> records_of(std::span<const Gathered> gathered) {
    std::vector<IrradianceRecord> out;
    for (const Gathered& g : gathered) out.push_back(g.record);
    return out;
}

/// The records of a pass; what they met is known to the next.
std::vector<IrradianceRecord> remembered(const World& world, std::span<const Gathered> gathered, BrightPlaces& bright) {
    std::vector<Sighting> sightings;
    for (const Gathered& g : gathered) sightings.insert(sightings.end(), g.sightings.begin(), g.sightings.end());
    bright.add(sightings, bright_cell * world.geometry.radius());
    return records_of(gathered);
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
    constexpr float most_rows = 2;         // four times the rays
    constexpr float wanted_noise = 0.04f;  // at which a gather takes just the rows that were asked for
    const float factor = clamp(std::pow(*noise / wanted_noise, 2 / 3.0f), 0.75f, most_rows);
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
                                             const FarEnd& far, const IrradianceCacheOptions& options, Stream stream,
                                             int rows, Progress& progress) {
    return records_of(
        gather_each(world, candidates, far, {}, options, stream, [&](const Candidate&) { return rows; }, 0, progress));
}

std::vector<IrradianceRecord> gather_records(const World& world, std::span<const Candidate> candidates,
                                             const FarEnd& far, const IrradianceCacheOptions& options,
                                             const GatherPlan& plan, Progress& progress) {
    return parallel_map<IrradianceRecord>(candidates.size(), options.threads, [&](size_t i) {
        progress.check();
        IrradianceRecord record = gather(world, candidates[i], far, {}, options, Stream::radiance_records, plan.count,
                                         progress, plan.kind, [&](const HemisphereSamples& s) { plan.keep(i, s); })
                                      .record;
        space(record, candidates[i].footprint, plan.mean,
              {options.metric, options.spacing, options.gradient_limit, options.balanced});
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

CachedIrradiance read_far(const World& world, const PhotonMaps& photons, Progress& progress) {
    return [&](const SurfacePoint& point, float distance) {
        return far_irradiance(world, photons, {point, point.frame.n}, distance, -1, progress);
    };
}

CachedReflection read_radiance(const RadianceCache& cache, const RadianceTables& tables, Reading reading) {
    return [&cache, &tables, reading](SurfacePoint& point, Vec3 wo) -> Color {
        ReflectedFactors factors;
        tables.reflect(point.bsdf, wo, factors);
        if (factors.order == 0) return {};
        const auto reflected =
            cache.reflect(point.position, point.normal_towards_shading(), point.frame, factors, reading);
        if (!reflected) return {};
        set_cached(point.bsdf, factors);
        return *reflected;
    };
}

FarEnd far_end(const World& world, const SolvedCaches& caches, const IrradianceCacheOptions& options,
               Progress& progress) {
    FarEnd out;
    if (options.max_depth >= 0) return out;
    if (options.far_photons)
        out.irradiance = read_far(world, *options.far_photons, progress);
    else if (!caches.far.records().empty())
        out.irradiance = read_far(caches.far);
    if (caches.tables && !caches.radiance.records().empty())
        out.reflection = read_radiance(caches.radiance, *caches.tables, Reading::nearest);
    return out;
}

SolvedCaches empty_caches(const IrradianceCacheOptions& options) {
    return {RecordCache(options.cache), RecordCache(far_reading(options.cache)), {}, {}, {}, {}, nullptr};
}

void add_far(const World& world, std::span<const Candidate> candidates, const IrradianceCacheOptions& options,
             SolvedCaches& caches, Progress& progress) {
    // Far records only feed averages over whole hemispheres, so they may be coarse: never finer than a hundredth of the
    // scene, unless finer spacing is asked for.
    const float unit = options.far_spacing / usual_far_spacing * world.geometry.radius();
    const float least = 0.01f * unit, largest = 0.2f * unit;
    IrradianceCacheOptions coarse = options;
    if (curvature_of(coarse.metric)) coarse.metric = Metric::minimum;  // they are no wider than that anyway
    const auto wanted = thinned(unserved(caches.far, candidates, options.threads), 2 * least);
    auto records = remembered(world,
                              gather_each(
                                  world, wanted, {}, caches.bright, coarse, Stream::far_records,
                                  [&](const Candidate&) { return options.far_rows; }, 0, progress),
                              caches.bright);
    for (IrradianceRecord& r : records) {
        r.least_radius = least;
        r.largest_radius = largest;
        r.radius = clamp(options.far_spacing * r.distance, least, largest);
    }
    caches.far.insert(records, options.far_spacing, options.threads);
    progress.advance();
}

std::vector<Candidate> far_candidates(const World& world, std::span<const Candidate> seen, uint32_t first, uint32_t end,
                                      const IrradianceCacheOptions& options, Progress& progress) {
    constexpr double golden_ratio = 0.6180339887498949;  // its multiples are spread evenly, however many there are
    std::vector<Ray> rays;
    for (uint32_t i = first; i < end; ++i) {
        const double turns = golden_ratio * i;
        const auto from = static_cast<size_t>((turns - std::floor(turns)) * static_cast<double>(seen.size()));
        Sampler sampler(stream_seed(options.seed, Stream::far_records), 0, i);
        const Frame around = Frame::around(seen[from].normal);
        rays.push_back(seen[from].ray(around.to_world(square_to_cosine_hemisphere(sampler.next_2d()))));
    }
    std::vector<Candidate> out;
    Vertices vertices;
    uint32_t key = first;
    for (const Vertex& v : vertices.meet(world, rays, Coherence::none, progress)) {
        if (!v.missed() && v.point.bsdf.has(LobeSet::diffuse)) out.emplace_back(v.point, 0.0f, key);
        ++key;
    }
    return out;
}

uint64_t far_passes(const IrradianceCacheOptions& options) {
    const uint64_t rays = options.max_depth < 0 && !options.far_photons
                              ? uint64_t(rays_for_record) * static_cast<uint64_t>(options.far_records)
                              : 0;
    return (rays + far_round - 1) / far_round;
}

void solve_far(const World& world, std::span<const Candidate> seen, const IrradianceCacheOptions& options,
               SolvedCaches& caches, Progress& progress) {
    if (seen.empty()) return;
    for (uint32_t round = 0; round < far_passes(options); ++round)
        add_far(world, far_candidates(world, seen, round * far_round, (round + 1) * far_round, options, progress),
                options, caches, progress);
}

size_t add_near(const World& world, std::span<const Candidate> candidates, const IrradianceCacheOptions& options,
                SolvedCaches& caches, Progress& progress) {
    const auto missed = unserved(caches.near, candidates, options.threads);
    const auto wanted = caches.direct.worth_records(candidates, missed);
    const auto records =
        remembered(world,
                   gather_each(
                       world, wanted, far_end(world, caches, options, progress), caches.bright, options,
                       Stream::near_records, [&](const Candidate& c) { return rows_for(c, caches.near, options); },
                       caches.near.mean_luminance(), progress),
                   caches.bright);
    caches.near.insert(records, options.spacing, options.threads);
    if (options.disagreement < infinity)
        caches.near.shrink_where_records_disagree(options.disagreement, options.spacing, options.threads);
    progress.advance();
    return missed.size();
}

}  // namespace eclat
