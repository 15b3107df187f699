// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Stands in for oneTBB when tools/check builds under ThreadSanitizer. The real library is not instrumented: how it
// hands work from thread to thread is invisible to the sanitizer, which then either reports every task or, told to
// ignore them, reports nothing. This has the part of the interface that core/base/parallel.h uses, on std::thread.

#pragma once

#include <algorithm>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace tbb {

template <class Index>
class blocked_range {
  public:
    blocked_range(Index begin, Index end, size_t) : begin_(begin), end_(end) {}
    Index begin() const { return begin_; }
    Index end() const { return end_; }

  private:
    Index begin_, end_;
};

struct simple_partitioner {};

namespace info {
// Two, however many cores there are: races show on one, too.
inline int default_concurrency() { return 2; }
}  // namespace info

class task_arena {
  public:
    explicit task_arena(int threads) : threads_(threads) {}

    template <class F>
    void execute(F&& f) {
        const int outer = std::exchange(current_threads(), threads_);
        f();
        current_threads() = outer;
    }

    static int& current_threads() {
        thread_local int threads = 1;
        return threads;
    }

  private:
    int threads_;
};

template <class Index, class Body>
void parallel_for(const blocked_range<Index>& range, const Body& body, simple_partitioner) {
    std::exception_ptr failure;
    std::mutex failure_mutex;
    const int threads = std::max(1, task_arena::current_threads());
    // Each thread has its share from the start, without a counter that would order their accesses and hide races.
    const auto work = [&](int thread) {
        try {
            for (Index i = range.begin() + static_cast<Index>(thread); i < range.end();
                 i += static_cast<Index>(threads))
                body(blocked_range<Index>(i, i + 1, 1));
        } catch (...) {
            const std::lock_guard lock(failure_mutex);
            failure = std::current_exception();
        }
    };
    std::vector<std::thread> helpers;
    for (int t = 1; t < threads; ++t) helpers.emplace_back(work, t);
    work(0);
    for (std::thread& t : helpers) t.join();
    if (failure) std::rethrow_exception(failure);
}

}  // namespace tbb
