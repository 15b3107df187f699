// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/irradiance_cache/cached_irradiance.h"

#include "base/parallel.h"

namespace eclat {

namespace {

/// Returns the light of `component` that the caches do not contain. The environment image is excluded, because they
/// contain it.
Color beside_cache(const World& world, const SurfacePoint& point, uint32_t index, const PointIrradianceOptions& options,
                   Progress& progress) {
    if (options.component == Component::indirect && !world.lights.has_environment_image()) return {};
    Color sum = direct_irradiance(world, point, index, LightSet::without_smooth_environment, options, progress);
    if (options.component == Component::indirect)
        sum = sum - direct_irradiance(world, point, index, LightSet::all, options, progress);
    return sum;
}

}  // namespace

CachedPoints cached_irradiance(const World& world, std::span<const PointNormal> points, const SolvedCaches& caches,
                               const IrradianceCacheOptions& cache_options, const PointIrradianceOptions& options,
                               Progress& progress) {
    constexpr size_t block = 256;  // number of points between two reports of progress
    progress.begin(points.size());
    CachedPoints out;
    out.irradiance.resize(points.size());
    for (size_t begin = 0; begin < points.size(); begin += block) {
        const size_t count = std::min(block, points.size() - begin);
        std::vector<Candidate> missed;
        std::vector<size_t> missed_index;
        for (size_t i = begin; i < begin + count; ++i) {
            // The strict test is used, because the records may have been made for a view that does not show this point,
            // and with the relaxed test neighbouring records would be read under the edge of a panel.
            const auto E = caches.near.serves(points[i].position, points[i].normal)
                               ? caches.near.interpolate(points[i].position, points[i].normal, points[i].normal)
                               : std::nullopt;
            if (E) {
                out.irradiance[i] = *E;
            } else {
                missed.emplace_back(bare_point(world, points[i]), 0.0f, options.first + static_cast<uint32_t>(i));
                missed_index.push_back(i);
            }
        }
        const auto gathered = gather_records(world, missed, far_end(world, caches, cache_options, progress),
                                             cache_options, Stream::point_gathers, cache_options.rows, progress);
        // A single gather has no neighbours to average the excess over, so its estimate is the sum of both parts.
        for (size_t k = 0; k < gathered.size(); ++k)
            out.irradiance[missed_index[k]] = gathered[k].irradiance + gathered[k].excess;
        out.gathered += missed.size();
        out.served += count - missed.size();
        parallel_for(count, options.threads, [&](size_t k) {
            progress.check();
            const size_t i = begin + k;
            out.irradiance[i] +=
                beside_cache(world, bare_point(world, points[i]), static_cast<uint32_t>(i), options, progress);
            progress.advance();
        });
    }
    return out;
}

}  // namespace eclat
