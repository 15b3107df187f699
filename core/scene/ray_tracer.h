// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <string>

namespace eclat {

/// The version of Embree that runs, such as "4.4.0". Throws std::invalid_argument if Embree cannot start here.
std::string ray_tracer_version();

}  // namespace eclat
