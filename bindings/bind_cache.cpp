// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "arrays.h"
#include "methods/irradiance_cache/irradiance_cache.h"
#include "methods/radiance_cache/radiance_cache.h"
#include "methods/irradiance_cache/solve_points.h"
#include "methods/radiance_cache/record_lobes.h"
#include "record_arrays.h"
#include "records/estimated_error.h"
#include "shared_work.h"
#include "world_holder.h"

using namespace eclat;
using namespace nb::literals;

namespace {

RecordCache from_array(const Array<float, -1, -1>& values, const CacheOptions& options, float spacing) {
    RecordCache cache(options);
    cache.insert(records_of(values), spacing, 0);
    return cache;
}

using Halves = Array<uint16_t, -1, -1>;

nb::ndarray<nb::numpy, uint16_t> half_array(const std::vector<uint16_t>& values, size_t rows) {
    auto* owned = new std::vector<uint16_t>(values);
    nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<uint16_t>*>(p); });
    return {owned->data(), {rows, rows ? values.size() / rows : 0}, owner};
}

void bind_record_enums(nb::module_& m) {
    nb::enum_<Weight>(m, "Weight")
        .value("tabellion", Weight::tabellion)
        .value("ward", Weight::ward)
        .value("split_sphere", Weight::split_sphere);
    nb::enum_<Balanced>(m, "Balanced").value("squared", Balanced::squared).value("absolute", Balanced::absolute);
    nb::enum_<Metric>(m, "Metric")
        .value("occlusion", Metric::occlusion)
        .value("radiometric", Metric::radiometric)
        .value("geometric", Metric::geometric)
        .value("minimum", Metric::minimum)
        .value("harmonic", Metric::harmonic);
}

/// Defines a property for a field of the member `cache` of the options.
template <auto member>
void def_cache_option(nb::class_<IrradianceCacheOptions>& type, const char* name) {
    using T = std::remove_reference_t<decltype(std::declval<CacheOptions>().*member)>;
    type.def_prop_rw(
        name, [](const IrradianceCacheOptions& o) { return o.cache.*member; },
        [](IrradianceCacheOptions& o, T value) { o.cache.*member = value; });
}

/// Lists the position of each field of a record in a row of floats: (name, first float, number of floats).
std::vector<std::tuple<const char*, size_t, size_t>> record_layout() {
    using R = IrradianceRecord;
    const auto field = [](const char* name, size_t offset, size_t bytes) {
        return std::tuple(name, offset / sizeof(float), bytes / sizeof(float));
    };
    return {field("positions", offsetof(R, position), sizeof(R::position)),
            field("normals", offsetof(R, normal), sizeof(R::normal)),
            field("irradiance", offsetof(R, irradiance), sizeof(R::irradiance)),
            field("excess", offsetof(R, excess), sizeof(R::excess)),
            field("rotation_gradients", offsetof(R, rotation), sizeof(R::rotation)),
            field("translation_gradients", offsetof(R, translation), sizeof(R::translation)),
            field("distances", offsetof(R, distance), sizeof(R::distance)),
            field("radii", offsetof(R, radius), sizeof(R::radius)),
            field("elongations", offsetof(R, elongation), sizeof(R::elongation)),
            field("axes", offsetof(R, axis), sizeof(R::axis)),
            field("curvatures", offsetof(R, curvature), sizeof(R::curvature)),
            field("least_radii", offsetof(R, least_radius), sizeof(R::least_radius)),
            field("largest_radii", offsetof(R, largest_radius), sizeof(R::largest_radius)),
            field("noises", offsetof(R, own_noise), sizeof(R::own_noise)),
            field("clearances", offsetof(R, clearance), sizeof(R::clearance)),
            field("enclosed", offsetof(R, enclosed), sizeof(R::enclosed))};
}

void bind_record_options(nb::module_& m) {
    nb::class_<IrradianceCacheOptions> options(m, "IrradianceCacheOptions");
    options.def(nb::init<>())
        .def_rw("spacing", &IrradianceCacheOptions::spacing)
        .def_rw("metric", &IrradianceCacheOptions::metric)
        .def_rw("balanced", &IrradianceCacheOptions::balanced)
        .def_rw("disagreement", &IrradianceCacheOptions::disagreement)
        .def_rw("gradient_limit", &IrradianceCacheOptions::gradient_limit)
        .def_rw("obstacle_limit", &IrradianceCacheOptions::obstacle_limit)
        .def_rw("least_pixels", &IrradianceCacheOptions::least_pixels)
        .def_rw("largest_pixels", &IrradianceCacheOptions::largest_pixels)
        .def_rw("rows", &IrradianceCacheOptions::rows)
        .def_rw("far_rows", &IrradianceCacheOptions::far_rows)
        .def_rw("far_spacing", &IrradianceCacheOptions::far_spacing)
        .def_rw("far_records", &IrradianceCacheOptions::far_records)
        .def_prop_rw(
            "far_photons",
            [](const IrradianceCacheOptions& o) { return std::const_pointer_cast<PhotonMaps>(o.far_photons); },
            [](IrradianceCacheOptions& o, std::shared_ptr<PhotonMaps> maps) { o.far_photons = std::move(maps); },
            "maps"_a.none())
        .def_rw("max_depth", &IrradianceCacheOptions::max_depth)
        .def_rw("seed", &IrradianceCacheOptions::seed)
        .def_rw("threads", &IrradianceCacheOptions::threads);
    def_share_work(options);
    def_cache_option<&CacheOptions::weight>(options, "weight");
    def_cache_option<&CacheOptions::relaxation>(options, "relaxation");
    def_cache_option<&CacheOptions::rotation_gradient>(options, "rotation_gradient");
    def_cache_option<&CacheOptions::translation_gradient>(options, "translation_gradient");
    def_cache_option<&CacheOptions::neighbor_clamping>(options, "neighbor_clamping");
    nb::class_<RadianceCacheOptions>(m, "RadianceCacheOptions")
        .def(nb::init<>())
        .def_rw("irradiance", &RadianceCacheOptions::irradiance)
        .def_rw("order", &RadianceCacheOptions::order)
        .def_rw("rows", &RadianceCacheOptions::rows)
        .def_rw("spacing", &RadianceCacheOptions::spacing);
}

void bind_radiance_tables(nb::module_& m) {
    nb::class_<RadianceTables>(m, "RadianceTables")
        .def("__init__", [](RadianceTables* t, const CoreScene& scene, const std::vector<const BrdfTable*>& tables,
                            int order) { new (t) RadianceTables(scene.geometry->materials(), tables, order); });
    m.def(
        "wanted_radiance_tables",
        [](const CoreScene& scene) {
            const auto wanted = RadianceTables::wanted(scene.geometry->materials());
            std::vector<std::tuple<TableLobe::Kind, float, float, bool>> lobes;
            for (const TableLobe& lobe : wanted.lobes)
                lobes.emplace_back(lobe.kind, lobe.u, lobe.v, lobe.masking == Masking::correlated);
            return std::make_tuple(lobes, wanted.roughness);
        },
        "scene"_a);
}

void make_caches(SolvedCaches* place, const Array<float, -1, -1>& near, const Array<float, -1, -1>& far,
                 const IrradianceCacheOptions& options) {
    RecordCache near_cache = from_array(near, options.cache, options.spacing);
    RecordCache far_cache = from_array(far, far_reading(options.cache), options.far_spacing);
    std::construct_at(place, SolvedCaches{std::move(near_cache), std::move(far_cache), {}, 0});
}

/// Returns the irradiance (points, 3) that the near records give at points with normals, and the sum of the weights of the
/// records that serve each point (points,). Both are 0 where none does.
auto read_near_records(const SolvedCaches& caches, const Points& positions, const Points& normals) {
    const auto points = points_with_normals(positions, normals);
    std::vector<Color> values;
    std::vector<float> weights;
    for (const PointNormal& p : points) {
        float sum = 0;
        caches.near.for_each_serving(p.position, p.normal, caches.near.options().relaxation,
                                     [&](uint32_t, float w, const Color&) { sum += w; });
        values.push_back(caches.near.interpolate(p.position, p.normal, p.normal).value_or(Color()));
        weights.push_back(sum);
    }
    auto sums = float_array({weights.size()}, [&](float* data) { std::ranges::copy(weights, data); });
    return std::pair(color_array(values), std::move(sums));
}

/// Returns the estimated error of what `read_near_records` gives (points,), or a negative number where no record serves.
auto estimated_errors_of_near(const SolvedCaches& caches, const Points& positions, const Points& normals) {
    const auto points = points_with_normals(positions, normals);
    return float_array({points.size()}, [&](float* data) {
        for (const PointNormal& p : points)
            *data++ = estimated_error(caches.near, p.position, p.normal).value_or(-1.0f);
    });
}

/// Returns the excess of each record of a cache, averaged over the records around it (records, 3).
template <class Cache>
auto shared_excess(const Cache& cache) {
    std::vector<Color> values;
    for (uint32_t i = 0; i < cache.records().size(); ++i) values.push_back(cache.shared_excess(i));
    return color_array(values);
}

/// Returns the index of the lobe of each radiance record, or -1 (records), and of the lobes towards the directions: the
/// factors (lobes, directions, 3, order²), the widths (lobes, directions) and the albedos (lobes, directions, 3).
auto lobes_at_records(const CoreScene& scene, const SolvedCaches& caches, const RadianceTables& tables,
                      const Points& directions) {
    const std::vector<Vec3> towards = vec3s(directions);
    const RecordLobes found = record_lobes(scene.world(), caches.radiance, tables, towards);
    const size_t lobes = found.lobes.size(), count = towards.size();
    auto indices = float_array({found.lobe_of.size()}, [&](float* data) {
        for (const int lobe : found.lobe_of) *data++ = static_cast<float>(lobe);
    });
    auto factors = float_array({lobes, count, 3, size_t(coefficient_count(tables.order()))}, [&](float* data) {
        for (const RecordLobe& lobe : found.lobes) data = std::ranges::copy(lobe.factors, data).out;
    });
    auto widths = float_array({lobes, count}, [&](float* data) {
        for (const RecordLobe& lobe : found.lobes) data = std::ranges::copy(lobe.widths, data).out;
    });
    auto albedos = float_array({lobes, count, 3}, [&](float* data) {
        for (const RecordLobe& lobe : found.lobes)
            for (const Color& albedo : lobe.albedos)
                for (int c = 0; c < 3; ++c) *data++ = albedo[c];
    });
    return std::make_tuple(std::move(indices), std::move(factors), std::move(widths), std::move(albedos));
}

void bind_solved_caches(nb::module_& m) {
    m.def("record_layout", &record_layout);
    m.def("lobes_at_records", &lobes_at_records, "scene"_a, "caches"_a, "tables"_a, "directions"_a);
    nb::class_<SolvedCaches>(m, "SolvedCaches")
        .def("__init__", &make_caches)
        .def(nb::init<>())
        .def("set_radiance",
             [](SolvedCaches& c, Array<float, -1, -1> records, Array<float, -1, -1> values, Halves gradients,
                const RadianceCacheOptions& o) {
                 RadianceCache cache(o.irradiance.cache, o.order);
                 cache.insert(records_of(records), {values.data(), values.size()}, {gradients.data(), gradients.size()},
                              o.spacing, 0);
                 c.radiance = std::move(cache);
             })
        .def_prop_ro(
            "radiance_records", [](const SolvedCaches& c) { return to_array(c.radiance.records()); },
            nb::rv_policy::move)
        .def_prop_ro(
            "radiance_values",
            [](const SolvedCaches& c) {
                const std::vector<float>& values = c.radiance.values();
                const size_t rows = c.radiance.records().size();
                return float_array({rows, rows ? values.size() / rows : 0},
                                   [&](float* data) { std::copy(values.begin(), values.end(), data); });
            },
            nb::rv_policy::move)
        .def_prop_ro(
            "radiance_gradients",
            [](const SolvedCaches& c) { return half_array(c.radiance.gradients(), c.radiance.records().size()); },
            nb::rv_policy::move)
        .def_prop_ro("radiance_count", [](const SolvedCaches& c) { return c.radiance.records().size(); })
        .def_prop_ro(
            "near", [](const SolvedCaches& c) { return to_array(c.near.records()); }, nb::rv_policy::move)
        .def_prop_ro(
            "far", [](const SolvedCaches& c) { return to_array(c.far.records()); }, nb::rv_policy::move)
        .def_prop_ro(
            "near_shared_excess", [](const SolvedCaches& c) { return shared_excess(c.near); }, nb::rv_policy::move)
        .def_prop_ro(
            "radiance_shared_excess", [](const SolvedCaches& c) { return shared_excess(c.radiance); },
            nb::rv_policy::move)
        .def("read_near", &read_near_records, "positions"_a, "normals"_a,
             "The irradiance (points, 3) that near records give, and the sum of their weights (points,); 0 if none "
             "serves.")
        .def("estimated_errors", &estimated_errors_of_near, "positions"_a, "normals"_a,
             "The estimated error of what `read_near` gives, relative to it (points,); negative if no record serves.")
        .def_prop_ro("near_count", [](const SolvedCaches& c) { return c.near.records().size(); })
        .def_ro("left_to_paths", &SolvedCaches::left_to_paths)
        .def_prop_ro("far_count", [](const SolvedCaches& c) { return c.far.records().size(); });
}

void bind_record_solves(nb::module_& m) {
    // These functions fill `caches` in place, so that it holds the finished passes after an interrupt.
    m.def(
        "solve_for_cameras",
        [](const CoreScene& scene, const std::vector<Camera>& cameras, const IrradianceCacheOptions& options,
           SolvedCaches& caches,
           Progress& progress) { solve_irradiance_cache(scene.world(), cameras, options, caches, progress); },
        "scene"_a, "cameras"_a, "options"_a, "caches"_a, "progress"_a, nb::call_guard<nb::gil_scoped_release>());
    m.def(
        "solve_radiance_for_cameras",
        [](const CoreScene& scene, const std::vector<Camera>& cameras, const RadianceTables& tables,
           const RadianceCacheOptions& options, SolvedCaches& caches,
           Progress& progress) { solve_radiance_cache(scene.world(), cameras, tables, options, caches, progress); },
        "scene"_a, "cameras"_a, "tables"_a, "options"_a, "caches"_a, "progress"_a,
        nb::call_guard<nb::gil_scoped_release>());
    m.def(
        "solve_at_points",
        [](const CoreScene& scene, Points positions, Points normals, const IrradianceCacheOptions& options,
           SolvedCaches& caches, Progress& progress) {
            const auto points = points_with_normals(positions, normals);
            const nb::gil_scoped_release unlocked;
            solve_at_points(scene.world(), points, options, caches, progress);
        },
        "scene"_a, "positions"_a, "normals"_a, "options"_a, "caches"_a, "progress"_a);
    m.def(
        "solve_everywhere",
        [](const CoreScene& scene, const IrradianceCacheOptions& options, SolvedCaches& caches, Progress& progress) {
            solve_everywhere(scene.world(), options, caches, progress);
        },
        "scene"_a, "options"_a, "caches"_a, "progress"_a, nb::call_guard<nb::gil_scoped_release>());
    m.def(
        "solve_radiance_everywhere",
        [](const CoreScene& scene, const RadianceTables& tables, const RadianceCacheOptions& options,
           SolvedCaches& caches,
           Progress& progress) { solve_radiance_everywhere(scene.world(), tables, options, caches, progress); },
        "scene"_a, "tables"_a, "options"_a, "caches"_a, "progress"_a, nb::call_guard<nb::gil_scoped_release>());
}

}  // namespace

void bind_cache(nb::module_& m) {
    bind_record_enums(m);
    bind_record_options(m);
    bind_radiance_tables(m);
    bind_solved_caches(m);
    bind_record_solves(m);
}
