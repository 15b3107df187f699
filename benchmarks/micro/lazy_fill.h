// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The cache filled on demand, pixel by pixel in scanline order, as in the lecture and in [Ward88]: what the passes of
// core/methods/irradiance_cache/irradiance_cache.cpp are compared with.

#pragma once

#include "methods/irradiance_cache/irradiance_cache.h"

namespace eclat {

/// One thread. All paths are traced to their end: there is no far cache.
SolvedCaches fill_lazily(const World& world, const Camera& camera, const IrradianceCacheOptions& options,
                         Progress& progress);

}  // namespace eclat
