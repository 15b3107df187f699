// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The passes by which all irradiance caches are filled: each makes records for candidates that no record serves yet.

#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "records/candidate.h"
#include "records/far_end.h"
#include "records/solved_caches.h"
#include "transport/paths.h"

namespace eclat {

/// Those that `cache` does not serve.
std::vector<Candidate> unserved(const RecordCache& cache, std::span<const Candidate> candidates, int threads);

/// Gathers indirect irradiance at points.
std::vector<IrradianceRecord> gather_records(const World& world, std::span<const Candidate> candidates,
                                             const FarEnd& far, const IrradianceCacheOptions& options, Stream stream,
                                             int rows, Progress& progress);

/// Gathers of one shape, of which more is made than irradiance.
struct GatherPlan {
    Rows kind = Rows::balanced;
    int count = 0;   // of rows
    float mean = 0;  // luminance of the irradiance in the scene, 0 while it is unknown
    /// Is handed the samples of each candidate, by its index, on any thread; excess and too small distances are gone.
    std::function<void(size_t, const HemisphereSamples&)> keep;
};
std::vector<IrradianceRecord> gather_records(const World& world, std::span<const Candidate> candidates,
                                             const FarEnd& far, const IrradianceCacheOptions& options,
                                             const GatherPlan& plan, Progress& progress);

/// A pass of the far cache: coarse records at the candidates that are not served. Rays find candidates by chance, so
/// records that lie close to each other are thinned, in order.
void add_far(const World& world, std::span<const Candidate> candidates, const IrradianceCacheOptions& options,
             RecordSolve& solve, Progress& progress);

/// Diffuse points that rays [first, end) of a sequence of cosine-distributed rays meet; the rays leave from `seen`, spread
/// evenly over it.
std::vector<Candidate> far_candidates(const World& world, std::span<const Candidate> seen, uint32_t first, uint32_t end,
                                      const IrradianceCacheOptions& options, Progress& progress);

/// Rounds of far candidates from `seen`, and their records: all of the far cache.
void solve_far(const World& world, std::span<const Candidate> seen, const IrradianceCacheOptions& options,
               RecordSolve& solve, Progress& progress);
/// How many passes `solve_far` reports to `progress`.
uint64_t far_passes(const IrradianceCacheOptions& options);

/// A pass of the near cache against its frozen state: the candidates that are not served get records where that pays.
/// Returns how many were not served. `share`: rows of its gathers in units of the usual number.
size_t add_near(const World& world, std::span<const Candidate> candidates, const IrradianceCacheOptions& options,
                RecordSolve& solve, Progress& progress, float share = 1);

}  // namespace eclat
