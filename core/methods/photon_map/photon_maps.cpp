// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The data of photon mapping [Jensen01]: two maps of photons, and irradiance computed from both. Photons that were scattered
// diffusely are in the global map, those that met only glossy lobes in the caustic map; the irradiance is the sum of both
// estimates. As a density estimate from a hundred photons at the end of every gather ray would be expensive, it is made in
// advance at positions that photons reach, and a gather ray reads the nearest one [Christensen99].
//
// Symbol    name here            meaning                                                          unit
//   E       Record::irradiance   irradiance at a place: the sum of the estimates from both maps   W m⁻²
//   r       Record::radius       radius of the disc of the global estimate there                  m
//   n       photons              photons in a map                                                 1
//   k       nearest              photons that an estimate asks for                                1
//   A       area                 area of all surfaces                                             m²
//
// If all n photons were spread evenly, a disc of radius r would hold n π r² / A of them. The largest radius of an estimate
// is that at which this is k, r = √(A k / (π n)).
//
// References   [Jensen01], [Christensen99]
// Departures   The places are those of other photons than the maps hold, see docs/algorithms/photon_map.md. A place is read
//              only where the point sees it. A gather ray shorter than r reads nothing, since the blur would be seen.
// Bias         Photons are blurred over the disc, and irradiance is constant around each place.
// Held to      tests/methods/test_photon_map.py

#include "methods/photon_map/photon_maps.h"

#include "base/parallel.h"
#include "sampling/sampler.h"
#include "sampling/warp.h"

namespace eclat {

IrradianceMap::IrradianceMap(std::span<const Record> records, int threads) {
    std::vector<Vec3> positions;
    positions.reserve(records.size());
    for (const Record& r : records) positions.push_back(r.position);
    tree_ = KdTree(positions, threads);
    records_.reserve(records.size());
    for (const uint32_t i : tree_.order()) records_.push_back(records[i]);
}

const IrradianceMap::Record* IrradianceMap::nearest(const World& world, const DensityPoint& at, float radius,
                                                    Progress& progress) const {
    thread_local std::vector<Neighbor> found;
    const Disc disc{at.position, at.normal, radius};
    tree_.nearest(disc, 1, found, [&](uint32_t i) { return disc.same_side(records_[i].normal); });
    if (found.empty()) return nullptr;
    const Record& record = records_[found.front().index];
    if (record.clear && found.front().distance2 < sqr(record.radius)) return &record;
    const Ray ray = ray_between(at, {record.position, record.normal, at.offset}, std::sqrt(found.front().distance2));
    uint8_t hidden = 0;
    world.geometry.rays().occluded({&ray, 1}, {&hidden, 1});
    progress.count_rays(1);
    return hidden ? nullptr : &record;
}

void PhotonMaps::precompute(const World& world, std::span<const Photon> places, int threads, Progress& progress) {
    constexpr size_t block = 256;  // points between two tests for cancellation; results do not depend on it
    std::vector<IrradianceMap::Record> records(places.size());
    progress.begin((places.size() + block - 1) / block);
    parallel_blocks(places.size(), block, threads, [&](size_t begin, size_t end) {
        progress.check();
        for (size_t i = begin; i < end; ++i) {
            const Photon& p = places[i];
            Sampler sampler(stream_seed(0, Stream::photon_places), 0, static_cast<uint32_t>(i));
            const Vec3 wo = Frame::around(p.normal).to_world(square_to_cosine_hemisphere(sampler.next_2d()));
            const DensityPoint at = DensityPoint::of_photon(world, p, wo);
            const DensityEstimate diffuse = estimate_irradiance(world, global, at, reading.global, progress);
            const DensityEstimate focused = estimate_irradiance(world, caustic, at, reading.caustic, progress);
            records[i] = {p.position, p.normal, diffuse.irradiance + focused.irradiance, diffuse.radius, diffuse.clear};
        }
        progress.advance();
    });
    irradiance = IrradianceMap(records, threads);
}

std::optional<Color> far_irradiance(const World& world, const PhotonMaps& maps, const DensityPoint& at, float distance,
                                    int max_edges, Progress& progress) {
    // Records contain photons of all path lengths. If there is no record, photons are rare, and continuing the path is
    // cheaper than estimating their density.
    if (max_edges < 0 && !maps.irradiance.empty()) {
        const auto* known = maps.irradiance.nearest(world, at, maps.reading.global.radius, progress);
        return known == nullptr || distance < known->radius ? std::nullopt : std::optional(known->irradiance);
    }
    MapReading limited = maps.reading;
    limited.global.max_edges = limited.caustic.max_edges = max_edges;
    const DensityEstimate diffuse = estimate_irradiance(world, maps.global, at, limited.global, progress);
    if (distance < diffuse.radius) return std::nullopt;
    return diffuse.irradiance + estimate_irradiance(world, maps.caustic, at, limited.caustic, progress).irradiance;
}

float largest_radius(const World& world, size_t photons, int nearest) {
    if (photons == 0) return 0;
    const Geometry& g = world.geometry;
    double area = 0;  // in double precision, since there may be millions of triangles
    for (uint32_t t = 0; t < g.triangle_count(); ++t) {
        const Vec3 a = g.vertex(t, 0);
        area += 0.5 * static_cast<double>(length(cross(g.vertex(t, 1) - a, g.vertex(t, 2) - a)));
    }
    return static_cast<float>(std::sqrt(area * nearest / (M_PI * static_cast<double>(photons))));
}

}  // namespace eclat
