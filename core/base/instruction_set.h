// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The levels of the x86-64 instruction set [x86-64 psABI, 3.1.1]: what this code was compiled for, and what the
// processor and the operating system can run. Files that include this header may be compiled for level 1.

#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>

#if defined(__x86_64__) || defined(_M_X64)
#define ECLAT_X86_64
#ifdef _MSC_VER
#include <intrin.h>
#else
#include <cpuid.h>
#endif
#endif

namespace eclat {

/// The level for which the including file is compiled, 1 to 4; 0 for other architectures.
inline int compiled_level() {
#if !defined(ECLAT_X86_64)
    return 0;
#elif defined(__AVX512F__) && defined(__AVX512BW__) && defined(__AVX512CD__) && defined(__AVX512DQ__) && \
    defined(__AVX512VL__)
    return 4;
#elif defined(__AVX2__) && defined(__BMI__) && defined(__BMI2__) && defined(__F16C__) && defined(__FMA__) && \
    defined(__LZCNT__) && defined(__MOVBE__)
    return 3;
#elif defined(__SSE4_2__) && defined(__POPCNT__)
    return 2;
#else
    return 1;
#endif
}

/// The name of the instruction set for which the including file is compiled, such as "x86-64-v3".
inline std::string compiled_instruction_set() {
#if defined(ECLAT_X86_64)
    static const char* const names[] = {"x86-64", "x86-64-v2", "x86-64-v3", "x86-64-v4"};
    return names[compiled_level() - 1];
#elif defined(__aarch64__) || defined(_M_ARM64)
    return "aarch64";
#else
    return "unknown";
#endif
}

#ifdef ECLAT_X86_64
namespace detail {

struct Registers {
    uint32_t eax, ebx, ecx, edx;
};

inline Registers cpuid(uint32_t leaf) {
    Registers r{};
#ifdef _MSC_VER
    int out[4];
    __cpuidex(out, int(leaf), 0);
    r = {uint32_t(out[0]), uint32_t(out[1]), uint32_t(out[2]), uint32_t(out[3])};
#else
    __cpuid_count(leaf, 0, r.eax, r.ebx, r.ecx, r.edx);
#endif
    return r;
}

/// The register XCR0, whose bits say which vector registers the operating system keeps for each thread.
inline uint32_t kept_registers() {
#ifdef _MSC_VER
    return uint32_t(_xgetbv(0));
#else
    uint32_t low, high;
    __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    return low;
#endif
}

inline bool has(uint32_t word, std::initializer_list<int> bits) {
    for (const int bit : bits)
        if (!(word >> bit & 1)) return false;
    return true;
}

}  // namespace detail
#endif

/// The highest level that this machine runs, 1 to 4; 0 for other architectures.
inline int supported_level() {
#ifndef ECLAT_X86_64
    return 0;
#else
    // The numbers of the bits are those of Intel's manual, volume 2, CPUID, and volume 1, 13.3 for XCR0.
    using detail::has;
    const uint32_t leaves = detail::cpuid(0).eax, extended_leaves = detail::cpuid(0x80000000u).eax;
    const detail::Registers one = detail::cpuid(1);
    const detail::Registers seven = leaves >= 7 ? detail::cpuid(7) : detail::Registers{};
    const uint32_t extended = extended_leaves >= 0x80000001u ? detail::cpuid(0x80000001u).ecx : 0;
    const int sse3 = 0, ssse3 = 9, cx16 = 13, sse41 = 19, sse42 = 20, popcnt = 23, lahf = 0;
    if (!has(one.ecx, {sse3, ssse3, cx16, sse41, sse42, popcnt}) || !has(extended, {lahf})) return 1;
    const int fma = 12, movbe = 22, osxsave = 27, avx = 28, f16c = 29, lzcnt = 5, bmi1 = 3, avx2 = 5, bmi2 = 8;
    if (!has(one.ecx, {fma, movbe, osxsave, avx, f16c}) || !has(extended, {lzcnt})) return 2;
    const uint32_t kept = detail::kept_registers();
    const int xmm = 1, ymm = 2, masks = 5, upper_halves = 6, upper_registers = 7;
    if (!has(seven.ebx, {bmi1, avx2, bmi2}) || !has(kept, {xmm, ymm})) return 2;
    const int f = 16, dq = 17, cd = 28, bw = 30, vl = 31;
    return has(seven.ebx, {f, dq, cd, bw, vl}) && has(kept, {masks, upper_halves, upper_registers}) ? 4 : 3;
#endif
}

}  // namespace eclat
