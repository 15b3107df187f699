// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "hemisphere/radiance_projection.h"

#include "harmonics/quadrature.h"
#include "harmonics/rotation.h"

namespace eclat {

namespace {

/// Adds the contribution of a row to the coefficients of (l, ±m): its polar factors times its sums over azimuth.
void add_row(int order, const double* polar, const double* series, double* b) {
    for (int l = 0; l < order; ++l)
        for (int m = -l; m <= l; ++m) b[coefficient_index(l, m)] += polar[polar_index(l, std::abs(m))] * series[m];
}

}  // namespace

RadianceProjection::RadianceProjection(int order, Rows kind, int rows)
    : order_(order), rows_(rows), columns_(columns_for(rows)), kind_(kind), fit_(order, radiance_tikhonov) {
    require(order <= max_radiance_order, "order must be at most 12, got " + std::to_string(order));
    const size_t polar = size_t(polar_count(order));
    std::vector<double> P(polar);
    const auto nodes = gauss_legendre(order + 4);
    over_height_.resize(size_t(rows) * polar);
    over_angle_.resize(size_t(rows) * polar);
    on_wall_.resize(size_t(rows) * polar);
    for (int j = 0; j < rows; ++j) {
        const RowWall above = row_wall(kind, j, rows), below = row_wall(kind, j + 1, rows);
        const double z0 = double(above.cos), s0 = double(above.sin);
        const double from = std::atan2(s0, z0), to = std::atan2(double(below.sin), double(below.cos));
        const size_t row = size_t(j) * polar;
        for (const QuadratureNode& node : nodes) {
            const double theta = from + (to - from) * node.x, weight = (to - from) * node.weight;
            legendre(order, std::cos(theta), std::sin(theta), P.data());
            for (size_t i = 0; i < polar; ++i) {
                over_height_[row + i] += weight * std::sin(theta) * P[i];
                over_angle_[row + i] += weight * P[i];
            }
        }
        legendre(order, z0, s0, P.data());
        for (size_t i = 0; i < polar; ++i) on_wall_[row + i] = s0 * z0 * P[i];
    }
    in_column_.resize(size_t(columns_) * harmonics());
    at_column_.resize(in_column_.size());
    const double step = 2 * pi_double / columns_;
    for (int k = 0; k < columns_; ++k)
        for (int m = 0; m <= order; ++m) {
            const double from = step * k, to = step * (k + 1);
            double* in = &in_column_[size_t(k) * harmonics() + size_t(order)];
            double* at = &at_column_[size_t(k) * harmonics() + size_t(order)];
            in[-m] = m == 0 ? 0 : (std::cos(m * from) - std::cos(m * to)) / m;
            in[m] = m == 0 ? step : (std::sin(m * to) - std::sin(m * from)) / m;
            at[-m] = std::sin(m * from);
            at[m] = std::cos(m * from);
        }
}

RadianceCoefficients RadianceProjection::operator()(const HemisphereSamples& samples) const {
    require(samples.rows == rows_ && samples.columns == columns_ && samples.kind == kind_,
            "radiance projection: expected samples of the grid for which it was made, got another grid");
    const size_t count = size_t(coefficient_count(order_));
    RadianceCoefficients out;
    out.values.resize(3 * count);
    out.gradients.resize(6 * count);
    // The coefficients are rotated from the frame of the grid to the frame that all records use.
    const Frame frame = Frame::around(samples.frame.n);
    const double c = double(dot(samples.frame.u, frame.u)), s = double(dot(samples.frame.u, frame.v));
    const double turn = std::atan2(s, c);
    std::vector<double> b(count), x(count), y(count);
    for (int channel = 0; channel < 3; ++channel) {
        for (auto* coefficients : {&b, &x, &y}) std::fill(coefficients->begin(), coefficients->end(), 0.0);
        add_values(samples, channel, b);
        add_gradients(samples, channel, x, y);
        for (auto* coefficients : {&b, &x, &y}) {
            rotate_about_z(order_, turn, *coefficients);
            fit_.orthonormalize(order_, *coefficients);
        }
        for (size_t i = 0; i < count; ++i) {
            out.values[size_t(channel) * count + i] = float(b[i]);
            out.gradients[size_t(channel) * count + i] = float(c * x[i] - s * y[i]);
            out.gradients[size_t(3 + channel) * count + i] = float(s * x[i] + c * y[i]);
        }
    }
    return out;
}

void RadianceProjection::add_values(const HemisphereSamples& samples, int channel, std::vector<double>& b) const {
    Series series(harmonics());
    for (int j = 0; j < rows_; ++j) {
        std::fill(series.begin(), series.end(), 0.0);
        for (int k = 0; k < columns_; ++k) {
            const double L = double(samples.L(j, k)[channel]);
            const double* in = &in_column_[size_t(k) * harmonics()];
            for (size_t i = 0; i < harmonics(); ++i) series[i] += L * in[i];
        }
        add_row(order_, &over_height_[size_t(j * polar_count(order_))], &series[size_t(order_)], b.data());
    }
}

void RadianceProjection::add_gradients(const HemisphereSamples& samples, int channel, std::vector<double>& along_x,
                                       std::vector<double>& along_y) const {
    const auto jump = [&](int j, int k, int j0, int k0) {
        const float nearest = std::min(samples.r(j, k), samples.r(j0, k0));
        if (!(nearest < infinity && nearest > 0)) return 0.0;
        return double((samples.L(j, k)[channel] - samples.L(j0, k0)[channel]) / nearest);
    };
    const int n = order_;
    Series polar(harmonics()), azimuthal(harmonics());
    Series x(size_t(2 * n - 1)), y(x.size());
    const auto at = [&](Series& s) { return &s[size_t(n) - 1]; };
    for (int j = 0; j < rows_; ++j) {
        std::fill(polar.begin(), polar.end(), 0.0);
        std::fill(azimuthal.begin(), azimuthal.end(), 0.0);
        for (int k = 0; k < columns_; ++k) {
            // Walls between rows start at 1: the zenith is no wall.
            const double up = j > 0 ? jump(j, k, j - 1, k) : 0;
            const double beside = jump(j, k, j, (k + columns_ - 1) % columns_);
            const double *in = &in_column_[size_t(k) * harmonics()], *wall = &at_column_[size_t(k) * harmonics()];
            for (size_t i = 0; i < harmonics(); ++i) {
                polar[i] += up * in[i];
                azimuthal[i] += beside * wall[i];
            }
        }
        // The wall between rows moves along (cos φ, sin φ), that between columns along (−sin φ, cos φ); products of two
        // functions of φ are sums of two. With C_m and S_m for the sums with cos mφ and sin mφ:
        const auto C = [&](const Series& s, int m) { return s[size_t(n + std::abs(m))]; };
        const auto S = [&](const Series& s, int m) {
            return m == 0 ? 0 : m > 0 ? s[size_t(n - m)] : -s[size_t(n + m)];
        };
        for (int m = 0; m < n; ++m) {
            at(x)[m] = 0.5 * (C(polar, m + 1) + C(polar, m - 1));
            at(y)[m] = 0.5 * (S(polar, m + 1) - S(polar, m - 1));
            if (m == 0) continue;
            at(x)[-m] = 0.5 * (S(polar, m + 1) + S(polar, m - 1));
            at(y)[-m] = 0.5 * (C(polar, m - 1) - C(polar, m + 1));
        }
        add_row(n, &on_wall_[size_t(j * polar_count(n))], at(x), along_x.data());
        add_row(n, &on_wall_[size_t(j * polar_count(n))], at(y), along_y.data());
        for (int m = 0; m < n; ++m) {
            at(x)[m] = -0.5 * (S(azimuthal, m + 1) - S(azimuthal, m - 1));
            at(y)[m] = 0.5 * (C(azimuthal, m + 1) + C(azimuthal, m - 1));
            if (m == 0) continue;
            at(x)[-m] = -0.5 * (C(azimuthal, m - 1) - C(azimuthal, m + 1));
            at(y)[-m] = 0.5 * (S(azimuthal, m + 1) + S(azimuthal, m - 1));
        }
        add_row(n, &over_angle_[size_t(j * polar_count(n))], at(x), along_x.data());
        add_row(n, &over_angle_[size_t(j * polar_count(n))], at(y), along_y.data());
    }
}

}  // namespace eclat
