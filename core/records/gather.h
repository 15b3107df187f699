// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// One gather, which computes a record from rays over a hemisphere.

#pragma once

#include <functional>
#include <vector>

#include "records/bright_places.h"
#include "records/record_passes.h"

namespace eclat {

struct Gathered {
    IrradianceRecord record;          // the length and the radius not yet set: that is for `space`
    float obstacle = infinity;        // distance that bounds the record's radius before curvature and gradient do, m
    std::vector<Sighting> sightings;  // of what was too bright for single rays
    float reach = 0;                  // how far the point sees, m; infinite where it meets nothing
    float footprint = 0;              // width of a pixel there, m; without a camera `pixel_share` of the reach
};

/// Without a camera a point is seen from what it sees. Of that distance this share stands for the width of a pixel: in a room
/// about a thousandth of its diagonal, as if it filled a picture of that width.
constexpr float pixel_share = 0.0016f;

/// What all gathers of a pass share.
struct GatherTask {
    const World& world;
    const FarEnd& far;           // where rays end
    const BrightPlaces& bright;  // at which some rays are aimed, with cosine rows
    const IrradianceCacheOptions& options;
    Stream stream;
    Progress& progress;
};

/// One gather of `rows` rows at `candidate`. `keep` is handed the samples, without excess and too small distances.
Gathered gather(const GatherTask& task, const Candidate& candidate, int rows, Rows kind = Rows::cosine,
                const std::function<void(const HemisphereSamples&)>& keep = {});

}  // namespace eclat
