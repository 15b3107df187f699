// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "base/versions.h"

#include <oneapi/tbb/version.h>

#include "base/instruction_set.h"

namespace eclat {

std::string core_instruction_set() { return compiled_instruction_set(); }

bool built_for_one_machine() {
#ifdef ECLAT_BUILT_NATIVE
    return true;
#else
    return false;
#endif
}

std::string threads_version() { return TBB_runtime_version(); }

}  // namespace eclat
