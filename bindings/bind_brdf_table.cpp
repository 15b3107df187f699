// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "bsdf/metallic_roughness.h"
#include "bsdf/plastic.h"
#include "tables/brdf_table.h"

using namespace eclat;
using namespace nb::literals;

namespace {

using Floats1 = Array<float, -1>;
using Bytes1 = Array<uint8_t, -1>;

std::vector<float> floats(const Floats1& a) { return {a.data(), a.data() + a.size()}; }

auto to_array(const std::vector<float>& values) {
    return float_array({values.size()}, [&](float* data) { std::copy(values.begin(), values.end(), data); });
}

/// (3 terms, RGB)
auto factors(const InterfaceReflectance& reflectance) {
    const FresnelFactors f = split_fresnel(reflectance);
    return float_array({fresnel_terms, 3}, [&](float* data) {
        for (const Color& color : f)
            for (int c = 0; c < 3; ++c) *data++ = color[c];
    });
}

/// Returns orders (N), coefficients (N, terms, order²), which are zero beyond the order of each direction, and errors
/// (N).
auto lookup(const BrdfTable& table, Points directions, Floats1 alphas) {
    if (alphas.shape(0) != directions.shape(0))
        throw std::invalid_argument("BRDF table: expected as many alphas as directions, got " +
                                    std::to_string(alphas.shape(0)) + " and " + std::to_string(directions.shape(0)));
    const size_t count = directions.shape(0), terms = size_t(table.terms());
    const size_t all = size_t(coefficient_count(table.order()));
    std::vector<float> orders(count), errors(count), found(terms * all);
    auto coefficients = float_array({count, terms, all}, [&](float* data) {
        std::fill(data, data + count * terms * all, 0.0f);
        for (size_t i = 0; i < count; ++i) {
            const Vec3 wo{directions(i, 0), directions(i, 1), directions(i, 2)};
            const size_t order = size_t(table.lookup(wo, alphas(i), found));
            orders[i] = float(order);
            errors[i] = table.error(wo, alphas(i));
            for (size_t t = 0; t < terms; ++t)
                std::copy_n(found.begin() + long(t * order * order), order * order, data + (i * terms + t) * all);
        }
    });
    return std::make_tuple(to_array(orders), coefficients, to_array(errors));
}

/// Returns `of(cosine)` for each cosine (N).
template <class F>
auto at_cosines(const Floats1& cosines, F&& of) {
    return float_array({cosines.size()}, [&](float* data) {
        for (size_t i = 0; i < cosines.size(); ++i) data[i] = of(cosines.data()[i]);
    });
}

/// Returns the albedo (N) of a white base below the coat of a plastic, without reflections inside, at each cosine, and the
/// share of diffuse light that the coat reflects inside.
auto plastic_coat(float ior, float alpha, bool beckmann, const Floats1& cosines) {
    const PlasticTable table = make_plastic_table(ior, alpha, beckmann ? Distribution::beckmann : Distribution::ggx);
    auto albedos = at_cosines(
        cosines, [&](float mu) { return table.transmittance(mu) * table.mean_transmittance * (1 / sqr(ior)); });
    return std::make_tuple(std::move(albedos), table.internal_reflectance);
}

/// Returns the albedo (N) of a white base of the metallic-roughness model at each cosine.
auto coupled_coat(float alpha, float f0, float f90, const Floats1& cosines) {
    const CoupledDiffuseLobe lobe(Microfacets::smooth(alpha, alpha) ? 0 : alpha, f0, f90);
    return at_cosines(cosines, [&](float mu) { return lobe.entering(mu); });
}

}  // namespace

void bind_brdf_table(nb::module_& m) {
    m.attr("max_table_order") = BrdfTableOptions::max_order;
    nb::enum_<TableLobe::Kind>(m, "TableLobeKind")
        .value("lambert", TableLobe::Kind::lambert)
        .value("phong", TableLobe::Kind::phong)
        .value("ward", TableLobe::Kind::ward)
        .value("ggx", TableLobe::Kind::ggx)
        .value("beckmann", TableLobe::Kind::beckmann);
    nb::class_<TableLobe>(m, "TableLobe")
        .def("__init__", [](TableLobe* lobe, TableLobe::Kind kind, float u, float v, bool correlated) {
            new (lobe) TableLobe{kind, u, v, correlated ? Masking::correlated : Masking::separable};
        });
    nb::class_<BrdfTableOptions>(m, "BrdfTableOptions")
        .def("__init__", [](BrdfTableOptions* o, Basis basis, int order, double max_error, int resolution,
                            int threads) { new (o) BrdfTableOptions{basis, order, max_error, resolution, threads}; });
    nb::class_<BrdfTable>(m, "BrdfTable")
        .def(
            "__init__",
            [](BrdfTable* table, const std::vector<TableLobe>& lobes, const BrdfTableOptions& options,
               Progress& progress) { new (table) BrdfTable(lobes, options, progress); },
            "lobes"_a, "options"_a, "progress"_a, nb::call_guard<nb::gil_scoped_release>())
        .def("__init__",
             [](BrdfTable* table, const std::vector<TableLobe>& lobes, const BrdfTableOptions& options, Bytes1 orders,
                Floats1 errors, Floats1 coefficients) {
                 new (table)
                     BrdfTable(lobes, options,
                               {{orders.data(), orders.data() + orders.size()}, floats(errors), floats(coefficients)});
             })
        .def_prop_ro("terms", &BrdfTable::terms)
        .def_prop_ro("orders",
                     [](const BrdfTable& t) { return nb::bytes(t.nodes().orders.data(), t.nodes().orders.size()); })
        .def_prop_ro(
            "errors", [](const BrdfTable& t) { return to_array(t.nodes().errors); }, nb::rv_policy::move)
        .def_prop_ro(
            "coefficients", [](const BrdfTable& t) { return to_array(t.nodes().coefficients); }, nb::rv_policy::move)
        .def("lookup", &lookup, "directions"_a, "alphas"_a);
    m.def(
        "split_conductor",
        [](std::array<float, 3> eta, std::array<float, 3> k) {
            return factors(InterfaceReflectance::conductor(color(eta), color(k)));
        },
        "eta"_a, "k"_a);
    m.def("split_dielectric", [](float ior) { return factors(InterfaceReflectance::dielectric(ior)); }, "ior"_a);
    m.def("plastic_coat", &plastic_coat, "ior"_a, "alpha"_a, "beckmann"_a, "cosines"_a);
    m.def("coupled_coat", &coupled_coat, "alpha"_a, "f0"_a, "f90"_a, "cosines"_a);
}
