// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The passes in which irradiance caches are filled. Each pass makes records for the candidates that no record serves
// yet.

#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "hemisphere/radiance_projection.h"
#include "records/candidate.h"
#include "records/far_end.h"
#include "records/solved_caches.h"
#include "transport/paths.h"

namespace eclat {

/// Returns the candidates that `cache` does not serve.
std::vector<Candidate> unserved(const RecordCache& cache, std::span<const Candidate> candidates, int threads);

/// Gathers indirect irradiance at points.
std::vector<IrradianceRecord> gather_records(const World& world, std::span<const Candidate> candidates,
                                             const FarEnd& far, const IrradianceCacheOptions& options, Stream stream,
                                             int rows, Progress& progress);

/// A request for gathers of a given shape whose samples make records of radiance, too.
struct GatherPlan {
    Rows kind = Rows::balanced;
    int count = 0;   // number of rows
    float mean = 0;  // mean luminance of the irradiance in the scene, 0 while it is unknown
    /// Makes the coefficients of the samples, on any thread. The excess and distances that are too small have been
    /// removed.
    std::function<RadianceCoefficients(const HemisphereSamples&)> project;
};
struct RadianceGathers {
    std::vector<IrradianceRecord> records;
    std::vector<RadianceCoefficients> coefficients;
};
RadianceGathers gather_records(const World& world, std::span<const Candidate> candidates, const FarEnd& far,
                               const IrradianceCacheOptions& options, const GatherPlan& plan, Progress& progress);

/// Returns the rule for the radii of near records.
SpacingRule spacing_rule(const IrradianceCacheOptions& options);
/// Returns the options with which far records are gathered.
IrradianceCacheOptions far_gathering(const IrradianceCacheOptions& options);
/// Sets the radius of a far record that sees as far as `reach`, and its bounds.
void bound_far(IrradianceRecord& record, float reach, const IrradianceCacheOptions& options);

/// Performs a pass of the far cache, which adds coarse records at the candidates that are not served. Because rays find
/// the candidates at random, some lie close to each other; they are thinned in their order.
void add_far(const World& world, std::span<const Candidate> candidates, const IrradianceCacheOptions& options,
             RecordSolve& solve, Progress& progress);

/// Returns the diffuse points that the rays [first, end) of a sequence of cosine-distributed rays hit. The rays start
/// from points that are evenly distributed over `seen`.
std::vector<Candidate> far_candidates(const World& world, std::span<const Candidate> seen, uint32_t first, uint32_t end,
                                      const IrradianceCacheOptions& options, Progress& progress);

/// Fills the far cache, in rounds of candidates that rays from `seen` find.
void solve_far(const World& world, std::span<const Candidate> seen, const IrradianceCacheOptions& options,
               RecordSolve& solve, Progress& progress);
/// Returns the number of passes that `solve_far` reports to `progress`.
uint64_t far_passes(const IrradianceCacheOptions& options);

/// Performs a pass of the near cache, which is read in the state before the pass: candidates that are not served get
/// records if that is worthwhile. Returns how many were not served. `share` is the number of rows of the gathers,
/// divided by the usual number.
size_t add_near(const World& world, std::span<const Candidate> candidates, const IrradianceCacheOptions& options,
                RecordSolve& solve, Progress& progress, float share = 1);

}  // namespace eclat
