// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <cstring>

#include "arrays.h"
#include "estimators.h"
#include "methods/photon_map/solve_photons.h"
#include "shared_work.h"
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

StoredPhotons stored(const std::vector<Photon>& photons, double paths) { return {photons, paths}; }

/// Returns photons and the number of paths that were emitted for them.
auto trace(const CoreScene& scene, const PhotonTracing& tracing, Progress& progress) {
    TracedPhotons traced;
    {
        const nb::gil_scoped_release unlocked;
        traced = trace_map(scene.world(), tracing, progress);
    }
    return std::make_tuple(to_array(traced.photons), traced.paths);
}

using PhotonsAndPaths = std::pair<PhotonArray, double>;

PhotonMaps build(const CoreScene& scene, const PhotonsAndPaths& global, const PhotonsAndPaths& caustic,
                 const MapOptions& options, Progress& progress) {
    const auto global_photons = photons_of(global.first), caustic_photons = photons_of(caustic.first);
    const nb::gil_scoped_release unlocked;
    return build_maps(scene.world(), stored(global_photons, global.second), stored(caustic_photons, caustic.second),
                      options, progress);
}

auto density(const CoreScene& scene, Points positions, Points normals, const PhotonMaps& maps, bool caustic,
             int threads) {
    const auto points = points_with_normals(positions, normals);
    std::vector<Color> values;
    {
        const nb::gil_scoped_release unlocked;
        values = photon_density(scene.world(), maps, caustic, points, threads);
    }
    return color_array(values);
}

void bind_options(nb::module_& m) {
    nb::enum_<Kernel>(m, "Kernel")
        .value("uniform", Kernel::uniform)
        .value("cone", Kernel::cone)
        .value("epanechnikov", Kernel::epanechnikov);
    nb::class_<PhotonTracing> tracing(m, "PhotonTracing");
    tracing.def(nb::init<>())
        .def_rw("caustic", &PhotonTracing::caustic)
        .def_rw("photons", &PhotonTracing::photons)
        .def_rw("most_paths", &PhotonTracing::most_paths)
        .def_rw("max_edges", &PhotonTracing::max_edges)
        .def_rw("guided", &PhotonTracing::guided)
        .def_rw("seed", &PhotonTracing::seed)
        .def_rw("threads", &PhotonTracing::threads);
    def_share_work(tracing);
    nb::class_<MapOptions>(m, "PhotonMapReading")
        .def(nb::init<>())
        .def_rw("nearest", &MapOptions::nearest)
        .def_rw("caustic_nearest", &MapOptions::caustic_nearest)
        .def_rw("kernel", &MapOptions::kernel)
        .def_rw("gather", &MapOptions::gather)
        .def_rw("guided", &MapOptions::guided)
        .def_rw("seed", &MapOptions::seed)
        .def_rw("threads", &MapOptions::threads);
    nb::class_<ProgressiveOptions>(m, "ProgressiveOptions")
        .def(nb::init<>())
        .def_rw("paths", &ProgressiveOptions::paths)
        .def_rw("nearest", &ProgressiveOptions::nearest)
        .def_rw("kernel", &ProgressiveOptions::kernel)
        .def_rw("alpha", &ProgressiveOptions::alpha)
        .def_rw("max_edges", &ProgressiveOptions::max_edges)
        .def_rw("seed", &ProgressiveOptions::seed)
        .def_rw("threads", &ProgressiveOptions::threads);
}

}  // namespace

void bind_photons(nb::module_& m) {
    bind_options(m);
    nb::class_<PhotonMaps>(m, "PhotonMaps");
    m.def("trace_photons", &trace, "scene"_a, "tracing"_a, "progress"_a);
    m.def("photon_maps", &build, "scene"_a, "stored"_a, "caustic"_a, "options"_a, "progress"_a,
          "Maps from pairs of (photons, 13) arrays and the paths that were emitted for them.");
    m.def(
        "progressive_maps",
        [](const CoreScene& scene, uint32_t number, const PhotonMaps* first, const ProgressiveOptions& options,
           Progress& progress) { return progressive_maps(scene.world(), number, first, options, progress); },
        "scene"_a, "number"_a, "first"_a.none(), "options"_a, "progress"_a, nb::keep_alive<0, 3>(),
        nb::call_guard<nb::gil_scoped_release>());
    m.def("photon_density", &density, "scene"_a, "positions"_a, "normals"_a, "maps"_a, "caustic"_a, "threads"_a);
    m.def(
        "photon_estimator",
        [](const CoreScene& scene, const PhotonMaps& maps, int gather_rays, int max_depth) {
            return EstimatorHolder{photon_estimator(scene.world(), maps, {gather_rays, max_depth})};
        },
        nb::keep_alive<0, 1>(), nb::keep_alive<0, 2>(), "scene"_a, "maps"_a, nb::kw_only(), "gather_rays"_a,
        "max_depth"_a);
    m.def(
        "photon_point_estimator",
        [](const CoreScene& scene, const PhotonMaps& maps) {
            return PointEstimatorHolder{photon_point_estimator(scene.world(), maps)};
        },
        nb::keep_alive<0, 1>(), nb::keep_alive<0, 2>(), "scene"_a, "maps"_a);
}
