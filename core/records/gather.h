// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// One gather: what a record learns from the rays of a hemisphere.

#pragma once

#include <functional>
#include <vector>

#include "records/bright_places.h"
#include "records/record_passes.h"

namespace eclat {

struct Gathered {
    IrradianceRecord record;          // its radius not yet set
    std::vector<Sighting> sightings;  // of what was too bright for single rays
};

/// Gather rays end where `far` knows what comes next; with cosine rows some are aimed at `bright` places. `keep` is handed the
/// samples, without excess and too small distances.
Gathered gather(const World& world, const Candidate& candidate, const FarEnd& far, const BrightPlaces& bright,
                const IrradianceCacheOptions& options, Stream stream, int rows, Progress& progress,
                Rows kind = Rows::cosine, const std::function<void(const HemisphereSamples&)>& keep = {});

}  // namespace eclat
