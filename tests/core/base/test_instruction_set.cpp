// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "base/instruction_set.h"

#include <doctest/doctest.h>

using namespace eclat;

TEST_CASE("this machine runs what this test was compiled for") {
    CHECK(supported_level() >= compiled_level());
#ifdef __x86_64__
    CHECK(supported_level() >= 1);
    CHECK(supported_level() <= 4);
#endif
}

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
TEST_CASE("the level agrees with the compiler's own test of each instruction") {
    // Each level holds all instructions of the one below it.
    const bool v2 = __builtin_cpu_supports("sse4.2") && __builtin_cpu_supports("popcnt") &&
                    __builtin_cpu_supports("ssse3") && __builtin_cpu_supports("sse4.1");
    const bool v3 = v2 && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                    __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
    const bool v4 = v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
                    __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
                    __builtin_cpu_supports("avx512vl");
    CHECK(supported_level() == (v4 ? 4 : v3 ? 3 : v2 ? 2 : 1));
}
#endif

TEST_CASE("the name of the instruction set tells its level") {
#ifdef __x86_64__
    const std::string name = compiled_instruction_set();
    CHECK(name.substr(0, 6) == "x86-64");
    if (compiled_level() > 1) CHECK(name == std::string("x86-64-v").append(std::to_string(compiled_level())));
#endif
}
