// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A cache that grows while someone walks: the passes of `solve_irradiance_cache`, one at a time and for one camera after
// another, into the same caches. Points that are served get no records again, so that a place is solved once.
//
// Departures   A solve makes all far records before the first near record. Here the first two lattices, which are coarser
//              than those of a solve, come before them and trace whole paths, so that there is light at once.
// Held to      tests/methods/test_growing_cache.py

#pragma once

#include <deque>
#include <functional>

#include "methods/irradiance_cache/irradiance_cache.h"

namespace eclat {

class GrowingCache {
  public:
    /// Begins with a copy of `caches`, which may be empty.
    GrowingCache(const World& world, IrradianceCacheOptions options, const SolvedCaches& caches);
    GrowingCache(const GrowingCache&) = delete;
    GrowingCache& operator=(const GrowingCache&) = delete;

    /// Turns to what `camera` sees; passes that were left of another view are dropped.
    void look(const Camera& camera);

    /// Returns the number of passes that are left of the view.
    size_t passes_left() const { return passes_.size(); }

    /// Makes the next pass. After a cancellation or another exception, the caches hold the passes that were finished, and
    /// the pass is made again by the next call.
    void step(Progress& progress);

    const SolvedCaches& caches() const { return caches_; }
    /// Returns the places at which gathers aim rays so far.
    const BrightPlaces& bright() const { return solve_.bright; }

  private:
    const World world_;
    IrradianceCacheOptions options_;
    SolvedCaches caches_;
    RecordSolve solve_;
    size_t views_ = 0;  // number of views so far; each has random numbers of its own
    std::deque<std::function<void(Progress&)>> passes_;
};

}  // namespace eclat
