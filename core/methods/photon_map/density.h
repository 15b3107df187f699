// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Irradiance from the density of photons: the second pass of photon mapping.

#pragma once

#include "base/precision.h"
#include "base/progress.h"
#include "methods/photon_map/kernel.h"
#include "methods/photon_map/photon_map.h"
#include "transport/world.h"

namespace eclat {

struct DensityOptions {
    int nearest = 100;        // photons of an estimate, at most
    float radius = infinity;  // of its disc, at most; bounded or `nearest` is
    Kernel kernel = Kernel::epanechnikov;
    bool boundary = true;  // count only what the point sees of its disc, photons and area alike
    int max_edges = -1;    // of the photons' paths; −1 unlimited
    /// Progressive estimates take all photons in a disc whose radius is a part of that which `nearest` photons of this map
    /// fill at the same point. Borrowed.
    const PhotonMap* first_map = nullptr;
    float part_of_radius = 1;
};

/// Radius of a progressive pass (from 0) in units of the first one's [KnausZwicker11]: with `alpha` between 0 and 1 both the
/// variance of the mean over passes and its bias vanish.
float progressive_radius(uint32_t pass, float alpha);

/// Where irradiance is wanted: on the side of `normal`, the geometric one; `shading` is what light's cosine is measured
/// against.
struct DensityPoint {
    Vec3 position, normal, shading;
    float offset = 0;  // how far rays must start from the surface

    /// The side of `point` that is seen from `wo`.
    DensityPoint(const SurfacePoint& point, Vec3 wo)
        : position(point.position),
          normal(dot(point.normal, wo) >= 0 ? point.normal : -point.normal),
          shading(dot(point.frame.n, wo) >= 0 ? point.frame.n : -point.frame.n),
          offset(point.offset) {}
    DensityPoint(Vec3 position, Vec3 normal, float offset)
        : position(position), normal(normal), shading(normal), offset(offset) {}
    /// Where a photon arrived, on the surface there as it is seen from a random direction `wo` above it.
    static DensityPoint of_photon(const World& world, const Photon& photon, Vec3 wo);
};

/// A ray along the surface, between points just above the two: how far above goes with the size of the disc `radius`.
Ray ray_between(const DensityPoint& from, const DensityPoint& to, float radius);

struct DensityEstimate {
    Color irradiance;   // W m⁻²
    float radius = 0;   // of the disc
    bool clear = true;  // nothing stands in the disc, and it does not reach beyond the surface's edge
};

/// Irradiance of the photons of `map` at a point. Counts rays in `progress`.
DensityEstimate estimate_irradiance(const World& world, const PhotonMap& map, const DensityPoint& at,
                                    const DensityOptions& options, Progress& progress);

}  // namespace eclat
