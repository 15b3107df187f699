// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A cache is filled in passes. Each pass finds the candidates that no record serves yet, gathers their records in parallel using
// the cache as the pass before left it, and inserts them in the order of the candidates, so the result does not depend on
// threads. Far records are made first: coarse records at points that rays from visible points hit, at which later gather rays
// may end. Near records, which pictures read, follow. Each pass aims at bright positions that the pass before found.
//
// Symbol    name here          meaning                                                            unit
//   M       options.rows       rows of a gather; it has π M² rays                                 1
//   ν       noise              mean relative noise of the finished records around a candidate     1
//   ν_0     wanted_noise       noise at which a gather takes just M rows                          1
// The noise of stratified samples in the plane is proportional to the power −3/4 of the number of rays, so to M^{-3/2}.
// Records store the noise for the default M. A gather with the noise ν_0 therefore needs M (ν / ν_0)^{2/3} rows. If the
// option M differs from the default, all numbers of rows scale with it.
//
// References   [Ward88], [Tabellion04] records are placed by a strict test and read by a relaxed one
// Held to      tests/core/records/test_record_passes.cpp

#include "records/record_passes.h"

#include <algorithm>
#include <cstddef>

#include "base/parallel.h"
#include "records/gather.h"
#include "records/shared_gathers.h"

namespace eclat {

namespace {

// These are the bounds of a far record's radius at the usual spacing, divided by its reach. In a cube they are a
// hundredth and a fifth of half the diagonal.
constexpr float least_share = 0.008f, largest_share = 0.16f;
constexpr uint32_t far_round = 1024;     // number of rays in one round of far candidates
constexpr uint32_t rays_for_record = 4;  // number of rays per far candidate, since most rays hit points that are served

/// Sets the lengths and radii of the records of a pass. `mean` is the mean luminance of the irradiance in the scene, or
/// 0 while it is unknown.
/// Without a camera, points whose rays hit nothing have no length of their own. They take the typical length of the
/// first pass whose rays hit anything, which is kept in `usual` (m, 0 until then), or else a share of the extent of all
/// points. The light does not depend on it. The typical length of later passes would be too short, because they add
/// records near surfaces that are close to others: the back of a floor beside a mirror got 160,000 records by it.
void space_all(std::span<Gathered> gathered, float mean, const IrradianceCacheOptions& options, float& usual) {
    std::vector<float> known;
    Vec3 low{infinity, infinity, infinity}, high = -low;
    for (const Gathered& g : gathered) {
        if (g.footprint < infinity) known.push_back(g.footprint);
        low = min(low, g.record.position);
        high = max(high, g.record.position);
    }
    if (usual == 0 && !known.empty()) {
        const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
        std::nth_element(known.begin(), middle, known.end());
        usual = *middle;
    }
    const float length_of_none = usual > 0 ? usual : pixel_share * std::max(length(high - low), 1e-3f * length(high));
    for (Gathered& g : gathered) {
        if (!(g.footprint < infinity)) {
            g.footprint = length_of_none;
            g.record.least_radius = options.least_pixels * length_of_none;
            g.record.largest_radius = options.largest_pixels * length_of_none;
        }
        space(g.record, g.obstacle, g.footprint, mean, spacing_rule(options));
    }
}

/// Computes the gathers of a pass, here or by several processes, and adds the estimates of far irradiance that they found to
/// `cells`, if there are any. `rows` is about the number of rows of a gather.
std::vector<Gathered> gather_all(const IrradianceCacheOptions& options, size_t count, int rows, Progress& progress,
                                 FarCells* cells, const std::function<Gathered(size_t)>& one) {
    const auto samples_of = [](std::span<const Gathered> gathered) {
        std::vector<CellSample> samples;
        for (const Gathered& g : gathered) samples.insert(samples.end(), g.samples.begin(), g.samples.end());
        return samples;
    };
    if (!options.exchange) {
        auto gathered = parallel_map<Gathered>(count, options.threads, one);
        if (cells) cells->add(samples_of(gathered), options.threads);
        return gathered;
    }
    const auto rays = static_cast<uint64_t>(rows) * static_cast<uint64_t>(columns_for(rows));
    const SharedGathers shared(*options.exchange, count, rays, options.threads, progress, one);
    if (shared.follows()) {
        if (cells) cells->set(shared.means());
        return shared.gathered();
    }
    const auto samples = samples_of(shared.gathered());
    if (cells) cells->add(samples, options.threads);
    shared.tell(cells ? cells->means_of(samples) : std::vector<CellMean>());
    return shared.gathered();
}

template <class Rows>
std::vector<Gathered> gather_each(const GatherTask& task, std::span<const Candidate> candidates, const Rows& rows,
                                  float mean, float& usual, FarCells* cells = nullptr) {
    const int usual_rows = candidates.empty() ? 1 : rows(candidates.front());
    auto out = gather_all(task.options, candidates.size(), usual_rows, task.progress, cells, [&](size_t i) {
        task.progress.check();
        return gather(task, candidates[i], rows(candidates[i]));
    });
    space_all(out, mean, task.options, usual);
    return out;
}

std::vector<IrradianceRecord> records_of(std::span<const Gathered> gathered) {
    std::vector<IrradianceRecord> out;
    for (const Gathered& g : gathered) out.push_back(g.record);
    return out;
}

/// Collects the records of a pass, and the sightings at which the next pass aims.
std::vector<IrradianceRecord> remembered(std::span<const Gathered> gathered, RecordSolve& solve) {
    std::vector<Sighting> sightings;
    for (const Gathered& g : gathered) sightings.insert(sightings.end(), g.sightings.begin(), g.sightings.end());
    solve.bright.add(sightings);
    return records_of(gathered);
}

/// Keeps, in order, the records whose distance from each kept record on the same side is at least the sum of their
/// least radii. A round has so few far candidates that all pairs can be compared.
std::vector<IrradianceRecord> thinned(std::span<const IrradianceRecord> records) {
    // This is the cosine of 26°, by judgement: a record serves normals within 10°, and far records may be coarser.
    constexpr float same_side = 0.9f;
    std::vector<IrradianceRecord> out;
    for (const IrradianceRecord& r : records)
        if (std::none_of(out.begin(), out.end(), [&](const IrradianceRecord& o) {
                return length_squared(o.position - r.position) < sqr(o.least_radius + r.least_radius) &&
                       dot(o.normal, r.normal) > same_side;
            }))
            out.push_back(r);
    return out;
}

/// Returns the number of rows of a gather at the candidate, from the noise of the finished records around it. The noise
/// of the gather itself must not be used: repeating gathers that happen to be noisy would lose the light that made them
/// noisy.
int rows_for(const Candidate& candidate, const RecordCache& cache, const IrradianceCacheOptions& options, float share) {
    const auto rows = [&](float factor) {
        return std::max(2, static_cast<int>(std::lround(static_cast<float>(options.rows) * share * factor)));
    };
    const auto noise = cache.noise_around(candidate.position, candidate.normal);
    if (!noise) return rows(1);
    // Both bounds and the wanted noise are chosen by judgement. A lower noise would take rays everywhere, and a higher
    // one leaves splotches. Because the noise itself is uncertain, the bounds keep a gather between about half (0.75²)
    // and four times (2²) the usual number of rays.
    constexpr float fewest_rows = 0.75f, most_rows = 2;
    constexpr float wanted_noise = 0.04f;
    return rows(clamp(std::pow(*noise / wanted_noise, 2 / 3.0f), fewest_rows, most_rows));
}

}  // namespace

SpacingRule spacing_rule(const IrradianceCacheOptions& options) {
    return {options.metric, options.spacing, options.gradient_limit, options.balanced};
}

IrradianceCacheOptions far_gathering(const IrradianceCacheOptions& options) {
    IrradianceCacheOptions coarse = options;
    if (curvature_of(coarse.metric)) coarse.metric = Metric::minimum;  // far records have no larger radius anyway
    return coarse;
}

// Far records are only used in averages over whole hemispheres, so they may be coarse. Unless a finer spacing is
// requested, their radii are at least about a hundredth of the distance from which they are seen, which is taken to
// be the distance that they see.
void bound_far(IrradianceRecord& record, float reach, const IrradianceCacheOptions& options) {
    const float unit = options.far_spacing / usual_far_spacing;
    record.least_radius = least_share * unit * reach;
    record.largest_radius = largest_share * unit * reach;
    record.radius = clamp(options.far_spacing * record.distance, record.least_radius, record.largest_radius);
}

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
    const BrightPlaces none;
    float usual = 0;
    return records_of(gather_each(
        {world, far, none, options, stream, progress}, candidates, [&](const Candidate&) { return rows; }, 0, usual));
}

RadianceGathers gather_records(const World& world, std::span<const Candidate> candidates, const FarEnd& far,
                               const IrradianceCacheOptions& options, const GatherPlan& plan, Progress& progress) {
    const BrightPlaces none;
    const GatherTask task{world, far, none, options, Stream::radiance_records, progress};
    auto gathered = gather_all(options, candidates.size(), plan.count, progress, nullptr, [&](size_t i) {
        progress.check();
        RadianceCoefficients coefficients;
        Gathered out = gather(task, candidates[i], plan.count, plan.kind,
                              [&](const HemisphereSamples& samples) { coefficients = plan.project(samples); });
        out.radiance = std::move(coefficients);
        return out;
    });
    float usual = 0;
    space_all(gathered, plan.mean, options, usual);
    RadianceGathers out{records_of(gathered), {}};
    for (Gathered& g : gathered) out.coefficients.push_back(std::move(g.radiance));
    return out;
}

void add_far(const World& world, std::span<const Candidate> candidates, const IrradianceCacheOptions& options,
             RecordSolve& solve, Progress& progress) {
    const IrradianceCacheOptions coarse = far_gathering(options);
    const auto wanted = unserved(solve.caches.far, candidates, options.threads);
    const FarEnd none;
    float usual = 0;  // not used, because far records whose rays hit nothing are left out
    const auto gathered = gather_each(
        {world, none, solve.bright, coarse, Stream::far_records, progress}, wanted,
        [&](const Candidate&) { return options.far_rows; }, 0, usual, &solve.cells);
    const auto records = remembered(gathered, solve);
    std::vector<IrradianceRecord> seen;
    for (size_t i = 0; i < records.size(); ++i) {
        IrradianceRecord r = records[i];
        if (!(gathered[i].reach < infinity)) continue;  // a record that no surface sees
        bound_far(r, gathered[i].reach, options);
        seen.push_back(r);
    }
    solve.caches.far.insert(thinned(seen), options.far_spacing, options.threads);
    progress.advance();
}

std::vector<Candidate> far_candidates(const World& world, std::span<const Candidate> seen, uint32_t first, uint32_t end,
                                      const IrradianceCacheOptions& options, Progress& progress) {
    constexpr double golden_ratio = 0.6180339887498949;  // any number of its multiples modulo 1 are distributed evenly
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
        if (!v.missed()) add_sides(v.point, v.wo_local, Candidate(v.point, 0.0f, key), out);
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
               RecordSolve& solve, Progress& progress) {
    if (seen.empty()) return;
    for (uint32_t round = 0; round < far_passes(options); ++round)
        add_far(world, far_candidates(world, seen, round * far_round, (round + 1) * far_round, options, progress),
                options, solve, progress);
}

size_t add_near(const World& world, std::span<const Candidate> candidates, const IrradianceCacheOptions& options,
                RecordSolve& solve, Progress& progress, float share) {
    SolvedCaches& caches = solve.caches;
    const auto missed = unserved(caches.near, candidates, options.threads);
    const auto wanted = solve.direct.worth_records(candidates, missed);
    caches.left_to_paths = solve.direct.left_to_paths();
    const FarEnd far =
        far_end(world, caches, options, progress, solve.tables, solve.read_cells ? &solve.cells : nullptr);
    const auto records = remembered(gather_each(
                                        {world, far, solve.bright, options, Stream::near_records, progress}, wanted,
                                        [&](const Candidate& c) { return rows_for(c, caches.near, options, share); },
                                        caches.near.mean_luminance(), solve.usual_footprint, &solve.cells),
                                    solve);
    caches.near.insert(records, options.spacing, options.threads);
    if (options.disagreement < infinity)
        caches.near.shrink_where_records_disagree(options.disagreement, options.spacing, options.threads);
    progress.advance();
    return missed.size();
}

}  // namespace eclat
