// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Regions in which caching is not worthwhile: among leaves, grass and other fine detail, a record serves hardly more than its
// own pixel, and its many rays are better spent on the pixels themselves.

#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "records/candidate.h"

namespace eclat {

/// Counts, in squares of sixteen pixels, how many pixels of the last passes found no record that serves them.
class DirectRegions {
  public:
    /// Counts a pass and returns which of the unserved candidates get records: all but those in squares where at least
    /// `least_tried` candidates, this pass included, had less than two to each record.
    std::vector<Candidate> worth_records(std::span<const Candidate> tried, std::span<const Candidate> unserved);
    /// The same in two steps, a candidate at a time: all of a pass are counted before any is asked for.
    void count(const Candidate& candidate, bool served);
    bool pays(const Candidate& unserved);
    /// Candidates that were left to paths.
    size_t left_to_paths() const { return left_; }

    static constexpr uint32_t least_tried = 32;

  private:
    struct Counts {
        uint32_t tried = 0, unserved = 0;
    };

    std::unordered_map<uint32_t, Counts> counts_;  // of each region
    size_t left_ = 0;
};

}  // namespace eclat
