// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "lights/environment.h"

#include <algorithm>
#include <string>

#include "base/error.h"
#include "lights/environment_split.h"

namespace eclat {

namespace {

/// Longitude is singular at the poles, so densities use at least this value of sin θ.
constexpr float least_sine = 1e-6f;

/// ∫ sin θ dθ over [from, to], split between the interpolation weights of its two ends.
struct RowIntegral {
    double upper, lower;
};

RowIntegral integrate_row(double from, double to) {
    // ∫ (θ − from) / (to − from) sin θ dθ, by parts; the rest of the integral belongs to the upper end.
    const double lower = -std::cos(to) + (std::sin(to) - std::sin(from)) / (to - from);
    return {std::cos(from) - std::cos(to) - lower, lower};
}

}  // namespace

/// Four texels and the place between them.
struct EnvironmentImage::Cell {
    uint32_t x0, x1, y0, y1;
    uint32_t row;
    float tx, ty;
};

/// The bilinear patch between the cell's four texels.
template <class TexelOf>
Color EnvironmentImage::blend(const Cell& cell, const TexelOf& texel_of) {
    const float sx = 1 - cell.tx, sy = 1 - cell.ty;
    return texel_of(cell.x0, cell.y0) * (sx * sy) + texel_of(cell.x1, cell.y0) * (cell.tx * sy) +
           texel_of(cell.x0, cell.y1) * (sx * cell.ty) + texel_of(cell.x1, cell.y1) * (cell.tx * cell.ty);
}

EnvironmentImage::EnvironmentImage(std::span<const float> rgb, uint32_t width, uint32_t height,
                                   const std::array<float, 9>& to_world)
    : width_(width),
      height_(height),
      texels_(rgb.begin(), rgb.end()),
      x_{to_world[0], to_world[3], to_world[6]},
      y_{to_world[1], to_world[4], to_world[7]},
      z_{to_world[2], to_world[5], to_world[8]} {
    require(width > 0 && height > 0 && rgb.size() == size_t(width) * height * 3,
            "environment: expected an image of height x width x 3 floats, got " + std::to_string(rgb.size()) +
                " floats for " + std::to_string(height) + " x " + std::to_string(width));
    const auto bad = std::find_if(texels_.begin(), texels_.end(), [](float x) { return !(x >= 0 && x < infinity); });
    if (bad != texels_.end()) {
        const size_t pixel = static_cast<size_t>(bad - texels_.begin()) / 3;
        require(false, "environment: radiance must be finite and not negative, got " + std::to_string(*bad) +
                           " at row " + std::to_string(pixel / width) + ", column " + std::to_string(pixel % width));
    }
    // A skew of up to a hundredth of a degree is due to rounding in loaders.
    const auto off = [](float x) { return !(std::abs(x) < 2e-4f); };
    require(!off(length(x_) - 1) && !off(length(y_) - 1) && !off(length(z_) - 1) && !off(dot(x_, y_)) &&
                !off(dot(y_, z_)) && !off(dot(z_, x_)),
            "environment: to_world must be a rotation");

    const Color first = texel(0, 0);
    constant_ = true;
    for (size_t i = 3; i < texels_.size(); ++i) constant_ = constant_ && texels_[i] == texels_[i % 3];
    if (constant_) {
        integral_ = first * (4 * pi);
    } else {
        build_distribution();
        smooth_limit_ = smooth_limit(texels_, width_, height_);
    }
}

std::optional<EnvironmentImage> EnvironmentImage::sharp_part() const {
    if (smooth_limit_ == infinity) return std::nullopt;
    EnvironmentImage out = *this;
    for (uint32_t y = 0; y < height_; ++y)
        for (uint32_t x = 0; x < width_; ++x) {
            const Color rest = texel(x, y) - smooth_texel(x, y);
            float* p = out.texels_.data() + (size_t(y) * width_ + x) * 3;
            for (int c = 0; c < 3; ++c) p[c] = std::max(0.0f, rest[c]);
        }
    out.smooth_limit_ = 0;
    out.build_distribution();
    return out;
}

void EnvironmentImage::build_distribution() {
    std::vector<float> weights(size_t(width_) * (height_ + 1));
    std::array<double, 3> integral = {0, 0, 0};
    row_factor_.resize(height_ + 1);
    for (uint32_t row = 0; row <= height_; ++row) {
        const double from = M_PI * std::max(0.0, row - 0.5) / height_,
                     to = M_PI * std::min<double>(height_, row + 0.5) / height_;
        const uint32_t y0 = row > 0 ? row - 1 : 0, y1 = std::min(row, height_ - 1);
        const RowIntegral sine = integrate_row(from, to);
        row_factor_[row] = static_cast<float>((sine.upper + sine.lower) / (to - from));
        for (uint32_t x = 0; x < width_; ++x) {
            const uint32_t x1 = x + 1 < width_ ? x + 1 : 0;
            const Color upper = (texel(x, y0) * 0.5f + texel(x1, y0) * 0.5f);
            const Color lower = (texel(x, y1) * 0.5f + texel(x1, y1) * 0.5f);
            weights[size_t(row) * width_ + x] =
                luminance(upper * 0.5f + lower * 0.5f) * static_cast<float>((sine.upper + sine.lower) / M_PI);
            for (int c = 0; c < 3; ++c)
                integral[c] += 2 * M_PI / width_ * (upper[c] * sine.upper + lower[c] * sine.lower);
        }
    }
    cells_ = PiecewiseConstant2D(width_, height_ + 1, weights);
    integral_ =
        Color(static_cast<float>(integral[0]), static_cast<float>(integral[1]), static_cast<float>(integral[2]));
    // The function to which the density is proportional is normalised to a mean of 1 over the square.
    if (!(cells_.total() > 0)) return;
    for (float& factor : row_factor_) factor = static_cast<float>(factor * width_ / cells_.total());
}

Color EnvironmentImage::texel(uint32_t x, uint32_t y) const {
    const float* p = texels_.data() + (size_t(y) * width_ + x) * 3;
    return {p[0], p[1], p[2]};
}

Color EnvironmentImage::smooth_texel(uint32_t x, uint32_t y) const {
    const Color all = texel(x, y);
    const float L = luminance(all);
    return L > smooth_limit_ ? all * (smooth_limit_ / L) : all;
}

Vec2 EnvironmentImage::to_uv(Vec3 w) const {
    const float x = dot(w, x_), y = dot(w, y_), z = dot(w, z_);
    // atan2 keeps its precision near the poles, where acos has none.
    return {0.5f + std::atan2(x, -z) * (0.5f * inv_pi), std::atan2(std::sqrt(x * x + z * z), y) * inv_pi};
}

EnvironmentImage::Cell EnvironmentImage::locate(Vec2 uv) const {
    const float x = uv.x * static_cast<float>(width_) - 0.5f, y = uv.y * static_cast<float>(height_) - 0.5f;
    const float fx = std::floor(x), fy = std::floor(y);
    const int w = static_cast<int>(width_), h = static_cast<int>(height_);
    const int ix = static_cast<int>(fx), iy = std::clamp(static_cast<int>(fy), -1, h - 1);
    Cell cell;
    cell.x0 = static_cast<uint32_t>(ix < 0 ? w - 1 : std::min(ix, w - 1));
    cell.x1 = static_cast<uint32_t>(ix + 1 < w ? ix + 1 : 0);
    cell.y0 = static_cast<uint32_t>(std::max(iy, 0));
    cell.y1 = static_cast<uint32_t>(std::min(iy + 1, h - 1));
    cell.row = static_cast<uint32_t>(iy + 1);
    cell.tx = x - fx;
    cell.ty = y - fy;
    return cell;
}

EnvironmentImage::Lookup EnvironmentImage::lookup(Vec3 w) const {
    if (constant_) return {texel(0, 0), uniform_sphere_pdf_solid_angle()};
    return between(locate(to_uv(w)), std::sqrt(sqr(dot(w, x_)) + sqr(dot(w, z_))));
}

EnvironmentImage::Lookup EnvironmentImage::between(const Cell& cell, float sine) const {
    const Color radiance = blend(cell, [&](uint32_t x, uint32_t y) { return texel(x, y); });
    // The image has 2π × π radians: dω = 2π² sin θ du dv.
    const float density = luminance(radiance) * row_factor_[cell.row];
    return {radiance, density / (2 * pi * pi * std::max(least_sine, sine))};
}

Color EnvironmentImage::radiance(Vec3 w) const { return constant_ ? texel(0, 0) : lookup(w).radiance; }

Color EnvironmentImage::smooth_radiance(Vec3 w) const {
    if (smooth_limit_ == infinity) return radiance(w);
    return blend(locate(to_uv(w)), [&](uint32_t x, uint32_t y) { return smooth_texel(x, y); });
}

float EnvironmentImage::pdf_solid_angle(Vec3 w) const { return lookup(w).pdf_solid_angle; }

LightSample EnvironmentImage::sample(Vec2 u) const {
    Search search = find_row(u);
    narrow(search);
    find_cell(search);
    return finish(search);
}

EnvironmentImage::Search EnvironmentImage::find_row(Vec2 u) const {
    if (constant_) return {u, {}, {}};
    return {u, cells_.find_row(u), {}};
}

void EnvironmentImage::narrow(Search& search) const {
    if (!constant_) cells_.narrow(search.among);
}

void EnvironmentImage::find_cell(Search& search) const {
    if (constant_) return;
    search.cell = cells_.find_cell(search.among);
    const auto& [column, row, offset, pdf_discrete] = search.cell;
    const uint32_t rows[] = {row > 0 ? row - 1 : 0, std::min(row, height_ - 1)};
    for (const uint32_t y : rows) __builtin_prefetch(texels_.data() + (size_t(y) * width_ + column) * 3);
}

LightSample EnvironmentImage::finish(const Search& search) const {
    if (constant_)
        return {square_to_uniform_sphere(search.u), infinity, texel(0, 0), uniform_sphere_pdf_solid_angle(), false};
    const PiecewiseConstant2D::Cell& chosen = search.cell;
    if (chosen.pdf_discrete == 0) return {};
    // Place in the patch: the row's profile first, then along the row.
    const uint32_t x0 = chosen.column, x1 = x0 + 1 < width_ ? x0 + 1 : 0;
    const uint32_t y0 = chosen.row > 0 ? chosen.row - 1 : 0, y1 = std::min(chosen.row, height_ - 1);
    const float a = luminance(texel(x0, y0)), b = luminance(texel(x1, y0));
    const float c = luminance(texel(x0, y1)), d = luminance(texel(x1, y1));
    const float ty = unit_to_linear(chosen.offset.y, a + b, c + d);
    const float tx = unit_to_linear(chosen.offset.x, lerp(a, c, ty), lerp(b, d, ty));

    const float h = static_cast<float>(height_), row = static_cast<float>(chosen.row);
    const float from = std::max(0.0f, row - 0.5f), to = std::min(h, row + 0.5f);
    const float phi = 2 * pi * ((static_cast<float>(x0) + 0.5f + tx) / static_cast<float>(width_) - 0.5f);
    const float theta = pi * ((from + (to - from) * ty) / h);
    const float sine = std::sin(theta);
    const Vec3 w = x_ * (std::sin(phi) * sine) + y_ * std::cos(theta) - z_ * (std::cos(phi) * sine);
    const Lookup at = between(Cell{x0, x1, y0, y1, chosen.row, tx, ty}, sine);
    return {w, infinity, at.radiance, at.pdf_solid_angle, false};
}

PhotonSample EnvironmentImage::emit(const EmissionDiscs& discs, Vec2 u_position, Vec2 u_direction) const {
    return discs.emit(sample(u_direction), u_position);
}

}  // namespace eclat
