// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// What all ways to fill an irradiance cache share: candidates, and passes that give records to those not yet served.

#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "records/bright_places.h"
#include "hemisphere/hemisphere.h"
#include "records/record_cache.h"
#include "records/radiance_record_cache.h"
#include "records/spacing.h"
#include "records/direct_regions.h"
#include "methods/photon_map/photon_maps.h"
#include "transport/paths.h"

namespace eclat {

constexpr float usual_far_spacing = 0.3f;

struct IrradianceCacheOptions {
    float spacing = 0.8f;  // radius of a record in units of the length that its metric gives
    Metric metric = Metric::occlusion;
    float least_pixels = 1;  // bounds of a record's radius, in pixels
    float largest_pixels = 40;
    int rows = 14;  // M of a gather; N = π M
    int far_rows = 9;
    int far_records = 2000;  // candidates of the coarse cache that answers at the far end of gather rays
    /// Radius of a far record in units of its distance R. Coarser ones blur what gather rays see: half darkened rooms that
    /// are lit through a gap by two per cent.
    float far_spacing = usual_far_spacing;
    float disagreement =
        0.02f;  // of records, relative, beyond their noise, that shrinks the worse; infinity: none does
    std::shared_ptr<const PhotonMaps> far_photons;  // in whose irradiance gather rays end, and in no far cache then
    bool gradient_limit = true;
    Balanced balanced = Balanced::squared;
    bool obstacle_limit = true;  // of curvature's radius by the least distance to what stands apart
    CacheOptions cache;
    int max_depth = -1;
    uint32_t seed = 0;
    int threads = 0;
};

struct SolvedCaches {
    RecordCache near, far;
    RadianceCache radiance;  // empty under irradiance caching
    // While records are made:
    BrightPlaces bright;
    DirectRegions direct, glossy_direct;
    const RadianceTables* tables = nullptr;  // of lobes, under radiance caching
};

/// What gather rays read where they end, instead of going on.
struct FarEnd {
    CachedIrradiance irradiance;
    CachedReflection reflection;
};

/// Where a record could be wanted.
struct Candidate {
    Vec3 position;
    Vec3 normal;  // geometric, on the side that is shaded
    Vec3 shading_normal;
    float offset = 0;     // how far rays must start from the surface
    float footprint = 0;  // width of a pixel there
    uint32_t key = 0;     // of its random numbers: what was traced to find it, never coordinates
    bool seen = false;    // by a camera, or in its mirrors
    uint32_t region = 0;  // of the picture, in which records are weighed against pixels; 0: none

    Candidate() = default;
    Candidate(const SurfacePoint& point, float footprint, uint32_t key)
        : position(point.position),
          normal(point.normal_towards_shading()),
          shading_normal(point.frame.n),
          offset(point.offset),
          footprint(footprint),
          key(key) {}

    /// A ray that leaves into the hemisphere around `normal`.
    Ray ray(Vec3 direction) const { return {position + normal * offset, 0, direction}; }
};

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

/// Empty caches, each with how it is read.
SolvedCaches empty_caches(const IrradianceCacheOptions& options);
/// How far records are read from where gather rays end: coarsely, and without turning, since only averages matter.
CacheOptions far_reading(const CacheOptions& near);

/// How gather rays read far records where they end; nothing closer than a record's own radius, where its neighbours' error
/// would be seen from corners.
CachedIrradiance read_far(const RecordCache& far);
/// How paths read radiance records.
CachedReflection read_radiance(const RadianceCache& cache, const RadianceTables& tables,
                               Reading reading = Reading::smooth);
/// Photons or far records, and radiance records, as the caches stand; nothing where paths have a greatest length, since records know of none.
FarEnd far_end(const World& world, const SolvedCaches& caches, const IrradianceCacheOptions& options,
               Progress& progress);

/// The same from photons. Borrows all.
CachedIrradiance read_far(const World& world, const PhotonMaps& photons, Progress& progress);

/// A pass of the far cache: coarse records at the candidates that are not served. Rays find candidates by chance, so
/// those that lie close to each other are thinned, in order.
void add_far(const World& world, std::span<const Candidate> candidates, const IrradianceCacheOptions& options,
             SolvedCaches& caches, Progress& progress);

/// Diffuse points that rays [first, end) of a sequence of cosine-distributed rays meet; the rays leave from `seen`, spread
/// evenly over it.
std::vector<Candidate> far_candidates(const World& world, std::span<const Candidate> seen, uint32_t first, uint32_t end,
                                      const IrradianceCacheOptions& options, Progress& progress);

/// Rounds of far candidates from `seen`, and their records: all of the far cache.
void solve_far(const World& world, std::span<const Candidate> seen, const IrradianceCacheOptions& options,
               SolvedCaches& caches, Progress& progress);
/// How many passes `solve_far` reports to `progress`.
uint64_t far_passes(const IrradianceCacheOptions& options);

/// A pass of the near cache against its frozen state: the candidates that are not served get records where that pays.
/// Returns how many were not served.
size_t add_near(const World& world, std::span<const Candidate> candidates, const IrradianceCacheOptions& options,
                SolvedCaches& caches, Progress& progress);

}  // namespace eclat
