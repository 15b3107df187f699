// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#pragma once

#include <optional>

#include "records/record_cache.h"

namespace eclat {

/// Returns how wrong the irradiance that the cache gives at a point may be, as far as its records know: a share of that
/// irradiance, with the floor that the measure of error has. Returns nothing if no record serves the point. `normal` is
/// the geometric normal.
std::optional<float> estimated_error(const RecordCache& cache, Vec3 p, Vec3 normal);

}  // namespace eclat
