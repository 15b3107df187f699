// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Random numbers as a function of a key: there is no state, so the number of threads cannot change a picture.

#pragma once

#include <cstdint>

#include "base/streams.h"

namespace eclat {

/// Mixes all bits of `x`: a bijection of 32-bit words in which each input bit flips each output bit about half the time.
inline uint32_t hash(uint32_t x) {
    x ^= x >> 16;
    x *= 0x21f0aaadu;
    x ^= x >> 15;
    x *= 0xd35a2d97u;
    x ^= x >> 15;
    return x;
}

inline uint32_t hash(uint32_t a, uint32_t b) { return hash(a ^ (hash(b) + 0x9e3779b9u)); }
inline uint32_t hash(uint32_t a, uint32_t b, uint32_t c) { return hash(hash(a, b), c); }

/// Returns the seed of one use of random numbers, derived from the seed of the whole computation.
inline uint32_t stream_seed(uint32_t seed, Stream stream) { return seed ^ hash(static_cast<uint32_t>(stream)); }

/// Returns the seed of a numbered part of such a use.
inline uint32_t stream_seed(uint32_t seed, Stream stream, uint32_t part) {
    return seed ^ hash(static_cast<uint32_t>(stream), part);
}
inline uint32_t stream_seed(uint32_t seed, Stream stream, uint32_t part, uint32_t detail) {
    return seed ^ hash(static_cast<uint32_t>(stream), part, detail);
}

/// The 24 leading bits as a float in [0, 1): 24 is what a float's significand holds.
inline float to_unit_float(uint32_t x) { return static_cast<float>(x >> 8) * 0x1p-24f; }

/// Independent numbers keyed by (stream, index): the n-th call returns a hash of n.
class Rng {
  public:
    Rng(uint32_t stream, uint32_t index) : key_(hash(stream, index)) {}
    float next() { return to_unit_float(hash(key_, counter_++)); }

  private:
    uint32_t key_;
    uint32_t counter_ = 0;
};

}  // namespace eclat
