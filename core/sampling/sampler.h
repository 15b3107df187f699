// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Owen-scrambled Sobol points, keyed by (seed, pixel, sample, dimension).
//
// The first two Sobol dimensions form a (0, 2)-sequence: any 2^k consecutive points stratify the unit square in all
// elementary intervals. Higher dimensions are padded with the same pair, each pair under its own nested uniform
// shuffle of the index and its own Owen scrambling of the values, all by hashing [Burley20].

#pragma once

#include <array>
#include <cstdint>

#include "base/vec.h"
#include "sampling/rng.h"

namespace eclat {

inline uint32_t reverse_bits(uint32_t x) {
    x = __builtin_bswap32(x);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    return ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
}

/// Owen scrambling of a bit-reversed number: each bit is flipped depending on the lower ones [Burley20].
inline uint32_t laine_karras_permutation(uint32_t x, uint32_t seed) {
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

namespace detail {

/// The second Sobol dimension, bit-reversed, as the xor of one entry for each byte of the index. Its direction numbers
/// are the rows of Pascal's triangle modulo 2: v_0 = 2^31, v_{i+1} = v_i xor v_i / 2.
inline constexpr std::array<std::array<uint32_t, 256>, 4> sobol_1_reversed = [] {
    std::array<uint32_t, 32> column{};
    uint32_t v = 0x80000000u;
    for (int i = 0; i < 32; ++i) {
        uint32_t reversed = 0;
        for (int bit = 0; bit < 32; ++bit) reversed |= ((v >> bit) & 1u) << (31 - bit);
        column[i] = reversed;
        v ^= v >> 1;
    }
    std::array<std::array<uint32_t, 256>, 4> table{};
    for (int byte = 0; byte < 4; ++byte)
        for (uint32_t value = 0; value < 256; ++value)
            for (int bit = 0; bit < 8; ++bit)
                if (value >> bit & 1u) table[byte][value] ^= column[8 * byte + bit];
    return table;
}();

}  // namespace detail

/// One sample of a pixel, which returns the numbers of its dimensions in order.
class Sampler {
  public:
    Sampler(uint32_t seed, uint32_t pixel, uint32_t sample) : key_(hash(seed, pixel)), sample_(sample) {}

    /// Continues at a given dimension, so that the numbers of a vertex do not depend on how many earlier vertices used.
    void set_dimension(uint32_t dimension) { dimension_ = dimension; }

    void skip(uint32_t dimensions) { dimension_ += dimensions; }

    /// The `part`th of `parts` samplers that share this one's sample: over all samples their numbers are one sequence.
    Sampler split(uint32_t parts, uint32_t part) const {
        Sampler out = *this;
        out.sample_ = sample_ * parts + part;
        return out;
    }

    Vec2 next_2d() {
        const uint32_t seed = hash(key_, dimension_++);
        // Shuffling the index by Owen's nested permutation keeps every elementary interval intact.
        const uint32_t index = reverse_bits(laine_karras_permutation(reverse_bits(sample_), seed));
        const auto& table = detail::sobol_1_reversed;
        const uint32_t y =
            table[0][index & 255] ^ table[1][index >> 8 & 255] ^ table[2][index >> 16 & 255] ^ table[3][index >> 24];
        return {to_unit_float(reverse_bits(laine_karras_permutation(index, hash(seed ^ 0x68bc21ebu)))),
                to_unit_float(reverse_bits(laine_karras_permutation(y, hash(seed ^ 0x02e5be93u))))};
    }

    float next_1d() {
        const uint32_t seed = hash(key_, dimension_++);
        const uint32_t index = reverse_bits(laine_karras_permutation(reverse_bits(sample_), seed));
        return to_unit_float(reverse_bits(laine_karras_permutation(index, hash(seed ^ 0x68bc21ebu))));
    }

  private:
    uint32_t key_;
    uint32_t sample_;
    uint32_t dimension_ = 0;
};

}  // namespace eclat
