// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Who gets no record: those among whom records serve hardly more than themselves.

#include "records/direct_regions.h"

#include <doctest/doctest.h>

#include <vector>

#include "records/record_passes.h"

using namespace eclat;

namespace {

std::vector<Candidate> in_region(uint32_t region, size_t count) {
    std::vector<Candidate> out(count);
    for (size_t i = 0; i < count; ++i) {
        out[i].region = region;
        out[i].key = static_cast<uint32_t>(i);
    }
    return out;
}

std::vector<Candidate> part(const std::vector<Candidate>& all, size_t count) {
    return {all.begin(), all.begin() + static_cast<ptrdiff_t>(count)};
}

}  // namespace

TEST_CASE("no records are made in regions where records serve fewer than two candidates") {
    DirectRegions regions;
    const auto leaves = in_region(7, 40), wall = in_region(8, 40);
    auto tried = leaves, unserved = part(leaves, 30);
    tried.insert(tried.end(), wall.begin(), wall.end());
    const auto of_wall = part(wall, 10);
    unserved.insert(unserved.end(), of_wall.begin(), of_wall.end());
    const auto worth = regions.worth_records(tried, unserved);
    REQUIRE(worth.size() == 10);
    for (const Candidate& c : worth) CHECK(c.region == 8);
    CHECK(regions.left_to_paths() == 30);
}

TEST_CASE("a few candidates decide nothing, but several passes together do") {
    DirectRegions regions;
    const auto all = in_region(7, 20);
    CHECK(regions.worth_records(all, all).size() == 20);
    CHECK(regions.worth_records(all, all).empty());
    CHECK(regions.left_to_paths() == 20);
}

TEST_CASE("records are made if half of the candidates are served, and always at points that no camera sees") {
    DirectRegions regions;
    const auto all = in_region(7, 64);
    CHECK(regions.worth_records(all, part(all, 32)).size() == 32);
    const auto bare = in_region(0, 64);
    CHECK(regions.worth_records(bare, bare).size() == 64);
}
