// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Radiance caching for a view.
//
// References   [Krivanek05], [Gautron04]; docs/algorithms/radiance_cache.md
//
// Departures   As irradiance caching: coarse-to-fine passes against a frozen cache. A gather for a radiance record gives an
//              irradiance record as well, which serves what is diffuse there.
// Bias         What the order of the expansion leaves of lobe and light, and interpolation.
// Held to      tests/integrators/test_radiance_cache.py

#include "integrators/radiance_cache.h"

#include <bit>

#include "base/parallel.h"

namespace eclat {

namespace {

constexpr uint32_t chain_stream = 5;

/// Where a radiance record could be wanted, and for how wide a lobe.
struct GlossyCandidate {
    Candidate at;
    float width = 1;
    bool diffuse = false;  // an irradiance record serves there as well
};

/// What pixels see with lobes that may be cached, at first or after mirrors and narrow lobes.
std::vector<GlossyCandidate> glossy_candidates(const World& world, const Camera& camera, const RadianceTables& tables,
                                               std::span<const Vec2> pixels, const RadianceCacheOptions& options,
                                               Progress& progress) {
    constexpr int longest_chain = 4;
    constexpr size_t block = 1024;
    std::vector<std::vector<GlossyCandidate>> found((pixels.size() + block - 1) / block);
    parallel_for(found.size(), options.irradiance.threads, [&](size_t b) {
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
        ReflectedFactors factors;
        for (int edge = 0; edge < longest_chain && !rays.empty(); ++edge) {
            std::vector<Hit> hits(rays.size());
            world.geometry.rays().intersect(rays, hits, edge == 0 ? Coherence::camera : Coherence::none);
            progress.count_rays(rays.size());
            std::vector<Ray> next;
            std::vector<Chain> next_chains;
            for (size_t i = 0; i < rays.size(); ++i) {
                if (hits[i].missed()) continue;
                const Vec3 wo = -rays[i].direction;
                SurfacePoint point = world.geometry.surface_point(hits[i], wo);
                const Vec3 wo_local = point.frame.to_local(wo);
                const float length = chains[i].length + hits[i].t;
                const Vec2 at = some[chains[i].pixel];
                tables.reflect(point.bsdf, wo_local, factors);
                if (factors.order > 0) {
                    found[b].push_back({seen_candidate(point, camera, length, at, edge), factors.width,
                                        !is_black(point.bsdf.diffuse_albedo(wo_local))});
                    for (int lobe = 0; lobe < point.bsdf.count(); ++lobe)
                        if (factors.lobes >> lobe & 1) point.bsdf.set_cached(lobe);
                }
                point.bsdf.set_cached(LobeSet::diffuse);
                const auto pixel = static_cast<uint32_t>(b * block) + chains[i].pixel;
                Sampler sampler(options.irradiance.seed ^ hash(chain_stream), pixel, static_cast<uint32_t>(edge));
                const float u_lobe = sampler.next_1d();
                const auto sample = point.bsdf.sample(wo_local, u_lobe, sampler.next_2d(), LobeSet::uncached);
                if (!sample) continue;
                next.push_back(point.ray(point.frame.to_world(sample->wi)));
                next_chains.push_back({chains[i].pixel, length});
            }
            rays.swap(next);
            chains.swap(next_chains);
        }
    });
    std::vector<GlossyCandidate> out;
    for (auto& f : found) out.insert(out.end(), f.begin(), f.end());
    return out;
}

std::vector<GlossyCandidate> unserved(const RadianceCache& cache, std::span<const GlossyCandidate> candidates,
                                      int threads) {
    std::vector<uint8_t> served(candidates.size());
    parallel_blocks(candidates.size(), 256, threads, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
            served[i] = cache.serves(candidates[i].at.position, candidates[i].at.normal, candidates[i].width);
    });
    std::vector<GlossyCandidate> out;
    for (size_t i = 0; i < candidates.size(); ++i)
        if (!served[i]) out.push_back(candidates[i]);
    return out;
}

/// A pass: radiance records for the candidates that are not served, and irradiance records of the same gathers.
void add_radiance(const World& world, std::span<const GlossyCandidate> candidates, const RadianceProjection& projection,
                  const RadianceCacheOptions& options, SolvedCaches& caches, Progress& progress) {
    const auto wanted = unserved(caches.radiance, candidates, options.irradiance.threads);
    std::vector<Candidate> places;
    for (const GlossyCandidate& c : wanted) places.push_back(c.at);
    std::vector<RadianceCoefficients> coefficients(places.size());
    IrradianceCacheOptions spaced = options.irradiance;
    spaced.spacing = options.spacing;
    const GatherPlan plan{Rows::balanced, options.rows, caches.radiance.mean_luminance(),
                          [&](size_t i, const HemisphereSamples& samples) { coefficients[i] = projection(samples); }};
    const auto records = gather_records(world, places, caches.far, spaced, plan, progress);
    std::vector<IrradianceRecord> diffuse;
    for (size_t i = 0; i < records.size(); ++i) {
        // Where a lower bound widened the radius, the gradients go with it, as those of irradiance did.
        const float raised = options.spacing * records[i].distance / records[i].radius;
        if (raised < 1)
            for (float& g : coefficients[i].gradients) g *= raised;
        if (wanted[i].diffuse) diffuse.push_back(records[i]);
    }
    caches.radiance.insert(records, coefficients, options.spacing, options.irradiance.threads);
    if (!diffuse.empty()) caches.near.insert(diffuse, options.irradiance.spacing, options.irradiance.threads);
    progress.advance();
}

}  // namespace

void solve_radiance_cache(const World& world, const Camera& camera, const RadianceTables& tables,
                          const RadianceCacheOptions& options, SolvedCaches& caches, Progress& progress) {
    solve_irradiance_cache(world, camera, options.irradiance, caches, progress, [&] {
        const RadianceProjection projection(options.order, Rows::balanced, options.rows);
        caches.radiance = RadianceCache(options.irradiance.cache, options.order);
        for_each_lattice(camera, options.irradiance, [&](std::span<const Vec2> pixels) {
            add_radiance(world, glossy_candidates(world, camera, tables, pixels, options, progress), projection,
                         options, caches, progress);
        });
    });
}

CachedReflection read_radiance(const RadianceCache& cache, const RadianceTables& tables) {
    return [&cache, &tables](SurfacePoint& point, Vec3 wo) -> Color {
        ReflectedFactors factors;
        tables.reflect(point.bsdf, wo, factors);
        if (factors.order == 0) return {};
        const auto reflected = cache.reflect(point.position, point.normal_towards_shading(), point.frame, factors);
        if (!reflected) return {};
        for (int lobe = 0; lobe < point.bsdf.count(); ++lobe)
            if (factors.lobes >> lobe & 1) point.bsdf.set_cached(lobe);
        return *reflected;
    };
}

}  // namespace eclat
