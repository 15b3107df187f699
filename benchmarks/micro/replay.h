// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Bare Embree on rays that the core sent before: what is left when nothing is done with the answers.

#pragma once

#include "micro/ray_probe.h"

namespace eclat {

struct ReplayOptions {
    int width = 8;          // rays a query: 1, 8 or 16
    bool coherent = false;  // Embree's hint
    int threads = 0;        // 0: all cores
};

/// Seconds of wall clock for all rays of the recording. Throws std::invalid_argument for another width.
double replay(const RayRecording& recording, const ReplayOptions& options);

}  // namespace eclat
