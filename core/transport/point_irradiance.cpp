// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "transport/point_irradiance.h"

#include "base/parallel.h"
#include "sampling/warp.h"
#include "transport/arriving_light.h"

namespace eclat {

namespace {

constexpr uint32_t path_dimension = 8;  // first dimension of a path, after those of the light sample

/// Sums the samples [first, end) of a point in blocks, whose sums `block(first, end)` returns. Blocks bound the memory
/// and the time until a cancellation is noticed.
template <class Block>
Color sum_over_samples(int first, int end, Progress& progress, Block&& block) {
    constexpr int samples_at_once = 4096;
    Color sum;
    for (; first < end; first += samples_at_once) {
        progress.check();
        sum += block(first, std::min(end, first + samples_at_once));
    }
    return sum;
}

Color indirect_by_paths(const World& world, const SurfacePoint& point, uint32_t index,
                        const PointIrradianceOptions& options, const CachedIrradiance& far, Progress& progress) {
    PathOptions paths;
    paths.cache = far;
    paths.emission_at_first_hit = false;
    paths.max_depth = options.max_depth < 0 ? -1 : options.max_depth - 1;
    const Color sum = sum_over_samples(0, options.samples, progress, [&](int first, int end) {
        std::vector<PathRay> rays;
        for (int s = first; s < end; ++s) {
            Sampler sampler(options.seed, options.first + index, static_cast<uint32_t>(s));
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
    return sum / static_cast<float>(options.samples);
}

/// Computes direct light from light samples and half as many cosine-distributed directions.
class DirectSampler {
  public:
    DirectSampler(const World& world, const SurfacePoint& point, LightSet set, const PointIrradianceOptions& options)
        : receiver_{point},
          seed_(options.seed),
          light_(world, receiver_, set,
                 static_cast<float>((options.samples + samples_per_direction - 1) / samples_per_direction) /
                     static_cast<float>(options.samples)) {}

    /// For samples [first, end), as if each had all of its light and half a direction.
    Color sum(uint32_t index, int first, int end, Progress& progress) {
        Color sum;
        const auto add = [&](Vec3 w, Color radiance) { sum += radiance * dot(w, receiver_.point.normal); };
        samplers_.clear();
        for (int s = first; s < end; ++s) samplers_.emplace_back(seed_, index, static_cast<uint32_t>(s));
        light_.sample_lights(samplers_, progress, add);
        directions_.clear();
        const uint32_t seed = stream_seed(seed_, Stream::point_arrivals);
        // Every second sample has a direction, and the number of the direction follows from that of the sample, so that
        // parts of the samples may begin anywhere.
        for (int s = first + first % samples_per_direction; s < end; s += samples_per_direction) {
            Sampler sampler(seed, index, static_cast<uint32_t>(s / samples_per_direction));
            directions_.push_back(receiver_.direction(sampler.next_2d()));
        }
        light_.meet_lights(directions_, progress, add);
        return sum;
    }

  private:
    static constexpr int samples_per_direction = 2;

    HemisphereReceiver receiver_;
    uint32_t seed_;
    ArrivingLight<HemisphereReceiver> light_;
    std::vector<Sampler> samplers_;
    std::vector<Vec3> directions_;
};

bool may_bounce(int max_depth) { return max_depth < 0 || max_depth > 2; }
bool may_arrive(int max_depth) { return max_depth < 0 || max_depth > 1; }

}  // namespace

SurfacePoint bare_point(const World& world, const PointNormal& at) {
    SurfacePoint point;
    point.position = at.position;
    point.normal = at.normal;
    point.frame = Frame::around(at.normal);
    point.offset = world.geometry.ray_offset(at.position, at.normal);
    return point;
}

Color direct_irradiance(const World& world, const SurfacePoint& point, uint32_t index, LightSet set,
                        const PointIrradianceOptions& options, Progress& progress) {
    DirectSampler sampler(world, point, set, options);
    const auto sum = [&](int from, int to) {
        return sum_over_samples(from, to, progress, [&](int first, int end) {
            return sampler.sum(options.first + index, first, end, progress);
        });
    };
    // The standard error of the mean is half the difference between the two halves of the samples.
    const int first_half = (options.samples + 1) / 2, second_half = options.samples - first_half;
    const Color first = sum(0, first_half), second = sum(first_half, options.samples);
    if (!options.direct_errors.empty() && second_half > 0) {
        const float difference =
            luminance(first / static_cast<float>(first_half)) - luminance(second / static_cast<float>(second_half));
        // Squares of floats do not overflow as doubles; std::hypot would need glibc 2.35.
        const double before = options.direct_errors[index], found = 0.5 * difference;
        options.direct_errors[index] = static_cast<float>(std::sqrt(before * before + found * found));
    }
    return (first + second) / static_cast<float>(options.samples);
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
