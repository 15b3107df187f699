// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "base/versions.h"

#include <doctest/doctest.h>

#include "base/instruction_set.h"
#include "scene/ray_tracer.h"

using namespace eclat;

TEST_CASE("libraries tell versions of numbers and points") {
    for (const std::string& version : {ray_tracer_version(), threads_version()}) {
        CAPTURE(version);
        CHECK(version.find_first_not_of("0123456789.") == std::string::npos);
        CHECK(version.find('.') != std::string::npos);
        CHECK(std::stoi(version) >= 3);
    }
}

TEST_CASE("the core is compiled for the same instruction set as this test") {
    CHECK(core_instruction_set() == compiled_instruction_set());
}
