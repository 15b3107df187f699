// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/nanobind.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>

#include "base/versions.h"
#include "scene/ray_tracer.h"

namespace nb = nanobind;

void bind_scene(nb::module_& m);
void bind_render(nb::module_& m);
void bind_space_probes(nb::module_& m);
void bind_cache(nb::module_& m);
void bind_error_estimates(nb::module_& m);
void bind_growing_cache(nb::module_& m);
void bind_renewal(nb::module_& m);
void bind_harmonics(nb::module_& m);
void bind_brdf_table(nb::module_& m);
void bind_photons(nb::module_& m);
void bind_radiosity(nb::module_& m);
void bind_measured(nb::module_& m);

NB_MODULE(_core, m) {
    bind_measured(m);
    bind_scene(m);
    bind_render(m);
    bind_space_probes(m);
    bind_harmonics(m);
    bind_brdf_table(m);
    bind_cache(m);
    bind_error_estimates(m);
    bind_growing_cache(m);
    bind_renewal(m);
    bind_photons(m);
    bind_radiosity(m);
    m.def(
        "versions",
        [] {
            return std::map<std::string, std::string>{{"embree", eclat::ray_tracer_version()},
                                                      {"onetbb", eclat::threads_version()}};
        },
        "The versions of the libraries that run, by name.");
    m.def("instruction_set", &eclat::core_instruction_set, "The name of the instruction set of this core.");
    m.def("built_for_one_machine", &eclat::built_for_one_machine,
          "Whether this core was compiled for the machine that compiled it.");
}
