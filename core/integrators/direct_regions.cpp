// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Held to     tests/core/test_direct_regions.cpp

#include "integrators/direct_regions.h"

#include <cmath>

#include "integrators/record_passes.h"

namespace eclat {

DirectRegions::Cell DirectRegions::cell_of(const Candidate& candidate) {
    // The next power of two, so that candidates at about the same distance share a grid.
    const int level = std::ilogb(16 * candidate.footprint) + 1;
    Cell cell{level, 0, 0, 0};
    for (int axis = 0; axis < 3; ++axis)
        cell[axis + 1] = static_cast<int32_t>(std::floor(std::ldexp(candidate.position[axis], -level)));
    return cell;
}

std::vector<Candidate> DirectRegions::worth_records(std::span<const Candidate> tried,
                                                    std::span<const Candidate> unserved) {
    for (const Candidate& c : tried)
        if (c.footprint > 0) ++counts_[cell_of(c)].tried;
    for (const Candidate& c : unserved)
        if (c.footprint > 0) ++counts_[cell_of(c)].unserved;
    std::vector<Candidate> out;
    for (const Candidate& c : unserved) {
        if (c.footprint > 0) {
            const Counts& found = counts_[cell_of(c)];
            if (found.tried >= least_tried && 2 * found.unserved > found.tried) {
                ++left_;
                continue;
            }
        }
        out.push_back(c);
    }
    return out;
}

}  // namespace eclat
