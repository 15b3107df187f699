// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The progress of a long call, which workers write and the waiting thread reads, and a flag that cancels the call.

#pragma once

#include <atomic>
#include <cstdint>

#include "base/error.h"

namespace eclat {

struct Progress {
    std::atomic<uint64_t> done{0};
    std::atomic<uint64_t> total{0};
    std::atomic<uint64_t> rays{0};
    std::atomic<bool> cancelled{false};

    void begin(uint64_t work) {
        done = 0;
        total = work;
    }
    void advance(uint64_t work = 1) { done.fetch_add(work, std::memory_order_relaxed); }
    void count_rays(uint64_t n) { rays.fetch_add(n, std::memory_order_relaxed); }
    /// Throws Cancelled if the caller has asked to stop.
    void check() const {
        if (cancelled.load(std::memory_order_relaxed)) throw Cancelled();
    }
};

}  // namespace eclat
