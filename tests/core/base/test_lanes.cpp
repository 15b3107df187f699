// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Lanes that a comparison found are visited once each, in order.

#include <doctest/doctest.h>

#include <vector>

#include "base/lanes.h"

using namespace eclat;

TEST_CASE("all sets of lanes are visited in order") {
    for (uint32_t set = 0; set < 256; ++set) {
        std::vector<uint32_t> expected, visited;
        for (uint32_t i = 0; i < lane_count; ++i)
            if (set >> i & 1) expected.push_back(i);
        for_each_lane(lanes_where([&](uint32_t i) { return (set >> i & 1) != 0; }),
                      [&](uint32_t lane) { visited.push_back(lane); });
        CHECK(visited == expected);
    }
}
