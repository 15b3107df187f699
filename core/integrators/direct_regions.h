// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Where caching does not pay: among leaves, grass, fine detail a record serves hardly more than its own pixel, and its many
// rays are better spent on the pixels themselves.

#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "base/vec.h"

namespace eclat {

struct Candidate;

/// Counts, in cells of space about sixteen pixels wide, how many candidates found no record that serves them.
class DirectRegions {
  public:
    /// Counts a pass and returns which of the unserved candidates get records: all but those in cells where at least
    /// `least_tried` candidates, this pass included, had less than two to each record.
    std::vector<Candidate> worth_records(std::span<const Candidate> tried, std::span<const Candidate> unserved);
    /// Candidates that were left to paths.
    size_t left_to_paths() const { return left_; }

    static constexpr uint32_t least_tried = 32;

  private:
    using Cell = std::array<int32_t, 4>;
    struct Counts {
        uint32_t tried = 0, unserved = 0;
    };
    static Cell cell_of(const Candidate& candidate);

    std::map<Cell, Counts> counts_;
    size_t left_ = 0;
};

}  // namespace eclat
