// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The two maps of a scene, and irradiance precomputed from both: what photon mapping reads.

#pragma once

#include <optional>

#include "methods/photon_map/density.h"
#include "methods/photon_map/photon_map.h"

namespace eclat {

/// Irradiance at places that photons reach [Christensen99]: found by one look at the nearest, not by the density of a
/// hundred.
class IrradianceMap {
  public:
    struct Record {
        Vec3 position, normal;
        Color irradiance;
        float radius = 0;   // of the estimate's disc
        bool clear = true;  // as in DensityEstimate
    };

    IrradianceMap() = default;
    IrradianceMap(std::span<const Record> records, int threads);

    bool empty() const { return records_.empty(); }
    const std::vector<Record>& records() const { return records_; }
    /// The nearest record on the point's side that lies within `radius` and that the point sees; null if there is none.
    const Record* nearest(const World& world, const DensityPoint& at, float radius, Progress& progress) const;

  private:
    KdTree tree_;
    std::vector<Record> records_;
};

/// How both maps are read.
struct MapReading {
    DensityOptions global, caustic;
};

struct PhotonMaps {
    PhotonMap global;   // light that was scattered diffusely at least once before it arrived
    PhotonMap caustic;  // light that met glossy lobes only, at least one
    MapReading reading;
    IrradianceMap irradiance;

    /// Fills `irradiance` at the places of photons. They must not be those of the maps: an estimate at a photon's own place
    /// counts it, and a point's nearest such place tells that around the point photons are missing. Both errors are about two
    /// photons of those that are read: 2 % where `nearest` is 100.
    void precompute(const World& world, std::span<const Photon> places, int threads, Progress& progress);
};

/// Indirect irradiance where a gather ray of length `distance` ended; nothing where it was too short (photons are blurred,
/// which would be seen from near by, in corners), or where photons are too rare. `max_edges`: of the photons' paths, −1 unlimited.
std::optional<Color> far_irradiance(const World& world, const PhotonMaps& maps, const DensityPoint& at, float distance,
                                    int max_edges, Progress& progress);

/// The radius of a disc that would hold `nearest` of so many photons if all were spread evenly over the scene: no estimate
/// needs to reach farther. Where it is dark, light is then what few photons say, and not what lies elsewhere.
float largest_radius(const World& world, size_t photons, int nearest);

}  // namespace eclat
