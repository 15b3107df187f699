// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The overall steps of photon mapping: tracing photons, building maps, and reading them. The other files have the details.

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "methods/photon_map/photon_gathering.h"
#include "methods/photon_map/trace_photons.h"
#include "transport/estimator.h"

namespace eclat {

/// The request to trace one of the two maps.
struct PhotonTracing {
    bool caustic = false;     // true for the caustic map, false for the global map
    size_t photons = 0;       // wanted number of photons
    uint64_t most_paths = 0;  // number of paths after which tracing ends with fewer photons
    int max_edges = -1;       // greatest number of edges of a photon's path; −1 means unlimited
    bool guided = true;       // whether a guide first learns where to emit
    uint32_t seed = 0;
    int threads = 0;
    std::shared_ptr<const WorkExchange> exchange{};  // shares the paths with other processes
};

TracedPhotons trace_map(const World& world, const PhotonTracing& tracing, Progress& progress);

/// The photons of one map, and the number of paths that were emitted for them.
struct StoredPhotons {
    std::span<const Photon> photons;
    double paths = 0;
};

struct MapOptions {
    int nearest = 100, caustic_nearest = 60;
    Kernel kernel = Kernel::epanechnikov;
    bool gather = true;  // whether irradiance for the ends of gather rays is precomputed
    bool guided = true;  // whether the photons at whose positions irradiance is precomputed are guided
    uint32_t seed = 0;   // seed of these photons, which differs from those of the maps
    int threads = 0;
};

PhotonMaps build_maps(const World& world, StoredPhotons global, StoredPhotons caustic, const MapOptions& options,
                      Progress& progress);

/// The settings of progressive photon mapping, which traces new photons for each sample of the pixels.
struct ProgressiveOptions {
    uint32_t paths = 0;  // number of paths of a pass, for all kinds of photons together
    int nearest = 100;
    Kernel kernel = Kernel::epanechnikov;
    float alpha = 0.7f;  // the discs shrink more slowly if this is larger
    int max_edges = -1;
    uint32_t seed = 0;
    int threads = 0;
};

/// Makes the maps of pass `number`, with photons of all kinds in the global map. `first` are the maps of pass 0, which
/// must outlive those of the others, or null for pass 0 itself.
PhotonMaps progressive_maps(const World& world, uint32_t number, const PhotonMaps* first,
                            const ProgressiveOptions& options, Progress& progress);

/// Estimates the irradiance at points in W m⁻² from the photons of one map, without direct light and final gathering.
std::vector<Color> photon_density(const World& world, const PhotonMaps& maps, bool caustic,
                                  std::span<const PointNormal> points, int threads);

/// These make the two estimators; the maps must outlive them.
Estimator photon_estimator(const World& world, const PhotonMaps& maps, const PhotonMapOptions& options);
PointEstimator photon_point_estimator(const World& world, const PhotonMaps& maps);

}  // namespace eclat
