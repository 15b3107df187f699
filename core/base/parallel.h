// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Parallel work over index ranges. Ranges are split by index only, so results never depend on the number of threads. This is the
// only file that uses oneTBB.

#pragma once

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <mutex>
#include <vector>

namespace eclat {

namespace detail {

/// Returns the arena with that number of threads, which is created once and shared by all calls: oneTBB 2021.8 never
/// frees 7 KB of each arena, which was half a megabyte per solve. It is never destroyed, because threads may outlive
/// static objects.
inline tbb::task_arena& arena_of(int threads) {
    static std::mutex mutex;
    static auto& arenas = *new std::map<int, tbb::task_arena>;
    const std::lock_guard lock(mutex);
    return arenas.try_emplace(threads, threads).first->second;
}

}  // namespace detail

/// Calls `f(i)` for each i in [0, count), in any order, on `threads` threads, where 0 means all cores. There are never
/// more threads than cores, because more could not run at once, and oneTBB would warn on standard error. Callers with
/// the same `threads` share them.
template <class F>
void parallel_for(size_t count, int threads, F&& f) {
    const int cores = tbb::info::default_concurrency();
    tbb::task_arena& arena = detail::arena_of(threads > 0 ? std::min(threads, cores) : cores);
    const auto work = [&] {
        tbb::parallel_for(
            tbb::blocked_range<size_t>(0, count, 1),
            [&](const tbb::blocked_range<size_t>& range) {
                for (size_t i = range.begin(); i != range.end(); ++i) f(i);
            },
            tbb::simple_partitioner());
    };
    // The loop is isolated, so that a thread that waits for its end does not start work of another call.
    arena.execute([&] { tbb::this_task_arena::isolate(work); });
}

/// Calls `f(begin, end)` for consecutive blocks of at most `block` indices of [0, count).
template <class F>
void parallel_blocks(size_t count, size_t block, int threads, F&& f) {
    parallel_for((count + block - 1) / block, threads,
                 [&](size_t i) { f(i * block, i * block + block < count ? i * block + block : count); });
}

/// Returns the results of `f(i)` in index order.
template <class T, class F>
std::vector<T> parallel_map(size_t count, int threads, F&& f) {
    std::vector<T> out(count);
    parallel_for(count, threads, [&](size_t i) { out[i] = f(i); });
    return out;
}

}  // namespace eclat
