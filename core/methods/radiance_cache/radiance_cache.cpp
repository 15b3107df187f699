// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Radiance caching, for a view or for all surfaces: indirect light on glossy surfaces from few records [Krivanek05]. A record
// holds the radiance that arrives at its place as coefficients of harmonics, and how they change along the surface. What a
// lobe reflects is then a product of two short lists of numbers: those of the light, and those of the lobe. Light is smooth
// enough for that where the lobe is wide; narrow lobes are traced.
//
// Symbol     name here                 meaning                                                           unit
//   n        options.order             order of the expansion, n² coefficients                           1
//   λ, ∇λ    coefficients, gradients   those of the radiance at a record and how they change             W m⁻² sr⁻¹, W m⁻³ sr⁻¹
//   f        factors                   coefficients of lobe times cosine for one direction of view       1
//   R        records[i].radius         radius of a record; spacing · distance before it is bounded       m
//
//   L_o = Σ_i w_i f · (λ_i + (P − P_i) · ∇λ_i) / Σ_i w_i   (records/radiance_record_cache.cpp)
//
// This file finds the places: glossy points that no record serves, coarse to fine as in irradiance caching. Where a bound made
// a radius larger than spacing · distance, ∇λ is reduced by their ratio, or it would reach farther than it is known.
//
// References   [Krivanek05], [Gautron04], [Krivanek06]; docs/algorithms/radiance_cache.md
//
// Departures   As irradiance caching: coarse-to-fine passes against a frozen cache. A gather for a radiance record gives an
//              irradiance record as well, which serves what is diffuse there.
// Bias         What the order of the expansion leaves of lobe and light, and interpolation.
// Held to      tests/methods/test_radiance_cache.py

#include "methods/radiance_cache/radiance_cache.h"

#include <cmath>

#include "base/parallel.h"
#include "records/camera_chains.h"

namespace eclat {

namespace {

constexpr uint32_t glossy_pass = 1u << 21;  // first pass number of glossy surface points, after those of diffuse ones

/// A point at which a radiance record may be needed.
struct GlossyCandidate {
    Candidate at;
    bool served = false;   // whether a radiance record serves it
    bool diffuse = false;  // whether an irradiance record is needed too
    PlacedLobe lobe;       // its lobe if it is not served
};

GlossyCandidate candidate_for(const Candidate& at, const SurfacePoint& point, Vec3 wo, const ReflectedFactors& factors,
                              const RadianceCache& cache) {
    GlossyCandidate out{
        at, cache.serves(at.position, at.normal, factors.width), !is_black(point.bsdf.diffuse_albedo(wo)), {}};
    if (!out.served) out.lobe = cache.placed_lobe(factors, point.frame, at.normal);
    return out;
}

bool within_tilt(const SurfacePoint& point) {
    return dot(point.frame.n, point.normal_towards_shading()) > std::cos(largest_radiance_tilt);
}

/// Returns the points with cacheable lobes that pixels see, directly or by way of mirrors and narrow lobes.
std::vector<GlossyCandidate> glossy_candidates(const World& world, const Camera& camera, const RadianceTables& tables,
                                               const RadianceCache& cache, std::span<const Vec2> pixels,
                                               const RadianceCacheOptions& options, Progress& progress) {
    return follow_chains<GlossyCandidate>(
        world, camera, pixels, Stream::glossy_chains, options.irradiance, progress,
        [&](SeenVertex& vertex, std::vector<GlossyCandidate>& found) {
            SurfacePoint& point = vertex.point;
            ReflectedFactors factors;
            tables.reflect(point.bsdf, vertex.wo, factors);
            if (factors.order > 0 && within_tilt(point)) {
                found.push_back(candidate_for(vertex.candidate(), point, vertex.wo, factors, cache));
                set_cached(point.bsdf, factors);
            }
            point.bsdf.set_cached(LobeSet::matte);
            return LobeSet::uncached;
        });
}

/// Finds the narrowest lobe that may be cached, for views from four heights and two sides; returns false if there is
/// none. The heights are chosen by judgement; for views below a height of 0.25 few lobes can be cached.
bool narrowest_lobe(const RadianceTables& tables, const Bsdf& bsdf, ReflectedFactors& out) {
    ReflectedFactors factors;
    out.order = 0;
    for (const float z : {1.0f, 0.8f, 0.5f, 0.25f})
        for (const Vec2 side : {Vec2{1, 0}, Vec2{0, 1}}) {
            const float across = std::sqrt(1 - z * z);
            tables.reflect(bsdf, {across * side.x, across * side.y, z}, factors);
            if (factors.order > 0 && (out.order == 0 || factors.width < out.width)) out = factors;
        }
    return out.order > 0;
}

/// Returns the points with cacheable lobes on all surfaces.
std::vector<GlossyCandidate> glossy_candidates(const SurfacePoints& surface, const PlacesPart& part,
                                               const RadianceTables& tables, const RadianceCache& cache,
                                               const RadianceCacheOptions& options) {
    const auto places =
        surface.spread({glossy_pass | part.pass, part.count, part.first, part.end}, options.irradiance.seed);
    using Sides = std::vector<GlossyCandidate>;
    const auto found = parallel_map<Sides>(places.size(), options.irradiance.threads, [&](size_t i) {
        Sides sides;
        uint32_t side = 0;
        surface.for_each_side(places[i].hit, [&](const SurfacePoint& point, Vec3 wo) {
            ReflectedFactors factors;
            const Candidate at(point, 0.0f, hash(places[i].key, side++));
            if (point.bsdf.has(LobeSet::glossy) && within_tilt(point) && narrowest_lobe(tables, point.bsdf, factors))
                sides.push_back(candidate_for(at, point, wo, factors, cache));
        });
        return sides;
    });
    std::vector<GlossyCandidate> out;
    for (const Sides& sides : found) out.insert(out.end(), sides.begin(), sides.end());
    return out;
}

/// Performs a pass, which makes radiance records for the candidates that are not served, and irradiance records from
/// the same gathers. Returns how many were not served.
size_t add_radiance(const World& world, std::span<const GlossyCandidate> candidates, const RadianceWork& work,
                    RecordSolve& solve, Progress& progress) {
    const auto& [tables, options, projection] = work;
    SolvedCaches& caches = solve.caches;
    size_t missed = 0;
    for (const GlossyCandidate& c : candidates) {
        solve.glossy_direct.count(c.at, c.served);
        missed += !c.served;
    }
    std::vector<Candidate> places;
    std::vector<PlacedLobe> lobes;
    std::vector<uint8_t> diffuse;
    for (const GlossyCandidate& c : candidates) {
        if (c.served || !solve.glossy_direct.pays(c.at)) continue;
        places.push_back(c.at);
        lobes.push_back(c.lobe);
        diffuse.push_back(c.diffuse);
    }
    const IrradianceCacheOptions spaced = radiance_gathering(options);
    const GatherPlan plan{Rows::balanced, options.rows, caches.radiance.mean_luminance(),
                          [&](const HemisphereSamples& samples) { return projection(samples); }};
    auto [records, coefficients] =
        gather_records(world, places, far_end(world, caches, spaced, progress, &tables), spaced, plan, progress);
    std::vector<IrradianceRecord> near;
    for (size_t i = 0; i < records.size(); ++i) {
        reduce_gradients(records[i], options.spacing, coefficients[i]);
        if (diffuse[i]) near.push_back(records[i]);
    }
    const int threads = options.irradiance.threads;
    caches.radiance.insert(records, coefficients, lobes, options.spacing, threads);
    if (options.irradiance.disagreement < infinity)
        caches.radiance.shrink_where_records_disagree(options.irradiance.disagreement, options.spacing, threads);
    if (!near.empty()) caches.near.insert(near, options.irradiance.spacing, threads);
    progress.advance();
    return missed;
}

}  // namespace

IrradianceCacheOptions radiance_gathering(const RadianceCacheOptions& options) {
    IrradianceCacheOptions spaced = options.irradiance;
    spaced.spacing = options.spacing;
    return spaced;
}

void add_radiance_of_lattice(const World& world, const Camera& camera, const LatticePart& part,
                             const RadianceWork& work, RecordSolve& solve, Progress& progress) {
    auto candidates =
        glossy_candidates(world, camera, work.tables, solve.caches.radiance, part.pixels, work.options, progress);
    for (GlossyCandidate& c : candidates) set_camera(c.at, part.camera);
    add_radiance(world, candidates, work, solve, progress);
}

PassCounts add_radiance_at_places(const World& world, const SurfacePoints& surface, const PlacesPart& part,
                                  const RadianceWork& work, RecordSolve& solve, Progress& progress) {
    const auto found = glossy_candidates(surface, part, work.tables, solve.caches.radiance, work.options);
    return {found.size(), add_radiance(world, found, work, solve, progress)};
}

MarkCached mark_lobes(const RadianceTables& tables) {
    return [&tables](SurfacePoint& point, Vec3 wo) {
        if (!point.bsdf.has(LobeSet::glossy) || !within_tilt(point)) return;
        ReflectedFactors factors;
        tables.reflect(point.bsdf, wo, factors);
        set_cached(point.bsdf, factors);
    };
}

void solve_radiance_cache(const World& world, Cameras cameras, const RadianceTables& tables,
                          const RadianceCacheOptions& options, SolvedCaches& caches, Progress& progress) {
    caches = empty_caches(options.irradiance);
    RecordSolve solve{caches};
    const IrradianceCacheOptions& irradiance = options.irradiance;
    progress.begin(camera_passes(irradiance, cameras.size(), 2));
    solve_far_for_cameras(world, cameras, irradiance, solve, progress);

    const RadianceProjection projection(options.order, Rows::balanced, options.rows);
    caches.radiance = RadianceCache(irradiance.cache, options.order);
    solve.tables = &tables;
    const RadianceWork work{tables, options, projection};
    for_each_lattice(cameras, irradiance, [&](size_t index, std::span<const Vec2> pixels, float step) {
        add_radiance_of_lattice(world, cameras[index], {pixels, step, index}, work, solve, progress);
    });
    solve_near_for_cameras(world, cameras, irradiance, solve, progress, mark_lobes(tables));
}

void solve_radiance_everywhere(const World& world, const RadianceTables& tables, const RadianceCacheOptions& options,
                               SolvedCaches& caches, Progress& progress) {
    const IrradianceCacheOptions& irradiance = options.irradiance;
    caches = empty_caches(irradiance);
    const SurfacePoints surface(world);
    if (surface.empty()) return;
    RecordSolve solve{caches};
    progress.begin(surface_passes(irradiance, 2));
    solve_far_everywhere(world, surface, irradiance, solve, progress);

    const RadianceProjection projection(options.order, Rows::balanced, options.rows);
    caches.radiance = RadianceCache(irradiance.cache, options.order);
    solve.tables = &tables;
    const RadianceWork work{tables, options, projection};
    double_places([&](uint32_t pass, size_t count) {
        return add_radiance_at_places(world, surface, {pass, count, 0, count}, work, solve, progress);
    });

    solve_near_everywhere(world, surface, irradiance, solve, progress);
}

}  // namespace eclat
