// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Light paths from the lights: the first pass of photon mapping.

#pragma once

#include <cstdint>
#include <vector>

#include "base/progress.h"
#include "methods/photon_map/emission_guide.h"
#include "methods/photon_map/photon_map.h"
#include "transport/world.h"

namespace eclat {

/// Which photons are stored where they meet a surface with a diffuse lobe. A caustic photon has met glossy lobes only
/// (mirrors and glass included), at least one; a direct one has come straight from a light.
struct Stored {
    bool direct = false, caustic = false, indirect = false;
};

/// Paths [first, end) of an endless sequence.
struct PhotonPaths {
    uint64_t first = 0, end = 0;
};

struct TraceOptions {
    Stored stored;
    int max_edges = -1;  // of a photon's path; −1 unlimited
    uint32_t seed = 0;
    int threads = 0;
    EmissionGuide guide{};
};

/// Photons in the order of their paths: the same on any number of threads. Their powers are those of single photons, to be
/// divided by how many paths there were. Counts rays in `progress`.
std::vector<Photon> trace_photons(const World& world, PhotonPaths paths, const TraceOptions& options,
                                  Progress& progress);

/// A guide for what is to be stored, learnt from some hundred thousand emissions of their own; uniform where that already
/// stores most of what is emitted, or nothing was found.
EmissionGuide learn_emission(const World& world, const TraceOptions& options, Progress& progress);

/// Photons traced until about so many are stored.
struct TracedPhotons {
    std::vector<Photon> photons;
    uint64_t paths = 0;  // emitted
};

/// Traces paths, from the first on, until `wanted` photons are stored, or `most_paths` have been traced. The number of
/// paths is a multiple of some thousands, and follows from counts alone.
TracedPhotons trace_until(const World& world, size_t wanted, uint64_t most_paths, const TraceOptions& options,
                          Progress& progress);

}  // namespace eclat
