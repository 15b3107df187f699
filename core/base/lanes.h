// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Groups of eight numbers. Compilers turn loops over a group into vector instructions; the functions here iterate over
// the few lanes that such a loop has selected.

#pragma once

#include <bit>
#include <cstdint>
#include <cstring>

namespace eclat {

constexpr uint32_t lane_count = 8;

/// A selection of lanes with one byte for each, because compilers turn a loop of comparisons into bytes with a few
/// instructions.
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

/// Calls `f(lane)` for each selected lane, in order.
template <class F>
void for_each_lane(Lanes lanes, F&& f) {
    for (; lanes != 0; lanes &= lanes - 1) f(static_cast<uint32_t>(std::countr_zero(lanes)) / lane_count);
}

}  // namespace eclat
