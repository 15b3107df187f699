// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The overall steps of photon mapping: tracing photons, building maps, and reading them. The other files have the details.

#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "methods/photon_map/photon_gathering.h"
#include "methods/photon_map/trace_photons.h"
#include "transport/estimator.h"

namespace eclat {

/// One of the two maps, to be traced.
struct PhotonTracing {
    bool caustic = false;     // light that met glossy lobes only; else light that was scattered diffusely
    size_t photons = 0;       // wanted
    uint64_t most_paths = 0;  // after which fewer photons are enough
    int max_edges = -1;       // of a photon's path; −1 unlimited
    bool guided = true;       // learn where to emit first
    uint32_t seed = 0;
    int threads = 0;
};

TracedPhotons trace_map(const World& world, const PhotonTracing& tracing, Progress& progress);

/// Photons of one map, and the paths that were emitted for them.
struct StoredPhotons {
    std::span<const Photon> photons;
    double paths = 0;
};

struct MapOptions {
    int nearest = 100, caustic_nearest = 60;
    Kernel kernel = Kernel::epanechnikov;
    bool gather = true;  // precompute irradiance for gather rays to end in
    bool guided = true;  // where photons of `seed` are traced, at whose places irradiance is precomputed
    uint32_t seed = 0;   // unlike those of the photons
    int threads = 0;
};

PhotonMaps build_maps(const World& world, StoredPhotons global, StoredPhotons caustic, const MapOptions& options,
                      Progress& progress);

/// Progressive photon mapping: new photons for each sample of the pixels.
struct ProgressiveOptions {
    uint32_t paths = 0;  // emitted for a pass, of all kinds together
    int nearest = 100;
    Kernel kernel = Kernel::epanechnikov;
    float alpha = 0.7f;  // how slowly discs shrink
    int max_edges = -1;
    uint32_t seed = 0;
    int threads = 0;
};

/// The maps of pass `number`: photons of all kinds in the global one. `first` are those of pass 0, which the others borrow;
/// null for pass 0 itself.
PhotonMaps progressive_maps(const World& world, uint32_t number, const PhotonMaps* first,
                            const ProgressiveOptions& options, Progress& progress);

/// Irradiance that the photons of one map tell of at points, direct light and gathering left out [W m⁻²].
std::vector<Color> photon_density(const World& world, const PhotonMaps& maps, bool caustic,
                                  std::span<const PointNormal> points, int threads);

/// Both borrow the maps.
Estimator photon_estimator(const World& world, const PhotonMaps& maps, const PhotonMapOptions& options);
PointEstimator photon_point_estimator(const World& world, const PhotonMaps& maps);

}  // namespace eclat
