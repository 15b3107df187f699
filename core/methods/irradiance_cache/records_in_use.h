// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Which records a picture reads. Of the records of an animation, many are out of view or on the far side of an object that
// turns, and need not be kept up to date then.
//
// Held to      tests/python/methods/records/test_use.py

#pragma once

#include <cstdint>
#include <vector>

#include "methods/irradiance_cache/irradiance_cache.h"

namespace eclat {

/// Returns for each record of `cache` whether it is read at any point that `camera` sees, directly or by way of mirrors and
/// glossy lobes. One point of each pixel is looked at, or fewer where the smallest records are wider than pixels, so the picture
/// may still touch the outermost rim of a record that is not in use.
std::vector<uint8_t> records_in_use(const World& world, const Camera& camera, const RecordCache& cache,
                                    const IrradianceCacheOptions& options, Progress& progress);

}  // namespace eclat
