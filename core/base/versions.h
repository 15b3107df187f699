// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// What this core was built from and for, for reports of faults.

#pragma once

#include <string>

namespace eclat {

/// The name of the instruction set for which the core was compiled, such as "x86-64-v3".
std::string core_instruction_set();

/// Whether the core was compiled for the machine that compiled it, whose instructions other machines may lack.
bool built_for_one_machine();

/// The version of oneTBB that runs, such as "2021.8".
std::string threads_version();

}  // namespace eclat
