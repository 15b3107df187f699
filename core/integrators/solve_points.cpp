// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Irradiance caches without a camera: for points that are given, or for all diffuse surfaces.
//
// Departures   Without a camera there are no pixels to bound a record's radius. A thousandth of the scene's diameter
//              stands for one, as if the scene filled a picture of that width; the bounds in pixels keep their meaning.
// Held to      tests/integrators/test_solve_points.py

#include "integrators/solve_points.h"

#include <algorithm>
#include <bit>

#include "base/parallel.h"

namespace eclat {

namespace {

constexpr uint32_t surface_stream = 33;

constexpr size_t first_pass = 64;  // candidates of the coarsest pass; each later one doubles what has been tried

using Candidates = std::vector<Candidate>;

float pixel_without_camera(const World& world) { return 2 * world.geometry.radius() / 1000; }

/// Points spread evenly over the area of all triangles.
class SurfacePoints {
  public:
    explicit SurfacePoints(const World& world) : world_(world) {
        const Geometry& g = world.geometry;
        double sum = 0;  // double: the areas of millions of triangles
        for (uint32_t t = 0; t < g.triangle_count(); ++t) {
            const Vec3 a = g.vertex(t, 0);
            sum += 0.5 * length(cross(g.vertex(t, 1) - a, g.vertex(t, 2) - a));
            cumulative_.push_back(sum);
        }
    }

    bool empty() const { return cumulative_.empty() || !(cumulative_.back() > 0); }

    /// `count` points, on each side that reflects diffusely. Point i lies at i / count of the area and, within its
    /// triangle, at the radical inverse of i: Hammersley's points, turned by random numbers of `pass`.
    Candidates spread(size_t count, uint32_t pass, uint32_t seed) const {
        const uint32_t key = hash(seed ^ hash(surface_stream), pass);
        const double shift = to_unit_float(hash(key, 0));
        Candidates out;
        for (size_t i = 0; i < count; ++i) {
            const double at = (static_cast<double>(i) + shift) / static_cast<double>(count) * cumulative_.back();
            const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, at);
            const auto triangle = static_cast<uint32_t>(found - cumulative_.begin());
            const double below = triangle == 0 ? 0 : cumulative_[triangle - 1];
            const double area = *found - below;  // 0 only if a last triangle without area stands in for rounding
            const auto within = area > 0 ? static_cast<float>(clamp((at - below) / area, 0.0, 1.0)) : 0.0f;
            const float across = to_unit_float(reverse_bits(static_cast<uint32_t>(i)) ^ hash(key, 1));
            const float s = std::sqrt(within);
            add_sides({triangle, 0, s * (1 - across), s * across}, hash(key, static_cast<uint32_t>(i)), out);
        }
        return out;
    }

  private:
    void add_sides(const Hit& hit, uint32_t key, Candidates& out) const {
        const Vec3 front = world_.geometry.geometric_normal(hit.triangle);
        for (const Vec3 wo : {front, -front}) {
            const SurfacePoint point = world_.geometry.surface_point(hit, wo);
            const Vec3 local = point.frame.to_local(wo);
            if (local.z > 0 && !is_black(point.bsdf.diffuse_albedo(local)))
                out.emplace_back(point, pixel_without_camera(world_), hash(key, static_cast<uint32_t>(out.size() & 1)));
        }
    }

    const World& world_;
    std::vector<double> cumulative_;  // area up to and with each triangle
};

}  // namespace

void solve_at_points(const World& world, std::span<const PointNormal> points, const IrradianceCacheOptions& options,
                     SolvedCaches& caches, Progress& progress) {
    constexpr int retries = 3;  // clamping by later records may leave a point unserved that was served
    caches = empty_caches(options);
    size_t coarsest = 1;
    while (points.size() / coarsest > first_pass) coarsest *= 2;
    const auto passes = static_cast<uint64_t>(std::bit_width(coarsest));
    progress.begin(far_passes(options) + passes + retries);

    const auto every = [&](size_t step, size_t first) {
        Candidates out;
        for (size_t i = first; i < points.size(); i += step)
            out.emplace_back(bare_point(world, points[i]), pixel_without_camera(world), static_cast<uint32_t>(i));
        return out;
    };
    solve_far(world, every(1, 0), options, caches, progress);
    // Each pass takes the points halfway between those of all passes before.
    add_near(world, every(coarsest, 0), options, caches, progress);
    for (size_t step = coarsest; step > 1; step /= 2) add_near(world, every(step, step / 2), options, caches, progress);
    for (int retry = 0; retry < retries; ++retry) add_near(world, every(1, 0), options, caches, progress);
}

void solve_everywhere(const World& world, const IrradianceCacheOptions& options, SolvedCaches& caches,
                      Progress& progress) {
    constexpr int passes = 13;              // up to half a million candidates in all
    constexpr int least_passes = 7;         // 4096 candidates: fewer say nothing about the rest
    constexpr double unserved_part = 2e-3;  // of a pass; misses so rare cost less, answered while reading
    caches = empty_caches(options);
    const SurfacePoints surface(world);
    if (surface.empty()) return;
    constexpr size_t far_round = 512;
    const size_t far_count = options.max_depth < 0 ? static_cast<size_t>(options.far_records) : 0;
    const auto far_rounds = static_cast<uint32_t>((far_count + far_round - 1) / far_round);
    progress.begin(far_rounds + passes);
    for (uint32_t round = 0; round < far_rounds; ++round)
        add_far(world, surface.spread(far_round, passes + round, options.seed), options, caches, progress);
    for (uint32_t pass = 0; pass < passes; ++pass) {
        const size_t count = first_pass << pass;
        const auto candidates = surface.spread(count, pass, options.seed);
        const size_t added = add_near(world, candidates, options, caches, progress);
        if (pass + 1 >= least_passes &&
            static_cast<double>(added) < unserved_part * static_cast<double>(candidates.size()))
            break;
    }
}

std::vector<PointNormal> points_everywhere(const World& world, size_t count, uint32_t seed) {
    constexpr uint32_t no_pass = 1u << 20;
    const SurfacePoints surface(world);
    std::vector<PointNormal> out;
    if (surface.empty()) return out;
    for (const Candidate& c : surface.spread(count, no_pass, seed)) out.push_back({c.position, c.normal});
    return out;
}

}  // namespace eclat
