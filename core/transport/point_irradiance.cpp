// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "transport/point_irradiance.h"

#include "base/parallel.h"
#include "base/precision.h"

namespace eclat {

namespace {

constexpr uint32_t path_dimension = 8;  // where a path's numbers begin, after those of the light sample

/// Mean over all samples of a point, of which `block(first, end)` returns a part's sum: a block at a time, so that memory
/// and the wait after a cancelled progress are bounded.
template <class Block>
Color mean_over_samples(const PointIrradianceOptions& options, Progress& progress, Block&& block) {
    constexpr int samples_at_once = 4096;
    Color sum;
    for (int first = 0; first < options.samples; first += samples_at_once) {
        progress.check();
        sum += block(first, std::min(options.samples, first + samples_at_once));
    }
    return sum / static_cast<float>(options.samples);
}

Color indirect_by_paths(const World& world, const SurfacePoint& point, uint32_t index,
                        const PointIrradianceOptions& options, const CachedIrradiance& far, Progress& progress) {
    PathOptions paths;
    paths.cache = far;
    paths.emission_at_first_hit = false;
    paths.max_depth = options.max_depth < 0 ? -1 : options.max_depth - 1;
    return mean_over_samples(options, progress, [&](int first, int end) {
        std::vector<PathRay> rays;
        for (int s = first; s < end; ++s) {
            Sampler sampler(options.seed, index, static_cast<uint32_t>(s));
            sampler.set_dimension(path_dimension);
            const Vec3 w = square_to_cosine_hemisphere(sampler.next_2d());
            rays.push_back({point.ray(point.frame.to_world(w)), sampler});
        }
        std::vector<PathResult> results(rays.size());
        trace_paths(world, rays, paths, results, progress);
        Color sum;
        for (const PathResult& r : results) sum += r.radiance * pi;
        return sum;
    });
}

bool may_bounce(int max_depth) { return max_depth < 0 || max_depth > 2; }
bool may_arrive(int max_depth) { return max_depth < 0 || max_depth > 1; }

}  // namespace

SurfacePoint bare_point(const World& world, const PointNormal& at) {
    SurfacePoint point;
    point.position = at.position;
    point.normal = at.normal;
    point.frame = Frame::around(at.normal);
    point.offset = coordinate_resolution * (world.geometry.radius() + length(at.position));
    return point;
}

Color direct_irradiance(const World& world, const SurfacePoint& point, uint32_t index, LightSet set,
                        const PointIrradianceOptions& options, Progress& progress) {
    return mean_over_samples(options, progress, [&](int first, int end) {
        std::vector<Ray> rays;
        std::vector<Color> contributions;
        for (int s = first; s < end; ++s) {
            Sampler sampler(options.seed, index, static_cast<uint32_t>(s));
            if (const auto shadow = sample_irradiance(world, point, point.normal, set, sampler)) {
                rays.push_back(shadow->ray);
                contributions.push_back(shadow->contribution);
            }
        }
        std::vector<uint8_t> occluded(rays.size());
        world.geometry.rays().occluded(rays, occluded);
        progress.count_rays(rays.size());
        Color sum;
        for (size_t i = 0; i < rays.size(); ++i)
            if (!occluded[i]) sum += contributions[i];
        return sum;
    });
}

std::vector<Color> path_irradiance(const World& world, std::span<const PointNormal> points,
                                   const PointIrradianceOptions& options, Progress& progress,
                                   const CachedIrradiance& far) {
    progress.begin(points.size());
    return parallel_map<Color>(points.size(), options.threads, [&](size_t i) {
        progress.check();
        const SurfacePoint point = bare_point(world, points[i]);
        const auto index = static_cast<uint32_t>(i);
        Color sum;
        if (options.component != Component::indirect && may_arrive(options.max_depth))
            sum += direct_irradiance(world, point, index, LightSet::all, options, progress);
        if (options.component != Component::direct && may_bounce(options.max_depth))
            sum += indirect_by_paths(world, point, index, options, far, progress);
        progress.advance();
        return sum;
    });
}

}  // namespace eclat
