// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "estimate/error_estimate.h"

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "estimate/focused_light.h"
#include "methods/radiance_cache/radiance_cache.h"
#include "shared_work.h"
#include "world_holder.h"

using namespace eclat;
using namespace nb::literals;

namespace {

void bind_error_types(nb::module_& m) {
    nb::class_<ErrorCheck> check(m, "ErrorCheck");
    check.def(nb::init<>())
        .def_rw("rays", &ErrorCheck::rays)
        .def_rw("wanted", &ErrorCheck::wanted)
        .def_rw("max_depth", &ErrorCheck::max_depth)
        .def_rw("seed", &ErrorCheck::seed)
        .def_rw("threads", &ErrorCheck::threads);
    def_share_work(check);
    nb::class_<ErrorEstimate>(m, "ErrorEstimate")
        .def_ro("squared", &ErrorEstimate::squared)
        .def_ro("deviation", &ErrorEstimate::deviation)
        .def_ro("missed", &ErrorEstimate::missed)
        .def_ro("paths", &ErrorEstimate::paths)
        .def_prop_ro(
            "places",
            [](const ErrorEstimate& e) {
                return float_array({e.places.size(), 4}, [&](float* data) {
                    for (const ErrorPlace& p : e.places) {
                        for (int k = 0; k < 3; ++k) *data++ = p.position[k];
                        *data++ = p.squared;
                    }
                });
            },
            nb::rv_policy::move);
}

}  // namespace

void bind_error_estimates(nb::module_& m) {
    bind_error_types(m);
    nb::class_<FocusedLight>(m, "FocusedLight")
        .def_ro("by_chance", &FocusedLight::by_chance)
        .def_ro("unseen", &FocusedLight::unseen)
        .def_ro("spread", &FocusedLight::spread);
    m.def(
        "focused_light",
        [](const CoreScene& scene, int max_depth, uint32_t seed, int threads, Progress& progress) {
            return focused_light(scene.world(), max_depth, seed, threads, progress);
        },
        "scene"_a, "max_depth"_a, "seed"_a, "threads"_a, "progress"_a, nb::call_guard<nb::gil_scoped_release>());
    m.def(
        "estimate_error_for_camera",
        [](const CoreScene& scene, const Camera& camera, const SolvedCaches& caches, const ErrorCheck& check,
           Progress& progress, const RadianceTables* tables) {
            return estimate_error(scene.world(), camera, caches, tables, check, progress);
        },
        "scene"_a, "camera"_a, "caches"_a, "check"_a, "progress"_a, "tables"_a.none() = nb::none(),
        nb::call_guard<nb::gil_scoped_release>());
    m.def(
        "estimate_error_at_points",
        [](const CoreScene& scene, Points positions, Points normals, const SolvedCaches& caches,
           const ErrorCheck& check, Progress& progress) {
            const auto points = points_with_normals(positions, normals);
            const nb::gil_scoped_release unlocked;
            return estimate_error(scene.world(), points, caches, check, progress);
        },
        "scene"_a, "positions"_a, "normals"_a, "caches"_a, "check"_a, "progress"_a);
    m.def(
        "estimate_error_everywhere",
        [](const CoreScene& scene, size_t count, const SolvedCaches& caches, const ErrorCheck& check,
           Progress& progress) {
            const auto points = points_everywhere(scene.world(), count, check.seed);
            return estimate_error(scene.world(), points, caches, check, progress);
        },
        "scene"_a, "count"_a, "caches"_a, "check"_a, "progress"_a, nb::call_guard<nb::gil_scoped_release>());
}
