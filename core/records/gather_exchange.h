// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Gathers of a pass that several processes share. Each process runs the same solve; what it computes itself are only ranges of
// the gathers of each pass, and it gets the others as bytes. All therefore go into the next pass with the same bits.

#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/progress.h"
#include "records/gather.h"

namespace eclat {

/// Computes the gathers [first, end) of the present pass, and returns them as bytes with the number of rays that they took.
using GatherRange = std::function<std::string(size_t first, size_t end)>;

/// Has a function that gets the number of gathers of a pass and the function that computes a range of them, and returns the
/// bytes of ranges that together are all gathers, in order. It is called once for each pass.
class GatherExchange {
  public:
    using Call = std::function<std::vector<std::string>(size_t count, const GatherRange& compute)>;
    explicit GatherExchange(Call call) : call_(std::move(call)) {}
    std::vector<std::string> operator()(size_t count, const GatherRange& compute) const {
        return call_(count, compute);
    }

  private:
    Call call_;
};

/// Returns gathers as bytes, which only the same build on the same kind of machine can read.
std::string packed(std::span<const Gathered> gathered, uint64_t rays);

/// Appends the gathers of packed bytes to `out`, and returns the number of rays. Throws if the bytes are damaged.
uint64_t unpack(const std::string& bytes, std::vector<Gathered>& out);

/// Lets `exchange` compute `count` gathers. The rays of other processes are counted in `progress`.
std::vector<Gathered> exchanged(const GatherExchange& exchange, size_t count, int threads, Progress& progress,
                                const std::function<Gathered(size_t)>& gather);

}  // namespace eclat
