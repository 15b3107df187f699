// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/tuple.h>

#include "arrays.h"
#include "estimators.h"
#include "harmonics/harmonics.h"
#include "transport/space_probes.h"
#include "world_holder.h"

using namespace eclat;
using namespace nb::literals;

namespace {

template <class Place>
auto probes_at(const CoreScene& scene, const std::vector<Place>& places, const EstimatorHolder& scattered,
               const ProbeOptions& options, Progress& progress) {
    ProbeCoefficients found;
    {
        const nb::gil_scoped_release unlocked;
        found = project_probes(scene.world(), std::span<const Place>(places), scattered.call, options, progress);
    }
    const auto array = [&](const std::vector<Color>& values) {
        return float_array({places.size(), size_t(coefficient_count(options.order)), 3}, [&](float* data) {
            for (const Color& c : values)
                for (int k = 0; k < 3; ++k) *data++ = c[k];
        });
    };
    return std::make_tuple(array(found.values), array(found.errors), found.dropped);
}

}  // namespace

void bind_space_probes(nb::module_& m) {
    nb::class_<ProbeOptions>(m, "ProbeOptions")
        .def(
            "__init__",
            [](ProbeOptions* o, Component component, int order, int samples, uint32_t seed, int threads) {
                new (o) ProbeOptions{component, order, samples, seed, threads};
            },
            nb::kw_only(), "component"_a, "order"_a, "samples"_a, "seed"_a, "threads"_a);
    m.def(
        "probes",
        [](const CoreScene& scene, const Points& positions, const EstimatorHolder& scattered,
           const ProbeOptions& options,
           Progress& progress) { return probes_at(scene, vec3s(positions), scattered, options, progress); },
        "scene"_a, "positions"_a, "estimator"_a, "options"_a, "progress"_a,
        "Coefficients of the incident radiance and half the differences of its halves, (probes, order², 3) each; "
        "number of dropped radiances.");
    m.def(
        "surface_probes",
        [](const CoreScene& scene, const Points& positions, const Points& normals, const EstimatorHolder& scattered,
           const ProbeOptions& options, Progress& progress) {
            return probes_at(scene, points_with_normals(positions, normals), scattered, options, progress);
        },
        "scene"_a, "positions"_a, "normals"_a, "estimator"_a, "options"_a, "progress"_a,
        "The same for the light that arrives at points of surfaces from the side of their normals.");
}
