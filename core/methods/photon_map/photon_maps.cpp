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
//   k       nearest              photons that an estimate asks for                                1
//
// The largest radius of an estimate is that of the disc that k photons fill at photons themselves, of which 95 % lie denser.
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

float largest_radius(const PhotonMap& map, int nearest) {
    constexpr size_t asked = 256;  // number of photons whose surroundings are measured, out of all
    constexpr float most = 0.95f;  // share of these that lie at least as dense as the bound assumes
    const std::vector<Photon>& photons = map.photons();
    // Few photons have fewer than `nearest` around them, so a disc of fewer ones is enlarged in proportion.
    const size_t wanted = std::clamp<size_t>(photons.size() / 8, 1, static_cast<size_t>(nearest));
    const size_t step = std::max<size_t>(1, photons.size() / asked);
    std::vector<float> radii;
    std::vector<Neighbor> found;
    for (size_t i = 0; i < photons.size(); i += step) {
        const float radius = map.nearest({photons[i].position, photons[i].normal}, wanted, -1, found);
        if (radius < infinity) radii.push_back(radius);
    }
    if (radii.empty()) return 0;
    const auto at = radii.begin() + static_cast<std::ptrdiff_t>(most * static_cast<float>(radii.size() - 1));
    std::nth_element(radii.begin(), at, radii.end());
    return *at * std::sqrt(static_cast<float>(nearest) / static_cast<float>(wanted));
}

}  // namespace eclat
