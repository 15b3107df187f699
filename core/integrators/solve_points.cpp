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

enum Stream : uint32_t { far_stream = 31, near_stream, surface_stream };

constexpr size_t far_round = 512;  // candidates for far records that are thinned among each other
constexpr size_t first_pass = 64;  // candidates of the coarsest pass; each later one doubles what has been tried

using Candidates = std::vector<Candidate>;

float pixel_without_camera(const World& world) { return 2 * world.geometry.radius() / 1000; }

/// Those that `cache` does not serve.
Candidates unserved(const RecordCache& cache, const Candidates& candidates, int threads) {
    const auto served = parallel_map<uint8_t>(candidates.size(), threads, [&](size_t i) {
        return static_cast<uint8_t>(cache.serves(candidates[i].position, candidates[i].normal));
    });
    Candidates out;
    for (size_t i = 0; i < candidates.size(); ++i)
        if (!served[i]) out.push_back(candidates[i]);
    return out;
}

/// In order, those that lie apart from the ones before: one record serves two points that are close to each other.
Candidates thinned(const Candidates& candidates, float distance) {
    constexpr float same_side = 0.9f;  // cosine, about the angle at which a record's validity ends
    Candidates out;
    for (const Candidate& c : candidates)
        if (std::none_of(out.begin(), out.end(), [&](const Candidate& o) {
                return length_squared(o.position - c.position) < sqr(distance) &&
                       dot(o.shading_normal, c.shading_normal) > same_side;
            }))
            out.push_back(c);
    return out;
}

/// Adds coarse records, the ones in which gather rays may end.
void add_far(const World& world, const Candidates& candidates, const IrradianceCacheOptions& options, RecordCache& far,
             Progress& progress) {
    constexpr float spacing = 0.5f;  // coarser than near ones: they only feed averages over whole hemispheres
    const float least = 0.01f * world.geometry.radius(), largest = 0.2f * world.geometry.radius();
    const RecordCache none;
    auto records = gather_records(world, thinned(unserved(far, candidates, options.threads), 2 * least), none, options,
                                  far_stream, options.far_rows, progress);
    for (IrradianceRecord& r : records) {
        r.least_radius = least;
        r.largest_radius = largest;
        r.radius = clamp(spacing * r.distance, least, largest);
    }
    far.insert(records, spacing, options.threads);
    progress.advance();
}

/// Diffuse points that cosine-distributed rays from the given points meet: rays [first, end) of a sequence that takes
/// the points in turn.
Candidates met_from(const World& world, std::span<const PointNormal> points, size_t first, size_t end,
                    const IrradianceCacheOptions& options, Progress& progress) {
    std::vector<Ray> rays;
    for (size_t i = first; i < end; ++i) {
        const auto from = static_cast<uint32_t>(i % points.size());
        Sampler sampler(options.seed ^ hash(far_stream), from, static_cast<uint32_t>(i / points.size()));
        const SurfacePoint point = bare_point(world, points[from]);
        rays.push_back(point.ray(point.frame.to_world(square_to_cosine_hemisphere(sampler.next_2d()))));
    }
    std::vector<Hit> hits(rays.size());
    world.geometry.rays().intersect(rays, hits);
    progress.count_rays(rays.size());
    Candidates out;
    for (size_t i = 0; i < rays.size(); ++i) {
        if (hits[i].missed()) continue;
        const SurfacePoint point = world.geometry.surface_point(hits[i], -rays[i].direction);
        if (point.bsdf.has(LobeSet::diffuse)) out.emplace_back(point, 0.0f);
    }
    return out;
}

/// One pass: the candidates that are not yet served get records. Returns how many were tried and how many got one.
struct PassCount {
    size_t tried = 0, added = 0;
};
PassCount add_near(const World& world, const Candidates& candidates, const IrradianceCacheOptions& options,
                   SolvedCaches& caches, Progress& progress) {
    const Candidates wanted = unserved(caches.near, candidates, options.threads);
    const auto records = gather_records(world, wanted, caches.far, options, near_stream, options.rows, progress);
    caches.near.insert(records, options.spacing, options.threads);
    progress.advance();
    return {candidates.size(), wanted.size()};
}

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
            add_sides({triangle, 0, s * (1 - across), s * across}, out);
        }
        return out;
    }

  private:
    void add_sides(const Hit& hit, Candidates& out) const {
        const Vec3 front = world_.geometry.geometric_normal(hit.triangle);
        for (const Vec3 wo : {front, -front}) {
            const SurfacePoint point = world_.geometry.surface_point(hit, wo);
            const Vec3 local = point.frame.to_local(wo);
            if (local.z > 0 && !is_black(point.bsdf.diffuse_albedo(local)))
                out.emplace_back(point, pixel_without_camera(world_));
        }
    }

    const World& world_;
    std::vector<double> cumulative_;  // area up to and with each triangle
};

}  // namespace

CacheOptions far_reading(const CacheOptions& near) {
    CacheOptions far = near;
    far.relaxation = 1.4f;
    far.rotation_gradient = false;
    return far;
}

void solve_at_points(const World& world, std::span<const PointNormal> points, const IrradianceCacheOptions& options,
                     SolvedCaches& caches, Progress& progress) {
    constexpr int retries = 3;  // clamping by later records may leave a point unserved that was served
    caches = {RecordCache(options.cache), RecordCache(far_reading(options.cache))};
    size_t coarsest = 1;
    while (points.size() / coarsest > first_pass) coarsest *= 2;
    const auto passes = static_cast<uint64_t>(std::bit_width(coarsest));

    const size_t far_count = options.max_depth < 0 && !points.empty() ? static_cast<size_t>(options.far_records) : 0;
    std::vector<PointNormal> sources;
    const size_t apart = std::max<size_t>(1, points.size() / far_round);
    for (size_t i = 0; i < points.size(); i += apart) sources.push_back(points[i]);

    progress.begin((far_count + far_round - 1) / far_round + passes + retries);
    for (size_t i = 0; i < far_count; i += far_round)
        add_far(world, met_from(world, sources, i, std::min(far_count, i + far_round), options, progress), options,
                caches.far, progress);

    const auto every = [&](size_t step, size_t first) {
        Candidates out;
        for (size_t i = first; i < points.size(); i += step)
            out.emplace_back(bare_point(world, points[i]), pixel_without_camera(world));
        return out;
    };
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
    caches = {RecordCache(options.cache), RecordCache(far_reading(options.cache))};
    const SurfacePoints surface(world);
    if (surface.empty()) return;
    const size_t far_count = options.max_depth < 0 ? static_cast<size_t>(options.far_records) : 0;
    const auto far_rounds = static_cast<uint32_t>((far_count + far_round - 1) / far_round);
    progress.begin(far_rounds + passes);
    for (uint32_t round = 0; round < far_rounds; ++round)
        add_far(world, surface.spread(far_round, passes + round, options.seed), options, caches.far, progress);
    for (uint32_t pass = 0; pass < passes; ++pass) {
        const size_t count = first_pass << pass;
        const PassCount done = add_near(world, surface.spread(count, pass, options.seed), options, caches, progress);
        if (pass + 1 >= least_passes &&
            static_cast<double>(done.added) < unserved_part * static_cast<double>(done.tried))
            break;
    }
}

}  // namespace eclat
