// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Regions in which caching is not worthwhile. On leaves, grass and other fine detail, a record serves hardly more than
// its own pixel, so tracing paths for the pixels takes fewer rays.

#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "records/candidate.h"

namespace eclat {

/// Counts, for each square of sixteen pixels, how many pixels of the last passes were served by no record.
class DirectRegions {
  public:
    /// Counts a pass and returns the unserved candidates that get records. These are all except those in squares in
    /// which at least `least_tried` candidates were tried, including this pass, and in which a record served fewer than
    /// two candidates on average.
    std::vector<Candidate> worth_records(std::span<const Candidate> tried, std::span<const Candidate> unserved);
    /// These do the same in two steps for single candidates. All candidates of a pass must be counted before the first
    /// query.
    void count(const Candidate& candidate, bool served);
    bool pays(const Candidate& unserved);
    /// Returns the number of candidates that get no record, so that paths are traced for them.
    size_t left_to_paths() const { return left_; }

    static constexpr uint32_t least_tried = 32;

  private:
    struct Counts {
        uint32_t tried = 0, unserved = 0;
    };

    std::unordered_map<uint32_t, Counts> counts_;  // counts of each region
    size_t left_ = 0;
};

}  // namespace eclat
