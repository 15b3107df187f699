// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Light paths from the lights: the first pass of photon mapping.

#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "base/progress.h"
#include "base/work_exchange.h"
#include "methods/photon_map/emission_guide.h"
#include "methods/photon_map/photon_map.h"
#include "transport/world.h"

namespace eclat {

/// The kinds of photons that are stored when they hit a surface with a diffuse lobe. A caustic photon has been
/// scattered by at least one glossy lobe (including mirrors and glass) and by no others; a direct one has come straight
/// from a light.
struct Stored {
    bool direct = false, caustic = false, indirect = false;
};

/// The paths [first, end) of an infinite sequence.
struct PhotonPaths {
    uint64_t first = 0, end = 0;
};

struct TraceOptions {
    Stored stored;
    int max_edges = -1;  // of a photon's path; −1 unlimited
    uint32_t seed = 0;
    int threads = 0;
    EmissionGuide guide{};
    std::shared_ptr<const WorkExchange> exchange{};  // shares the paths of `learn_emission` and `trace_until`
};

/// Traces photons, which are returned in the order of their paths, so that they are the same with any number of
/// threads. Their powers must be divided by the number of paths. Counts rays in `progress`.
std::vector<Photon> trace_photons(const World& world, PhotonPaths paths, const TraceOptions& options,
                                  Progress& progress);

/// Returns a guide to emissions from which photons are stored, learnt from some hundred thousand separate emissions. It
/// is uniform if most of these stored photons, or none did.
EmissionGuide learn_emission(const World& world, const TraceOptions& options, Progress& progress);

/// Photons that were traced until about a given number was stored.
struct TracedPhotons {
    std::vector<Photon> photons;
    uint64_t paths = 0;  // number of emitted paths
};

/// Traces paths, from the first one, until `wanted` photons are stored or `most_paths` have been traced. The number of
/// paths is a multiple of a few thousand and depends only on counts, so it is the same on every machine.
TracedPhotons trace_until(const World& world, size_t wanted, uint64_t most_paths, const TraceOptions& options,
                          Progress& progress);

}  // namespace eclat
