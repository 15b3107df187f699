// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <doctest/doctest.h>

#include <atomic>
#include <fstream>
#include <thread>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/progress.h"

using namespace eclat;

TEST_CASE("each index comes once, whatever the number of threads") {
    for (int threads : {0, 1, 2, 500})  // more than there are cores, too
        for (size_t count : {0, 1, 7, 1000}) {
            std::vector<std::atomic<int>> calls(count);
            parallel_for(count, threads, [&](size_t i) { ++calls[i]; });
            for (const auto& n : calls) CHECK(n == 1);
        }
}

TEST_CASE("blocks follow each other, none is longer than asked, the last ends at the end") {
    for (size_t count : {0, 1, 63, 64, 65, 1000}) {
        std::vector<std::pair<size_t, size_t>> blocks((count + 63) / 64);
        parallel_blocks(count, 64, 2, [&](size_t begin, size_t end) { blocks[begin / 64] = {begin, end}; });
        size_t at = 0;
        for (auto [begin, end] : blocks) {
            CHECK(begin == at);
            CHECK(end > begin);
            CHECK(end - begin <= 64);
            at = end;
        }
        CHECK(at == count);
    }
}

TEST_CASE("results are in the order of their indices") {
    const auto squares = parallel_map<size_t>(500, 2, [](size_t i) { return i * i; });
    for (size_t i = 0; i < squares.size(); ++i) CHECK(squares[i] == i * i);
}

TEST_CASE("a cancelled loop ends with an exception") {
    Progress progress;
    progress.begin(10000);
    const auto work = [&](size_t) {
        progress.check();
        progress.advance();
        if (progress.done >= 100) progress.cancelled = true;
    };
    CHECK_THROWS_AS(parallel_for(10000, 2, work), Cancelled);
    CHECK(progress.done < 10000);
}

TEST_CASE("no count of rays or steps is lost between threads") {
    Progress progress;
    progress.done = 5;
    progress.begin(1000);
    parallel_for(1000, 2, [&](size_t i) {
        progress.advance();
        progress.count_rays(i);
    });
    CHECK(progress.done == 1000);
    CHECK(progress.total == 1000);
    CHECK(progress.rays == 1000 * 999 / 2);
}

namespace {

/// KB of this process in memory.
long resident() {
    std::ifstream file("/proc/self/statm");
    long all = 0, pages = 0;
    file >> all >> pages;
    return 4 * pages;
}

}  // namespace

TEST_CASE("the memory does not grow with the number of calls") {
    const auto call = [] { parallel_for(4, 2, [](size_t) {}); };
    for (int i = 0; i < 200; ++i) call();
    const long before = resident();
    for (int i = 0; i < 2000; ++i) call();
    // With an arena a call it grew by 14 MB.
    CHECK(resident() - before < 2048);
}

TEST_CASE("nested calls with any number of threads, from several threads at once") {
    std::atomic<long> sum{0};
    const auto nest = [&] {
        for (int k = 0; k < 90; ++k)
            parallel_for(8, k % 3,
                         [&](size_t) { parallel_for(16, k / 3 % 3, [&](size_t i) { sum += static_cast<long>(i); }); });
    };
    std::thread other(nest);
    nest();
    other.join();
    CHECK(sum == 2 * 90 * 8 * 120);
}
