// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Held to     tests/core/test_direct_regions.cpp

#include "integrators/direct_regions.h"

#include "integrators/record_passes.h"

namespace eclat {

std::vector<Candidate> DirectRegions::worth_records(std::span<const Candidate> tried,
                                                    std::span<const Candidate> unserved) {
    for (const Candidate& c : tried)
        if (c.region != 0) ++counts_[c.region].tried;
    for (const Candidate& c : unserved)
        if (c.region != 0) ++counts_[c.region].unserved;
    std::vector<Candidate> out;
    for (const Candidate& c : unserved) {
        if (c.region != 0) {
            const Counts& found = counts_[c.region];
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
