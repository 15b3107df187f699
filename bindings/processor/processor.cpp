// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The Python module `eclat._processor`, which runs on every x86-64 machine and tells which of the cores can run there.

#include <nanobind/nanobind.h>

#include "base/instruction_set.h"

NB_MODULE(_processor, m) {
    m.def("supported_level", &eclat::supported_level, "The highest level of x86-64 that this machine runs, 1 to 4.");
}
