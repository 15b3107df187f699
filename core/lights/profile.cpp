// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "lights/profile.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace eclat {

namespace {

constexpr double radians_of_degree = M_PI / 180;

/// A place among ascending nodes: the interval that begins at node `index`, and the position in it from 0 to 1.
struct Place {
    size_t index = 0;
    float fraction = 0;
    bool inside = false;
};

Place place_among(const std::vector<float>& nodes, float x) {
    if (!(x >= nodes.front() && x <= nodes.back())) return {};
    const auto above = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, x);
    const auto index = static_cast<size_t>(above - nodes.begin()) - 1;
    return {index, (x - nodes[index]) / (nodes[index + 1] - nodes[index]), true};
}

/// Computes ∫ f(θ) sin θ dθ from a to b, in radians, for f that is linear from `at_a` to `at_b`.
double integral_of_linear(double a, double b, double at_a, double at_b) {
    const double width = b - a, zone = std::cos(a) - std::cos(b);
    const double first_moment = std::sin(b) - std::sin(a) - width * std::cos(b);  // ∫ (θ − a) sin θ dθ
    return at_a * zone + (at_b - at_a) / width * first_moment;
}

void check_nodes(const std::vector<float>& nodes, const char* which, float low, float high, float span) {
    bool valid = nodes.size() >= 2 && nodes.front() >= low && nodes.back() <= high;
    for (size_t i = 1; valid && i < nodes.size(); ++i) valid = nodes[i] > nodes[i - 1];
    require(valid && nodes.back() - nodes.front() <= span,
            std::string("profile light: expected at least two ascending angles in degrees in the list of ") + which +
                " angles");
}

}  // namespace

ProfileLight::ProfileLight(Vec3 position, const std::array<Vec3, 3>& axes, Color intensity, IntensityTable table)
    : position_(position), axes_(axes), intensity_(intensity), table_(std::move(table)) {
    const auto& [polar, azimuth, values] = table_;
    check_nodes(polar, "polar", 0, 180, 180);
    check_nodes(azimuth, "azimuth", -360, 360, 360);
    require(values.size() == polar.size() * azimuth.size(), "profile light: expected a value for each pair of angles");
    require(is_finite(position) && std::ranges::all_of(axes_, [](Vec3 a) { return is_finite(a); }),
            "profile light: expected a finite position and finite axes");
    require(std::ranges::all_of(values, [](float v) { return v >= 0 && std::isfinite(v); }),
            "profile light: expected intensities that are finite and not negative");
    std::vector<float> flux;
    for (size_t i = 0; i + 1 < polar.size(); ++i)
        for (size_t j = 0; j + 1 < azimuth.size(); ++j) {
            // The integral over the azimuth of what is linear in it is its mean times the width.
            const auto mean = [&](size_t row) {
                const float* value = &values[row * azimuth.size() + j];
                return 0.5 * (double(value[0]) + double(value[1]));
            };
            const double zone = integral_of_linear(polar[i] * radians_of_degree, polar[i + 1] * radians_of_degree,
                                                   mean(i), mean(i + 1));
            flux.push_back(static_cast<float>(std::max(0.0, zone * (azimuth[j + 1] - azimuth[j]) * radians_of_degree)));
        }
    cells_ =
        PiecewiseConstant2D(static_cast<uint32_t>(azimuth.size() - 1), static_cast<uint32_t>(polar.size() - 1), flux);
}

float ProfileLight::relative_intensity(Vec3 w) const {
    constexpr float degrees = 180 / pi;
    const Vec3 local{dot(w, axes_[0]), dot(w, axes_[1]), dot(w, axes_[2])};
    // No std::hypot, whose newest version would need glibc 2.35; where the squares underflow, w lies on the axis.
    const float polar = std::atan2(std::sqrt(local.x * local.x + local.y * local.y), local.z) * degrees;
    float azimuth = std::atan2(local.y, local.x) * degrees;
    if (azimuth < table_.azimuth.front()) azimuth += 360;
    if (azimuth > table_.azimuth.back()) azimuth -= 360;
    // Rounding must not open a slit between the end of a full turn and its beginning.
    if (table_.azimuth.back() - table_.azimuth.front() == 360)
        azimuth = std::clamp(azimuth, table_.azimuth.front(), table_.azimuth.back());
    const Place row = place_among(table_.polar, polar), column = place_among(table_.azimuth, azimuth);
    if (!row.inside || !column.inside) return 0;
    const size_t width = table_.azimuth.size();
    const auto at = [&](size_t i) {
        const float* value = &table_.values[i * width + column.index];
        return std::lerp(value[0], value[1], column.fraction);
    };
    return std::lerp(at(row.index), at(row.index + 1), row.fraction);
}

PhotonSample ProfileLight::emit(Vec2 u) const {
    const PiecewiseConstant2D::Cell cell = cells_.sample(u);
    if (cell.pdf_discrete == 0) return {};
    const auto radians = [](float degrees) { return static_cast<float>(degrees * radians_of_degree); };
    const float above = std::cos(radians(table_.polar[cell.row])),
                below = std::cos(radians(table_.polar[cell.row + 1]));
    const float cosine = std::lerp(above, below, cell.offset.y), sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine));
    const float begin = radians(table_.azimuth[cell.column]), end = radians(table_.azimuth[cell.column + 1]);
    const float angle = std::lerp(begin, end, cell.offset.x);
    const Vec3 w =
        normalize(axes_[0] * (sine * std::cos(angle)) + axes_[1] * (sine * std::sin(angle)) + axes_[2] * cosine);
    const float solid_angle = (above - below) * (end - begin);
    return {position_, w, intensity_ * (relative_intensity(w) * solid_angle / cell.pdf_discrete)};
}

}  // namespace eclat
