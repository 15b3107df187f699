// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/nanobind.h>

#include "methods/radiance_cache/growing_cache.h"
#include "world_holder.h"

namespace nb = nanobind;

using namespace eclat;
using namespace nb::literals;

void bind_growing_cache(nb::module_& m) {
    nb::class_<GrowingCache>(m, "GrowingCache")
        .def(
            "__init__",
            [](GrowingCache* self, const CoreScene& scene, const IrradianceCacheOptions& options,
               const SolvedCaches& caches) { new (self) GrowingCache(scene.world(), options, caches); },
            nb::keep_alive<1, 2>(), "scene"_a, "options"_a, "caches"_a)
        .def(
            "__init__",
            [](GrowingCache* self, const CoreScene& scene, const RadianceCacheOptions& options,
               const RadianceTables& tables,
               const SolvedCaches& caches) { new (self) GrowingCache(scene.world(), options, tables, caches); },
            nb::keep_alive<1, 2>(), nb::keep_alive<1, 4>(), "scene"_a, "options"_a, "tables"_a, "caches"_a)
        .def("look", &GrowingCache::look, "camera"_a)
        .def("drop_view", &GrowingCache::drop_view)
        .def("look_everywhere", &GrowingCache::look_everywhere)
        .def_prop_ro("surfaces_left", &GrowingCache::surfaces_left)
        .def_prop_ro("passes_left", &GrowingCache::passes_left)
        .def("step", &GrowingCache::step, "progress"_a, nb::call_guard<nb::gil_scoped_release>())
        .def_prop_ro("caches", &GrowingCache::caches, nb::rv_policy::reference_internal)
        .def_prop_ro("bright", &GrowingCache::bright, nb::rv_policy::copy);
}
