// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// One gather, which computes a record from rays over a hemisphere.

#pragma once

#include <functional>
#include <vector>

#include "hemisphere/radiance_projection.h"
#include "records/bright_places.h"
#include "records/record_passes.h"

namespace eclat {

struct Gathered {
    IrradianceRecord record;          // without its length and radius, which `space` sets
    float obstacle = infinity;        // distance of obstacles, which bounds the record's radius, m
    std::vector<Sighting> sightings;  // hits that were too bright for single rays
    std::vector<CellSample> samples;  // irradiance that paths found at hits where no cache was read
    float reach = 0;                  // distance that the point sees, m; infinite if no ray hits a surface
    RadianceCoefficients radiance;    // for radiance records: their coefficients
    float footprint = 0;              // width of a pixel there, m; without a camera, `pixel_share` times the reach
};

/// Without a camera, a point is assumed to be viewed from the distance that it sees, and this fraction of that distance
/// replaces the width of a pixel. In a room the width is then about a thousandth of the diagonal, as in a picture a
/// thousand pixels wide that the room fills.
constexpr float pixel_share = 0.0016f;

/// Returns the number of rows of the gather that made the record, or `unknown` if its noise does not tell.
int rows_of(const IrradianceRecord& record, int unknown);

/// The data that all gathers of a pass share.
struct GatherTask {
    const World& world;
    const FarEnd& far;           // the light that rays read where they end
    const BrightPlaces& bright;  // places at which some rays are aimed if rows are uniform in sin²θ
    const IrradianceCacheOptions& options;
    Stream stream;
    Progress& progress;
};

/// Performs one gather of `rows` rows at `candidate`. `keep` is called with the samples, from which the excess and
/// distances that are too small have been removed.
Gathered gather(const GatherTask& task, const Candidate& candidate, int rows, Rows kind = Rows::cosine,
                const std::function<void(const HemisphereSamples&)>& keep = {});

}  // namespace eclat
