// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "methods/photon_map/solve_photons.h"

#include "base/parallel.h"

namespace eclat {

TracedPhotons trace_map(const World& world, const PhotonTracing& tracing, Progress& progress) {
    TraceOptions options{.stored = {.caustic = tracing.caustic, .indirect = !tracing.caustic},
                         .max_edges = tracing.max_edges,
                         .seed = tracing.seed,
                         .threads = tracing.threads,
                         .exchange = tracing.exchange};
    if (tracing.guided) options.guide = learn_emission(world, options, progress);
    return trace_until(world, tracing.photons, tracing.most_paths, options, progress);
}

PhotonMaps build_maps(const World& world, StoredPhotons global, StoredPhotons caustic, const MapOptions& options,
                      Progress& progress) {
    PhotonMaps maps;
    maps.global = PhotonMap(global.photons, global.paths, options.threads);
    maps.caustic = PhotonMap(caustic.photons, caustic.paths, options.threads);
    maps.reading.global.nearest = options.nearest;
    maps.reading.caustic.nearest = options.caustic_nearest;
    maps.reading.global.radius = largest_radius(maps.global, options.nearest);
    maps.reading.caustic.radius = largest_radius(maps.caustic, options.caustic_nearest);
    maps.reading.global.kernel = maps.reading.caustic.kernel = options.kernel;
    if (!options.gather) return maps;
    // Irradiance at a quarter of the photons is as good as at all of them [Christensen99].
    constexpr size_t photons_per_place = 4;
    const PhotonTracing places{.photons = global.photons.size() / photons_per_place,
                               .most_paths = static_cast<uint64_t>(global.paths) / photons_per_place + 1,
                               .guided = options.guided,
                               .seed = options.seed,
                               .threads = options.threads};
    maps.precompute(world, trace_map(world, places, progress).photons, options.threads, progress);
    return maps;
}

PhotonMaps progressive_maps(const World& world, uint32_t number, const PhotonMaps* first,
                            const ProgressiveOptions& options, Progress& progress) {
    const TraceOptions tracing{.stored = {.caustic = true, .indirect = true},
                               .max_edges = options.max_edges,
                               .seed = options.seed,
                               .threads = options.threads};
    const uint64_t begin = uint64_t(number) * options.paths;
    const auto photons = trace_photons(world, {begin, begin + options.paths}, tracing, progress);
    PhotonMaps maps;
    maps.global = PhotonMap(photons, options.paths, options.threads);
    DensityOptions& reading = maps.reading.global;
    reading.nearest = options.nearest;
    reading.kernel = options.kernel;
    reading.radius = first ? first->reading.global.radius : largest_radius(maps.global, options.nearest);
    if (first) {
        reading.first_map = &first->global;
        reading.part_of_radius = progressive_radius(number, options.alpha);
    }
    return maps;
}

std::vector<Color> photon_density(const World& world, const PhotonMaps& maps, bool caustic,
                                  std::span<const PointNormal> points, int threads) {
    Progress progress;
    return parallel_map<Color>(points.size(), threads, [&](size_t i) {
        const SurfacePoint point = bare_point(world, points[i]);
        return estimate_irradiance(world, caustic ? maps.caustic : maps.global, {point, point.normal},
                                   caustic ? maps.reading.caustic : maps.reading.global, progress)
            .irradiance;
    });
}

Estimator photon_estimator(const World& world, const PhotonMaps& maps, const PhotonMapOptions& options) {
    return [world, &maps, options](std::span<const PathRay> rays, std::span<PathResult> results, Progress& progress) {
        trace_to_photons(world, maps, options, rays, results, progress);
    };
}

PointEstimator photon_point_estimator(const World& world, const PhotonMaps& maps) {
    return
        [world, &maps](std::span<const PointNormal> points, const PointIrradianceOptions& options, Progress& progress) {
            return PointIrradiance{photon_irradiance(world, points, maps, options, progress), {}};
        };
}

}  // namespace eclat
