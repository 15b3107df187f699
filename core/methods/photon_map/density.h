// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Irradiance from the density of photons: the second pass of photon mapping.

#pragma once

#include "base/progress.h"
#include "methods/photon_map/kernel.h"
#include "methods/photon_map/photon_map.h"
#include "transport/world.h"

namespace eclat {

struct DensityOptions {
    int nearest = 100;        // greatest number of photons of an estimate
    float radius = infinity;  // greatest radius of the disc; this or `nearest` must be bounded
    Kernel kernel = Kernel::epanechnikov;
    bool boundary = true;  // whether only the part of the disc that the point sees counts
    int max_edges = -1;    // greatest number of edges of the photons' paths; −1 means unlimited
    /// For progressive estimates, the map of the first pass. All photons are used in a disc whose radius is a fraction
    /// of the radius of the disc that `nearest` photons of this map fill at the same point. It must outlive the
    /// estimates.
    const PhotonMap* first_map = nullptr;
    float part_of_radius = 1;
};

/// Returns the radius of a progressive pass, counted from 0, divided by that of the first pass [KnausZwicker11]. With
/// `alpha` between 0 and 1, both the variance of the mean over passes and its bias converge to 0.
float progressive_radius(uint32_t pass, float alpha);

/// A point at which irradiance is estimated, on the side of the geometric `normal`. The cosines of light are relative
/// to the normal `shading`.
struct DensityPoint {
    Vec3 position, normal, shading;
    float offset = 0;  // distance from the surface at which rays must start, m

    /// Makes the query for the side of `point` that is seen from `wo`.
    DensityPoint(const SurfacePoint& point, Vec3 wo)
        : position(point.position),
          normal(dot(point.normal, wo) >= 0 ? point.normal : -point.normal),
          shading(dot(point.frame.n, wo) >= 0 ? point.frame.n : -point.frame.n),
          offset(point.offset) {}
    DensityPoint(Vec3 position, Vec3 normal, float offset)
        : position(position), normal(normal), shading(normal), offset(offset) {}
    /// Finds the surface at which a photon arrived, as seen from a random direction `wo` above it.
    static DensityPoint of_photon(const World& world, const Photon& photon, Vec3 wo);
};

/// Makes a ray along the surface between points just above the two given ones. Their height is proportional to the
/// `radius` of the disc.
Ray ray_between(const DensityPoint& from, const DensityPoint& to, float radius);

struct DensityEstimate {
    Color irradiance;   // W m⁻²
    float radius = 0;   // radius of the disc
    bool clear = true;  // whether the disc has no obstacles and does not extend beyond the edge of the surface
};

/// Estimates the irradiance at a point from the photons of `map`. Counts rays in `progress`.
DensityEstimate estimate_irradiance(const World& world, const PhotonMap& map, const DensityPoint& at,
                                    const DensityOptions& options, Progress& progress);

}  // namespace eclat
