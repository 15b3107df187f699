// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cstring>

#include "arrays.h"
#include "base/parallel.h"
#include "methods/photon_map/photon_gathering.h"
#include "methods/photon_map/trace_photons.h"
#include "render_range.h"
#include "world_holder.h"

using namespace eclat;
using namespace nb::literals;

namespace {

constexpr size_t floats_per_photon = sizeof(Photon) / sizeof(float);
using PhotonArray = Array<float, -1, floats_per_photon>;

/// (photons, 13): position, power, direction, normal, edges.
auto to_array(const std::vector<Photon>& photons) {
    return float_array({photons.size(), floats_per_photon}, [&](float* data) {
        if (!photons.empty()) std::memcpy(data, photons.data(), photons.size() * sizeof(Photon));
    });
}

std::vector<Photon> photons_of(const PhotonArray& values) {
    std::vector<Photon> photons(values.shape(0));
    if (!photons.empty())
        std::memcpy(static_cast<void*>(photons.data()), values.data(), photons.size() * sizeof(Photon));
    return photons;
}

/// Photons and the number of paths that were emitted for them.
auto trace(const CoreScene& scene, Progress& progress, bool caustic, size_t wanted, uint64_t most_paths, int max_edges,
           bool guided, uint32_t seed, int threads) {
    TracedPhotons traced;
    {
        const nb::gil_scoped_release unlocked;
        TraceOptions options{.stored = {.caustic = caustic, .indirect = !caustic},
                             .max_edges = max_edges,
                             .seed = seed,
                             .threads = threads};
        if (guided) options.guide = learn_emission(scene.world(), options, progress);
        traced = trace_until(scene.world(), wanted, most_paths, options, progress);
    }
    return std::make_tuple(to_array(traced.photons), traced.paths);
}

PhotonMaps build(const CoreScene& scene, Progress& progress, PhotonArray global, double global_paths,
                 PhotonArray caustic, double caustic_paths, std::array<int, 2> nearest, int kernel,
                 std::optional<std::pair<uint32_t, bool>> places, int threads) {
    const auto global_photons = photons_of(global), caustic_photons = photons_of(caustic);
    const nb::gil_scoped_release unlocked;
    PhotonMaps maps;
    maps.global = PhotonMap(global_photons, global_paths, threads);
    maps.caustic = PhotonMap(caustic_photons, caustic_paths, threads);
    maps.reading.global.nearest = nearest[0];
    maps.reading.caustic.nearest = nearest[1];
    maps.reading.global.radius = largest_radius(scene.world(), global_photons.size(), nearest[0]);
    maps.reading.caustic.radius = largest_radius(scene.world(), caustic_photons.size(), nearest[1]);
    maps.reading.global.kernel = maps.reading.caustic.kernel = static_cast<Kernel>(kernel);
    if (places) {
        const auto [seed, guided] = *places;
        // A quarter of the photons is as good as all [Christensen99].
        constexpr size_t photons_per_place = 4;
        TraceOptions options{.stored = {.indirect = true}, .seed = seed, .threads = threads};
        if (guided) options.guide = learn_emission(scene.world(), options, progress);
        const auto most_paths = static_cast<uint64_t>(global_paths) / photons_per_place + 1;
        const auto traced =
            trace_until(scene.world(), global_photons.size() / photons_per_place, most_paths, options, progress);
        maps.precompute(scene.world(), traced.photons, threads, progress);
    }
    return maps;
}

/// The maps of one pass of progressive photon mapping: photons of all kinds in the global one. `first` are those of pass 0.
PhotonMaps build_pass(const CoreScene& scene, Progress& progress, uint32_t pass, uint32_t paths,
                      const PhotonMaps* first, int nearest, int kernel, float alpha, int max_edges, uint32_t seed,
                      int threads) {
    const TraceOptions options{
        .stored = {.caustic = true, .indirect = true}, .max_edges = max_edges, .seed = seed, .threads = threads};
    const uint64_t begin = uint64_t(pass) * paths;
    const auto photons = trace_photons(scene.world(), {begin, begin + paths}, options, progress);
    PhotonMaps maps;
    maps.global = PhotonMap(photons, paths, threads);
    maps.reading.global.nearest = nearest;
    maps.reading.global.kernel = static_cast<Kernel>(kernel);
    maps.reading.global.radius =
        first ? first->reading.global.radius : largest_radius(scene.world(), photons.size(), nearest);
    if (first) {
        maps.reading.global.first_map = &first->global;
        maps.reading.global.part_of_radius = progressive_radius(pass, alpha);
    }
    return maps;
}

void render_photons(const CoreScene& scene, const Camera& camera, Film& film, Progress& progress,
                    const PhotonMaps& maps, int gather_rays, int max_depth, SampleCounts first, SampleCounts end,
                    std::array<int, 4> crop, uint32_t seed, int threads, int filter, std::vector<uint32_t> tile_order) {
    const World world = scene.world();
    const PhotonMapOptions options{gather_rays, max_depth};
    const Estimator estimate = [&](std::span<const PathRay> rays, std::span<PathResult> results, Progress& counted) {
        trace_to_photons(world, maps, options, rays, results, counted);
    };
    render(camera, estimate, render_range(first, end, crop, seed, threads, filter, std::move(tile_order)), film,
           progress);
}

auto irradiance_at_points(const CoreScene& scene, Points positions, Points normals, const PhotonMaps& maps,
                          Progress& progress, int component, int samples, int max_depth, uint32_t seed, int threads) {
    const auto points = points_with_normals(positions, normals);
    const PointIrradianceOptions options{static_cast<Component>(component), samples, max_depth, seed, threads};
    std::vector<Color> values;
    {
        const nb::gil_scoped_release unlocked;
        values = photon_irradiance(scene.world(), points, maps, options, progress);
    }
    return color_array(values);
}

/// Irradiance of the photons of one map, without direct light: what its density says.
auto density(const CoreScene& scene, Points positions, Points normals, const PhotonMaps& maps, bool caustic,
             int threads) {
    const auto points = points_with_normals(positions, normals);
    std::vector<Color> values(points.size());
    {
        const nb::gil_scoped_release unlocked;
        const World world = scene.world();
        Progress progress;
        parallel_for(points.size(), threads, [&](size_t i) {
            const SurfacePoint point = bare_point(world, points[i]);
            values[i] = estimate_irradiance(world, caustic ? maps.caustic : maps.global, {point, point.normal},
                                            caustic ? maps.reading.caustic : maps.reading.global, progress)
                            .irradiance;
        });
    }
    return color_array(values);
}

}  // namespace

void bind_photons(nb::module_& m) {
    nb::class_<PhotonMaps>(m, "PhotonMaps")
        .def("__init__", [](PhotonMaps* maps, const CoreScene& scene, Progress& progress, PhotonArray global,
                            double global_paths, PhotonArray caustic, double caustic_paths, std::array<int, 2> nearest,
                            int kernel, std::optional<std::pair<uint32_t, bool>> places, int threads) {
            new (maps) PhotonMaps(
                build(scene, progress, global, global_paths, caustic, caustic_paths, nearest, kernel, places, threads));
        });
    m.def("trace_photons", &trace, "scene"_a, "progress"_a, "caustic"_a, "wanted"_a, "most_paths"_a, "max_edges"_a,
          "guided"_a, "seed"_a, "threads"_a);
    m.def("photons_of_pass", &build_pass, "scene"_a, "progress"_a, "pass_"_a, "paths"_a, "first"_a.none(), "nearest"_a,
          "kernel"_a, "alpha"_a, "max_edges"_a, "seed"_a, "threads"_a, nb::keep_alive<0, 5>(),
          nb::call_guard<nb::gil_scoped_release>());
    m.def("render_photons", &render_photons, "scene"_a, "camera"_a, "film"_a, "progress"_a, "maps"_a, "gather_rays"_a,
          "max_depth"_a, "first"_a, "end"_a, "crop"_a, "seed"_a, "threads"_a, "filter"_a, "tile_order"_a,
          nb::call_guard<nb::gil_scoped_release>());
    m.def("irradiance_by_photons", &irradiance_at_points, "scene"_a, "positions"_a, "normals"_a, "maps"_a, "progress"_a,
          "component"_a, "samples"_a, "max_depth"_a, "seed"_a, "threads"_a);
    m.def("photon_density", &density, "scene"_a, "positions"_a, "normals"_a, "maps"_a, "caustic"_a, "threads"_a);
}
