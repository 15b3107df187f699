// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Eight numbers looked at together: loops over them that compilers turn into vector instructions, and the way back from the
// result of such a loop to the few numbers that it found.

#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

namespace eclat {

constexpr uint32_t lane_count = 8;

/// Which of eight lanes: one byte for each, since compilers turn a loop of comparisons into bytes with a few instructions.
using Lanes = uint64_t;
static_assert(std::endian::native == std::endian::little);

template <class Test>
Lanes lanes_where(Test&& test) {
    uint8_t bytes[lane_count];
    for (uint32_t i = 0; i < lane_count; ++i) bytes[i] = test(i);
    Lanes lanes;
    std::memcpy(&lanes, bytes, sizeof lanes);
    return lanes;
}

/// Calls `f(lane)` for each of `lanes`, in order.
template <class F>
void for_each_lane(Lanes lanes, F&& f) {
    for (; lanes != 0; lanes &= lanes - 1) f(static_cast<uint32_t>(std::countr_zero(lanes)) / lane_count);
}

}  // namespace eclat
