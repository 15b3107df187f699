// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/nanobind.h>

namespace nb = nanobind;

void bind_scene(nb::module_& m);
void bind_render(nb::module_& m);
void bind_space_probes(nb::module_& m);
void bind_cache(nb::module_& m);
void bind_harmonics(nb::module_& m);
void bind_brdf_table(nb::module_& m);
void bind_photons(nb::module_& m);
void bind_radiosity(nb::module_& m);

NB_MODULE(_core, m) {
    bind_scene(m);
    bind_render(m);
    bind_space_probes(m);
    bind_harmonics(m);
    bind_brdf_table(m);
    bind_cache(m);
    bind_photons(m);
    bind_radiosity(m);
}
