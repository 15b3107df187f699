// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "base/error.h"
#include "estimators.h"
#include "methods/radiosity/radiosity_estimator.h"
#include "methods/radiosity/solve_radiosity.h"
#include "world_holder.h"

using namespace eclat;
using namespace nb::literals;

namespace {

// The name of a patch has four numbers: the triangle; flags (1 for the back, 2 for unknown light); and the lower and
// the upper half of its path.
using PatchNames = Array<uint32_t, -1, 4>;
// The values of a patch are its direct and total irradiance, albedo, and emitted and transmitted radiosity.
using PatchValues = Array<float, -1, 15>;

constexpr uint32_t back_bit = 1, unknown_bit = 2;

auto names_of(const std::vector<SolvedPatch>& patches) {
    auto* data = new uint32_t[4 * patches.size()];
    nb::capsule owner(data, [](void* p) noexcept { delete[] static_cast<uint32_t*>(p); });
    for (size_t i = 0; i < patches.size(); ++i) {
        const SolvedPatch& p = patches[i];
        data[4 * i] = p.name.triangle;
        data[4 * i + 1] = (p.name.back ? back_bit : 0) | (p.unknown ? unknown_bit : 0);
        data[4 * i + 2] = static_cast<uint32_t>(p.name.path);
        data[4 * i + 3] = static_cast<uint32_t>(p.name.path >> 32);
    }
    return nb::ndarray<nb::numpy, uint32_t>(data, {patches.size(), 4}, owner);
}

auto values_of(const std::vector<SolvedPatch>& patches) {
    return float_array({patches.size(), 15}, [&](float* data) {
        for (const SolvedPatch& p : patches)
            for (const Color& c : {p.direct, p.total, p.albedo, p.emitted, p.transmitted})
                for (int k = 0; k < 3; ++k) *data++ = c[k];
    });
}

std::vector<SolvedPatch> patches_of(const PatchNames& names, const PatchValues& values) {
    require(names.shape(0) == values.shape(0), "patches: expected as many names as values");
    std::vector<SolvedPatch> patches(names.shape(0));
    for (size_t i = 0; i < patches.size(); ++i) {
        SolvedPatch& p = patches[i];
        const auto color = [&](size_t at) { return Color(values(i, at), values(i, at + 1), values(i, at + 2)); };
        p.name = {names(i, 0), (names(i, 1) & back_bit) != 0, names(i, 2) | uint64_t(names(i, 3)) << 32};
        p.unknown = (names(i, 1) & unknown_bit) != 0;
        p.direct = color(0), p.total = color(3), p.albedo = color(6), p.emitted = color(9), p.transmitted = color(12);
    }
    return patches;
}

/// Patches, their values and corners; and numbers by name.
auto solve(const CoreScene& scene, const RadiosityOptions& options, Progress& progress) {
    SolvedRadiosity solved;
    std::vector<std::array<Vec3, 3>> corners;
    {
        const nb::gil_scoped_release unlocked;
        solved = solve_radiosity(scene.world(), options, progress);
        corners = patch_corners(*scene.geometry, solved.patches);
    }
    auto placed = float_array({corners.size(), 3, 3}, [&](float* data) {
        for (const auto& patch : corners)
            for (const Vec3& c : patch)
                for (int k = 0; k < 3; ++k) *data++ = c[k];
    });
    nb::typed<nb::dict, nb::str, double> numbers;
    numbers["links"] = double(solved.links);
    numbers["sweeps"] = double(solved.sweeps);
    numbers["residual"] = double(solved.residual);
    numbers["closure_error"] = double(solved.closure_error);
    numbers["tolerance"] = double(solved.tolerance);
    return std::make_tuple(names_of(solved.patches), values_of(solved.patches), std::move(placed), std::move(numbers));
}

}  // namespace

void bind_radiosity(nb::module_& m) {
    nb::enum_<RadiositySolver>(m, "RadiositySolver")
        .value("gathering", RadiositySolver::gathering)
        .value("shooting", RadiositySolver::shooting);
    nb::class_<RadiosityOptions>(m, "RadiosityOptions")
        .def(nb::init<>())
        .def_rw("patch_size", &RadiosityOptions::patch_size)
        .def_rw("patches", &RadiosityOptions::patches)
        .def_rw("refinements", &RadiosityOptions::refinements)
        .def_rw("tolerance", &RadiosityOptions::tolerance)
        .def_rw("solver", &RadiosityOptions::solver)
        .def_rw("bounces", &RadiosityOptions::bounces)
        .def_rw("seed", &RadiosityOptions::seed)
        .def_rw("threads", &RadiosityOptions::threads);
    nb::class_<RadiosityField>(m, "RadiosityField")
        .def(
            "__init__",
            [](RadiosityField* field, const CoreScene& scene, PatchNames names, PatchValues values, int threads) {
                const auto patches = patches_of(names, values);
                const nb::gil_scoped_release unlocked;
                new (field) RadiosityField(*scene.geometry, patches, threads);
            },
            nb::keep_alive<1, 2>());
    m.attr("PATCH_IS_BACK") = back_bit;
    m.attr("PATCH_IS_UNKNOWN") = unknown_bit;
    m.def("solve_radiosity", &solve, "scene"_a, "options"_a, "progress"_a);
    m.def(
        "radiosity_estimator",
        [](const CoreScene& scene, const RadiosityField& field, int gather_rays, int max_depth) {
            return EstimatorHolder{radiosity_estimator(scene.world(), field, gather_rays, max_depth)};
        },
        nb::keep_alive<0, 1>(), nb::keep_alive<0, 2>(), "scene"_a, "field"_a, nb::kw_only(), "gather_rays"_a,
        "max_depth"_a);
    m.def(
        "radiosity_point_estimator",
        [](const CoreScene& scene, const RadiosityField& field) {
            return PointEstimatorHolder{radiosity_point_estimator(scene.world(), field)};
        },
        nb::keep_alive<0, 1>(), nb::keep_alive<0, 2>(), "scene"_a, "field"_a);
}
