// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Caches that grow while someone walks: the passes of `solve_irradiance_cache` or `solve_radiance_cache`, one at a time and
// for one camera after another, into the same caches; and, where no view wants any, those for all surfaces. Points that are
// served get no records again, so that a place is solved once.
//
// Departures   A solve makes all far records before the first near record. Here the first two lattices, which are coarser
//              than those of a solve, come before them and trace whole paths, so that there is light at once. Passes over
//              radiance and irradiance alternate from coarse to fine. Passes over all surfaces are cut into parts, so that a
//              view does not wait for long.
// Held to      tests/methods/test_growing_cache.py

#pragma once

#include <deque>
#include <functional>
#include <optional>

#include "methods/radiance_cache/radiance_cache.h"

namespace eclat {

class GrowingCache {
  public:
    /// Begins with a copy of `caches`, which may be empty.
    GrowingCache(const World& world, IrradianceCacheOptions options, const SolvedCaches& caches);
    /// Does the same with records of radiance; `tables` must outlive it.
    GrowingCache(const World& world, const RadianceCacheOptions& options, const RadianceTables& tables,
                 const SolvedCaches& caches);
    GrowingCache(const GrowingCache&) = delete;
    GrowingCache& operator=(const GrowingCache&) = delete;

    /// Turns to what `camera` sees; passes that were left of another view are dropped.
    void look(const Camera& camera);
    /// Drops the passes that are left of a view.
    void drop_view() { passes_.clear(); }
    /// Adds the passes for all surfaces, which are made where no passes of a view are left.
    void look_everywhere();

    /// Returns the number of passes that are left of the view.
    size_t passes_left() const { return passes_.size(); }
    /// Returns whether passes over all surfaces are left.
    bool surfaces_left() const { return !sweeps_.empty(); }

    /// Makes the next pass. After a cancellation or another exception, the caches hold the passes that were finished, and
    /// the pass is made again by the next call.
    void step(Progress& progress);

    const SolvedCaches& caches() const { return caches_; }
    /// Returns the places at which gathers aim rays so far.
    const BrightPlaces& bright() const { return solve_.bright; }

  private:
    /// What is needed for records of radiance.
    struct Radiance {
        const RadianceTables& tables;
        RadianceCacheOptions options;
        RadianceProjection projection;

        RadianceWork work() const { return {tables, options, projection}; }
    };
    /// A sweep over all surfaces, and how far it is: from which point on of which pass, and what the pass counted.
    struct Sweep {
        enum class Kind : uint8_t { far, radiance, irradiance };
        Kind kind;
        uint32_t pass = 0;
        size_t first = 0;
        PassCounts counts{0, 0};
    };
    using Pass = std::function<void(Progress&)>;

    void add_passes(const Camera& camera, size_t view, std::span<const Vec2> pixels, float step, bool after_far);
    void step_everywhere(Progress& progress);

    const World world_;
    IrradianceCacheOptions options_;
    std::optional<Radiance> radiance_;
    SolvedCaches caches_;
    RecordSolve solve_;
    size_t views_ = 0;  // number of views so far; each has random numbers of its own
    std::deque<Pass> passes_;
    std::optional<SurfacePoints> surface_;
    std::deque<Sweep> sweeps_;
};

}  // namespace eclat
