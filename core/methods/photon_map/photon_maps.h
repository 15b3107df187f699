// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The two maps of a scene, and irradiance precomputed from both: what photon mapping reads.

#pragma once

#include <optional>

#include "methods/photon_map/density.h"
#include "methods/photon_map/photon_map.h"

namespace eclat {

/// Precomputed irradiance at points that photons reach [Christensen99]. Reading the nearest point is cheaper than
/// estimating the density of a hundred photons.
class IrradianceMap {
  public:
    struct Record {
        Vec3 position, normal;
        Color irradiance;
        float radius = 0;   // radius of the estimate's disc
        bool clear = true;  // as in DensityEstimate
    };

    IrradianceMap() = default;
    IrradianceMap(std::span<const Record> records, int threads);

    bool empty() const { return records_.empty(); }
    const std::vector<Record>& records() const { return records_; }
    /// Returns the nearest record on the point's side that lies within `radius` and is visible from the point, or null
    /// if there is none.
    const Record* nearest(const World& world, const DensityPoint& at, float radius, Progress& progress) const;

  private:
    KdTree tree_;
    std::vector<Record> records_;
};

/// The settings with which both maps are read.
struct MapReading {
    DensityOptions global, caustic;
};

struct PhotonMaps {
    PhotonMap global;   // light that was scattered diffusely at least once before it arrived
    PhotonMap caustic;  // light that met glossy lobes only, at least one
    MapReading reading;
    IrradianceMap irradiance;

    /// Fills `irradiance` at the positions of photons, which must not be those of the maps. An estimate at the position
    /// of a photon counts this photon, and if the nearest such position is read, photons are missing around the query.
    /// Both errors are about two photons, or 2 % if `nearest` is 100.
    void precompute(const World& world, std::span<const Photon> places, int threads, Progress& progress);
};

/// Returns the indirect irradiance at the end of a gather ray of length `distance`. Returns nothing if photons are too
/// rare, or if the ray is too short, as in corners, where the blur of the photons would be visible. `max_edges` is the
/// greatest number of edges of the photons' paths; −1 means unlimited.
std::optional<Color> far_irradiance(const World& world, const PhotonMaps& maps, const DensityPoint& at, float distance,
                                    int max_edges, Progress& progress);

/// Returns the radius of a disc that contains `nearest` photons at nearly all photons, which bounds the radius of
/// estimates. In dark areas, the light is then estimated from the few photons there and not from distant ones. It
/// depends only on where photons lie, so surfaces that they do not reach cannot change it.
float largest_radius(const PhotonMap& map, int nearest);

}  // namespace eclat
