// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Density estimation: E = Σ k(d_p / r) Φ_p / r² over the photons nearest to a point [Jensen01], with a kernel k whose
// integral over the unit disc is 1.
// Near a wall, an edge or a box on the floor, a part of the disc is not a surface, or its light does not belong to the
// point. Dividing by the whole area would darken edges, and photons behind a thin wall would light the other side.
// Therefore the sum and the area are both restricted to the part of the disc that is visible from the point, just above
// the surface. To measure the area, probes that are distributed like the kernel search for the surface below them, and
// rays from there to the centre test the visibility. Photons are tested by the same rays. Photons lie below tables and
// panes too, so probes go on below what does not belong to the disc. For uniform light, the estimate is then correct for
// any shape of that part.
//
// Symbol       name here     meaning
//   r            radius        of the disc: the distance of the next photon after the nearest ones, or the largest one
//   k            kernel        per unit disc
//   A            area          of the visible part of the disc, weighted by the kernel, in units of the whole
//
// References   [Jensen01], [Silverman86]
// Bias         Blur: light that varies within the disc is smeared over it.
// Held to      tests/core/methods/photon_map/test_density.cpp

#include "methods/photon_map/density.h"

#include <algorithm>
#include <array>
#include <span>

namespace eclat {

namespace {

constexpr float golden_angle = 2.39996323f;  // 2π (1 − 1 / φ): the spiral whose points are spread evenly for any number
constexpr size_t probes = 128;               // a corner, a quarter of the disc, still has 32
constexpr size_t first_probes = 16;          // that must all be clear or the others are asked too
constexpr float rim = 0.8f;         // squared distance, in radii, beyond which photons are the rim: a fifth of them
constexpr float lift_part = 0.02f;  // of the radius, that rays along the surface keep above it
constexpr float least_area = 1.0f / probes;  // below it nothing is known

class Estimate {
  public:
    Estimate(const World& world, const PhotonMap& map, const DensityPoint& at, const DensityOptions& options,
             float radius, Progress& progress)
        : world_(world),
          map_(map),
          at_(at),
          options_(options),
          disc_{at.position, at.normal, radius},
          progress_(progress) {}

    DensityEstimate irradiance(std::span<const Neighbor> photons) {
        DensityEstimate out;
        out.radius = disc_.radius;
        double area = 1;
        std::vector<uint8_t> hidden(photons.size(), 0);
        if (options_.boundary) {
            area = visible_area(0, first_probes);
            out.clear = clear_ == first_probes && !hides_rim(photons);
            area = out.clear ? area / first_probes : (area + visible_area(first_probes, probes)) / probes;
            if (!out.clear) hide(photons, hidden);
        }
        for (size_t i = 0; i < photons.size(); ++i)
            if (!hidden[i]) out.irradiance += contribution(photons[i]);
        out.irradiance *= 1 / (sqr(disc_.radius) * std::max(least_area, static_cast<float>(area)));
        return out;
    }

  private:
    Color contribution(const Neighbor& n) const {
        const Photon& photon = map_.photon(n);
        const float weight = kernel_weight(options_.kernel, n.distance2 / sqr(disc_.radius));
        // Photons arrive on the geometric surface; light is measured against the shading normal.
        const float cosine = dot(photon.direction, at_.shading), on_surface = dot(photon.direction, photon.normal);
        // Photons at grazing angles are few and have large weights. A tighter limit of the weights would darken bumps
        // (a limit of 4 by 1.6 %).
        const float tilt = at_.shading == at_.normal ? 1 : std::max(0.0f, cosine) / std::max(on_surface, 1e-3f);
        return map_.power(photon) * (weight * tilt);
    }

    Ray to_center(Vec3 position, Vec3 n) const { return ray_between(at_, {position, n, at_.offset}, disc_.radius); }

    void occluded(std::span<const Ray> rays, std::span<uint8_t> out) {
        world_.geometry.rays().occluded(rays, out);
        progress_.count_rays(rays.size());
    }

    void hide(std::span<const Neighbor> photons, std::span<uint8_t> hidden) {
        rays_.clear();
        for (const auto& n : photons) rays_.push_back(to_center(map_.photon(n).position, map_.photon(n).normal));
        occluded(rays_, hidden);
    }

    /// Returns whether any photon near the rim is occluded. There are few probes near the rim, but an area behind a
    /// wall may be bright.
    bool hides_rim(std::span<const Neighbor> photons) {
        rays_.clear();
        for (const auto& n : photons)
            if (n.distance2 > rim * sqr(disc_.radius))
                rays_.push_back(to_center(map_.photon(n).position, map_.photon(n).normal));
        std::vector<uint8_t> hidden(rays_.size());
        occluded(rays_, hidden);
        return std::ranges::any_of(hidden, [](uint8_t h) { return h != 0; });
    }

    /// A search for surfaces along a line through the disc, from above to below it.
    struct Probe {
        Ray down;
        float planned;      // value of the kernel where the line meets the plane
        bool clear = true;  // whether no surface that photons could lie on was found hidden
    };

    Probe probe(size_t i, const Frame& frame) const {
        // The first probes form a separate spiral.
        const float rank = i < first_probes ? (static_cast<float>(i) + 0.5f) / first_probes
                                            : (static_cast<float>(i - first_probes) + 0.5f) / (probes - first_probes);
        const float x2 = kernel_quantile2(options_.kernel, rank), distance = disc_.radius * std::sqrt(x2);
        const float phi = golden_angle * static_cast<float>(i);
        const Vec3 on_plane =
            at_.position + frame.u * (distance * std::cos(phi)) + frame.v * (distance * std::sin(phi));
        // These are the heights of the ellipsoid above and below the plane.
        const float height = disc_.radius * safe_sqrt(1 - x2) / Disc::flatness + 4 * at_.offset;
        return {{on_plane + at_.normal * height, 0, -at_.normal, 2 * height}, kernel_weight(options_.kernel, x2)};
    }

    /// Returns whether photons are stored on a surface that is hit from above.
    bool holds_photons(const Hit& hit) const {
        const Material& material = world_.geometry.material_of(hit.triangle);
        if (material.kind == MaterialKind::diffuse && !material.has_no_back()) return true;
        return world_.geometry.surface_point(hit, at_.normal).bsdf.has(LobeSet::matte);
    }

    /// Returns the weight of the area that a hit of a probe represents, in units of the whole disc; 0 if photons there
    /// do not belong to the disc. `back` gets the ray that tests whether it is visible.
    float area_at(const Probe& probe, const Hit& hit, Ray& back) const {
        const Vec3 position = probe.down.origin + probe.down.direction * hit.t;
        Vec3 n = world_.geometry.geometric_normal(hit.triangle);
        if (dot(n, at_.normal) < 0) n = -n;
        const float x2 = disc_.distance2(position) / sqr(disc_.radius);
        if (!disc_.same_side(n) || !(x2 < 1) || !holds_photons(hit)) return 0;
        back = to_center(position, n);
        // A tilted surface has a larger area than its projection onto the disc.
        return kernel_weight(options_.kernel, x2) / (probe.planned * dot(n, at_.normal));
    }

    /// Returns the sum of the kernel-weighted areas that the probes [first, end) represent; each represents the whole
    /// disc if the surface is flat and unoccluded. Photons lie under tables and panes too, so a probe goes on below
    /// what does not belong to the disc.
    double visible_area(size_t first, size_t end) {
        constexpr int most_layers = 8;
        const Frame frame = Frame::around(at_.normal);
        std::vector<Probe> open, below;
        for (size_t i = first; i < end; ++i) open.push_back(probe(i, frame));
        std::array<Ray, probes> rays;
        std::array<Hit, probes> hits;
        std::array<float, probes> weights;
        std::array<uint8_t, probes> hidden;
        double sum = 0;
        for (int layer = 0; layer < most_layers && !open.empty(); ++layer, open.swap(below)) {
            for (size_t i = 0; i < open.size(); ++i) rays[i] = open[i].down;
            world_.geometry.rays().intersect(std::span(rays).first(open.size()), std::span(hits).first(open.size()));
            progress_.count_rays(open.size());
            size_t found = 0;
            for (size_t i = 0; i < open.size(); ++i) {
                weights[i] = hits[i].missed() ? 0 : area_at(open[i], hits[i], rays[found]);
                found += weights[i] > 0;
            }
            occluded(std::span(rays).first(found), std::span(hidden).first(found));
            below.clear();
            for (size_t i = 0, tested = 0; i < open.size(); ++i) {
                if (hits[i].missed()) continue;
                const bool counts = weights[i] > 0, seen = counts && !hidden[tested];
                tested += counts;
                Probe& one = open[i];
                one.clear &= seen || !counts;
                if (seen) {
                    sum += weights[i];
                    clear_ += one.clear;
                } else {
                    one.down.t_min = hits[i].t + world_.geometry.ray_offset(hits[i].triangle);
                    if (one.down.t_min < one.down.t_max) below.push_back(one);
                }
            }
        }
        return sum;
    }

    const World& world_;
    const PhotonMap& map_;
    const DensityPoint& at_;
    const DensityOptions& options_;
    Disc disc_;
    Progress& progress_;
    std::vector<Ray> rays_;
    size_t clear_ = 0;  // number of probes so far that found a visible surface
};

}  // namespace

DensityPoint DensityPoint::of_photon(const World& world, const Photon& photon, Vec3 wo) {
    // Photons do not store their surface, so it is looked for, for its shading normal.
    const Hit hit = world.geometry.triangle_at(photon.position, photon.normal);
    DensityPoint at{photon.position, photon.normal, hit.missed() ? 0 : world.geometry.ray_offset(hit.triangle)};
    if (!hit.missed() && dot(wo, photon.normal) > 0)
        at.shading = DensityPoint(world.geometry.surface_point(hit, wo), wo).shading;
    return at;
}

Ray ray_between(const DensityPoint& from, const DensityPoint& to, float radius) {
    const float lift = std::max(lift_part * radius, 8 * from.offset);
    const Vec3 start = from.position + from.normal * lift, way = to.position + to.normal * lift - start;
    const float distance = length(way);
    return {start, 0, distance > 0 ? way * (1 / distance) : from.normal, distance};
}

float progressive_radius(uint32_t pass, float alpha) {
    double squared = 1;  // in double precision, because it is a product of thousands of factors
    for (uint32_t i = 1; i <= pass; ++i) squared *= (i + static_cast<double>(alpha)) / (i + 1.0);
    return static_cast<float>(std::sqrt(squared));
}

DensityEstimate estimate_irradiance(const World& world, const PhotonMap& map, const DensityPoint& at,
                                    const DensityOptions& options, Progress& progress) {
    DensityEstimate out;
    if (map.empty()) return out;
    thread_local std::vector<Neighbor> found;
    Disc disc{at.position, at.normal, options.radius};
    auto count = static_cast<size_t>(options.nearest);
    if (options.first_map != nullptr) {
        disc.radius = options.part_of_radius * options.first_map->nearest(disc, count, options.max_edges, found);
        count = map.photons().size();
    }
    const float radius = map.nearest(disc, count, options.max_edges, found);
    out.radius = radius;
    if (found.empty() || !(radius > 0) || radius == infinity) return out;
    return Estimate(world, map, at, options, radius, progress).irradiance(found);
}

}  // namespace eclat
