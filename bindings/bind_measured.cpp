// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <memory>

#include "arrays.h"
#include "bsdf/merl.h"
#include "bsdf/rgl.h"

using namespace eclat;
using namespace nb::literals;

namespace {

using Floats = Array<float, -1>;
using Floats4 = Array<float, -1, -1, -1, -1>;
using Floats5 = Array<float, -1, -1, -1, -1, -1>;

std::span<const float> span_of(const auto& a) { return {a.data(), a.size()}; }

RglTable table2(const Floats2& a) { return {a.shape(1), a.shape(0), span_of(a)}; }
RglTable table4(const Floats4& a) { return {a.shape(3), a.shape(2), span_of(a)}; }

std::shared_ptr<MeasuredBrdf> merl(Floats4 values) {
    if (values.shape(0) != 3 || values.shape(1) != 90 || values.shape(2) != 90 || values.shape(3) != 180)
        throw std::invalid_argument("MERL: expected an array of shape (3, 90, 90, 180)");
    return std::make_shared<MerlBrdf>(span_of(values));
}

/// `channels` (3, φ, θ, height, width), the other tables of four dimensions without the first.
std::shared_ptr<MeasuredBrdf> rgl(std::vector<float> phi, std::vector<float> theta, Floats2 normals, Floats2 projected,
                                  Floats4 visible, Floats4 luminance, Floats5 channels, bool jacobian) {
    if (channels.shape(0) != 3) throw std::invalid_argument("measured BRDF: expected three channels");
    const size_t slices = phi.size() * theta.size(), size = channels.size() / 3;
    if (visible.shape(0) * visible.shape(1) != slices || luminance.shape(0) * luminance.shape(1) != slices ||
        channels.shape(1) * channels.shape(2) != slices)
        throw std::invalid_argument("measured BRDF: expected tables for each pair of angles of the viewer");
    RglData data{.nodes = {std::move(phi), std::move(theta)},
                 .jacobian = jacobian,
                 .normals = table2(normals),
                 .projected = table2(projected),
                 .visible = table4(visible),
                 .luminance = table4(luminance),
                 .channels = {}};
    for (size_t i = 0; i < 3; ++i)
        data.channels[i] = {channels.shape(4), channels.shape(3), {channels.data() + i * size, size}};
    return std::make_shared<RglBrdf>(std::move(data));
}

auto eval(const MeasuredBrdf& brdf, Points wo, Points wi) {
    const auto views = vec3s(wo), lights = vec3s(wi);
    if (views.size() != lights.size()) throw std::invalid_argument("expected as many directions of light as of view");
    std::vector<Color> values;
    std::vector<float> densities;
    for (size_t i = 0; i < views.size(); ++i) {
        const EvalPdf e = brdf.eval(views[i], lights[i]);
        values.push_back(e.f);
        densities.push_back(e.pdf_solid_angle);
    }
    return std::tuple(color_array(values), float_array({densities.size()}, [&](float* data) {
                          std::copy(densities.begin(), densities.end(), data);
                      }));
}

auto directions(const MeasuredBrdf& brdf, Points wo, Uvs u) {
    const auto views = vec3s(wo);
    const auto randoms = vec2s(u);
    if (views.size() != randoms.size()) throw std::invalid_argument("expected a pair of random numbers for each view");
    return float_array({views.size(), 3}, [&](float* data) {
        for (size_t i = 0; i < views.size(); ++i) {
            const Vec3 w = brdf.direction(views[i], randoms[i]);
            *data++ = w.x, *data++ = w.y, *data++ = w.z;
        }
    });
}

auto albedo(const MeasuredBrdf& brdf, Points wo) {
    std::vector<Color> values;
    for (const Vec3& w : vec3s(wo)) values.push_back(brdf.albedo(w));
    return color_array(values);
}

}  // namespace

void bind_measured(nb::module_& m) {
    nb::class_<MeasuredBrdf>(m, "MeasuredBrdf")
        .def("eval", &eval, "wo"_a, "wi"_a, "Values (N, 3) without the cosine, and the densities (N,) of `directions`.")
        .def("directions", &directions, "wo"_a, "u"_a, "Directions (N, 3) of light that random numbers (N, 2) choose.")
        .def("albedo", &albedo, "wo"_a)
        .def_prop_ro("largest_albedo", &MeasuredBrdf::largest_albedo);
    m.def("merl_brdf", &merl, "values"_a);
    m.def("rgl_brdf", &rgl, nb::kw_only(), "phi"_a, "theta"_a, "normals"_a, "projected"_a, "visible"_a, "luminance"_a,
          "channels"_a, "jacobian"_a);
}
