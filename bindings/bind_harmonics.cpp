// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>

#include <cstring>

#include "arrays.h"
#include "harmonics/projection.h"
#include "harmonics/rotation.h"

using namespace eclat;
using namespace nb::literals;

namespace {

using Directions = Array<double, -1, 3>;
using Channels = Array<double, -1, -1>;

std::vector<Direction> directions_of(const Directions& a) {
    std::vector<Direction> out(a.shape(0));
    for (size_t i = 0; i < out.size(); ++i) out[i] = {a(i, 0), a(i, 1), a(i, 2)};
    return out;
}

std::span<const double> span_of(const Channels& a) { return {a.data(), a.size()}; }

nb::ndarray<nb::numpy, double> double_array(std::vector<double> values, size_t rows, size_t columns) {
    auto* owned = new std::vector<double>(std::move(values));
    nb::capsule owner(owned, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
    return {owned->data(), {rows, columns}, owner};
}

/// Calls `f(vector)` for each column of an array (order², channels).
template <class F>
auto for_each_channel(const Channels& coefficients, const F& f) {
    const size_t count = coefficients.shape(0), channels = coefficients.shape(1);
    std::vector<double> out(count * channels), column(count);
    for (size_t c = 0; c < channels; ++c) {
        for (size_t i = 0; i < count; ++i) column[i] = coefficients(i, c);
        f(column);
        for (size_t i = 0; i < count; ++i) out[i * channels + c] = column[i];
    }
    return double_array(std::move(out), count, channels);
}

auto rotate_spherical(int order, Matrix3 R, Channels coefficients) {
    const SphericalRotation rotation(order, R);
    std::vector<double> turned(size_t(coefficient_count(order)));
    return for_each_channel(coefficients, [&](std::vector<double>& column) {
        rotation.apply(column, turned);
        column = turned;
    });
}

auto rotate_by_tilt(int order, Matrix3 R, double tolerance, Channels coefficients) {
    require_rotation(R);
    const TurnTiltTurn rotation = turn_tilt_turn(R);
    return for_each_channel(coefficients,
                            [&](std::vector<double>& column) { rotate_by_series(order, rotation, tolerance, column); });
}

auto rotate_hemispherical(int order, Matrix3 R, Horizon horizon, int spherical_order, Channels coefficients) {
    const HemisphericalRotation rotation(
        order, horizon,
        spherical_order > 0 ? spherical_order : HemisphericalRotation::spherical_order_for(horizon, order));
    return for_each_channel(coefficients, [&](std::vector<double>& column) { rotation.apply(R, column); });
}

}  // namespace

void bind_harmonics(nb::module_& m) {
    m.attr("max_harmonic_order") = max_harmonic_order;
    nb::enum_<Basis>(m, "Basis").value("spherical", Basis::spherical).value("hemispherical", Basis::hemispherical);
    nb::enum_<Window>(m, "Window").value("hanning", Window::hanning).value("lanczos", Window::lanczos);
    nb::enum_<Horizon>(m, "Horizon").value("continued", Horizon::continued).value("dark", Horizon::dark);
    m.def(
        "evaluate_harmonics",
        [](Basis basis, int order, Directions directions) {
            require_order(order);
            const size_t count = size_t(coefficient_count(order));
            std::vector<double> out(directions.shape(0) * count);
            for (size_t i = 0; i < directions.shape(0); ++i)
                evaluate_harmonics(basis, order, {directions(i, 0), directions(i, 1), directions(i, 2)},
                                   out.data() + i * count);
            return double_array(std::move(out), directions.shape(0), count);
        },
        "basis"_a, "order"_a, "directions"_a);
    m.def(
        "project_harmonics",
        [](Basis basis, int order, Directions directions, Channels values, Array<double, -1> weights) {
            return double_array(project(basis, order, directions_of(directions), span_of(values),
                                        {weights.data(), weights.size()}, int(values.shape(1))),
                                size_t(coefficient_count(order)), values.shape(1));
        },
        "basis"_a, "order"_a, "directions"_a, "values"_a, "weights"_a);
    m.def(
        "reconstruct_harmonics",
        [](Basis basis, int order, Channels coefficients, Directions directions) {
            return double_array(
                reconstruct(basis, order, span_of(coefficients), directions_of(directions), int(coefficients.shape(1))),
                directions.shape(0), coefficients.shape(1));
        },
        "basis"_a, "order"_a, "coefficients"_a, "directions"_a);
    m.def(
        "fit_hemisphere",
        [](int order, double tikhonov, Channels inner_products) {
            const HemisphereFit fit(order, tikhonov);
            return for_each_channel(inner_products, [&](std::vector<double>& column) { fit.fit(order, column); });
        },
        "order"_a, "tikhonov"_a, "inner_products"_a);
    m.def(
        "window_harmonics",
        [](Window window, int order, Channels coefficients) {
            return for_each_channel(coefficients,
                                    [&](std::vector<double>& column) { apply_window(window, order, column); });
        },
        "window"_a, "order"_a, "coefficients"_a);
    m.def("rotate_spherical", &rotate_spherical, "order"_a, "rotation"_a, "coefficients"_a);
    m.def("rotate_by_tilt", &rotate_by_tilt, "order"_a, "rotation"_a, "tolerance"_a, "coefficients"_a);
    m.def("rotate_hemispherical", &rotate_hemispherical, "order"_a, "rotation"_a, "horizon"_a, "spherical_order"_a,
          "coefficients"_a);
}
