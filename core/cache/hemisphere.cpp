// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Symbols as in [WardHeckbert92]: M rows in θ, N columns in φ; θ_j− and θ_j+ are the walls of row j, φ_k− the lower wall
// of column k, u_k the tangent towards the middle of column k, v_k− the tangent at right angles to its wall.
// Held to tests/core/test_hemisphere.cpp: exact gradients of a polygon's irradiance.

#include "cache/hemisphere.h"

namespace eclat {

namespace {

constexpr float degree = pi / 180;

float sin_wall(int j, int rows) { return std::sqrt(static_cast<float>(j) / static_cast<float>(rows)); }
float cos_wall(int j, int rows) { return safe_sqrt(1 - static_cast<float>(j) / static_cast<float>(rows)); }

Vec3 tangent(const Frame& frame, float phi) { return frame.u * std::cos(phi) + frame.v * std::sin(phi); }

template <class Gradient>
void accumulate(Gradient& gradient, Vec3 direction, Color amount) {
    for (int c = 0; c < 3; ++c) gradient.channel[c] += direction * amount[c];
}

}  // namespace

int columns_for(int rows) { return static_cast<int>(std::lround(pi * static_cast<float>(rows))); }

Vec3 cell_direction(int rows, int columns, int j, int k, Vec2 u) {
    const float s2 = (static_cast<float>(j) + u.x) / static_cast<float>(rows);
    const float phi = 2 * pi * (static_cast<float>(k) + u.y) / static_cast<float>(columns);
    const float s = std::sqrt(s2);
    return {s * std::cos(phi), s * std::sin(phi), safe_sqrt(1 - s2)};
}

Color take_excess(HemisphereSamples& samples) {
    constexpr float largest_share = 0.05f;
    float limit = infinity;
    for (bool lowered = true; lowered;) {
        float sum = 0;
        lowered = false;
        for (const Color& L : samples.radiance) {
            sum += std::min(luminance(L), limit);
            lowered = lowered || luminance(L) > limit;
        }
        // The limit falls until it is the stated share of the sum that it leaves.
        const float next = largest_share * sum;
        lowered = (limit == infinity || lowered) && next < 0.99f * limit;
        limit = std::min(limit, next);
    }
    Color taken;
    for (Color& L : samples.radiance) {
        const float Y = luminance(L);
        if (Y <= limit) continue;
        taken += L * (1 - limit / Y);
        L *= limit / Y;
    }
    return taken * (pi / static_cast<float>(samples.radiance.size()));
}

Color irradiance(const HemisphereSamples& samples) {
    Color sum;
    for (const Color& L : samples.radiance) sum += L;
    return sum * (pi / static_cast<float>(samples.radiance.size()));
}

float relative_noise(const HemisphereSamples& samples) {
    const int M = samples.rows, N = samples.columns;
    float sum = 0, squares = 0;
    for (int j = 0; j < M; ++j)
        for (int k = 0; k < N; ++k) {
            const float here = luminance(samples.L(j, k));
            const float beside = luminance(samples.L(j, (k + 1) % N));
            const float below = luminance(samples.L(j + 1 < M ? j + 1 : j - 1, k));
            // Two cells differ by twice the variance of one.
            squares += 0.25f * (sqr(here - beside) + sqr(here - below));
            sum += here;
        }
    return sum > 0 ? std::sqrt(squares) / sum : 0;
}

RotationGradient rotation_gradient(const HemisphereSamples& samples) {
    const int M = samples.rows, N = samples.columns;
    RotationGradient out{};
    // ∫ sin² θ dθ over each row: exact where the row-centre tangent of [WardHeckbert92] is 10 % low.
    std::vector<float> polar;
    for (int j = 0; j < M; ++j) {
        const float lower = std::asin(sin_wall(j, M)), upper = std::asin(sin_wall(j + 1, M));
        polar.push_back(
            0.5f * ((upper - sin_wall(j + 1, M) * cos_wall(j + 1, M)) - (lower - sin_wall(j, M) * cos_wall(j, M))));
    }
    for (int k = 0; k < N; ++k) {
        Color column;
        for (int j = 0; j < M; ++j) column += samples.L(j, k) * polar[j];
        const float phi = 2 * pi * (static_cast<float>(k) + 0.5f) / static_cast<float>(N);
        const float azimuth = 2 * std::sin(pi / static_cast<float>(N));  // ∫ of the unit tangent over the column
        accumulate(out, tangent(samples.frame, phi + pi / 2), column * azimuth);
    }
    return out;
}

TranslationGradient translation_gradient(const HemisphereSamples& samples) {
    const int M = samples.rows, N = samples.columns;
    TranslationGradient out{};
    const auto jump = [&](int j, int k, int j0, int k0) {
        const float nearest = std::min(samples.r(j, k), samples.r(j0, k0));
        return nearest < infinity && nearest > 0 ? (samples.L(j, k) - samples.L(j0, k0)) / nearest : Color();
    };
    std::vector<float> row, height;
    for (int j = 0; j < M; ++j) {
        row.push_back(sin_wall(j, M) * sqr(cos_wall(j, M)));
        height.push_back(sin_wall(j + 1, M) - sin_wall(j, M));
    }
    for (int k = 0; k < N; ++k) {
        const int before = (k + N - 1) % N;
        // Walls between rows start at 1: the zenith is no wall.
        Color polar, azimuthal;
        for (int j = 1; j < M; ++j) polar += jump(j, k, j - 1, k) * row[j];  // [WardHeckbert92]
        for (int j = 0; j < M; ++j) azimuthal += jump(j, k, j, before) * height[j];
        const float step = 2 * pi / static_cast<float>(N), wall = step * static_cast<float>(k);
        accumulate(out, tangent(samples.frame, wall + 0.5f * step), polar * step);
        accumulate(out, tangent(samples.frame, wall + pi / 2), azimuthal);
    }
    return out;
}

void keep_off(HemisphereSamples& samples, float least) {
    for (float& r : samples.distance) r = std::max(r, least);
}

float harmonic_mean_distance(const HemisphereSamples& samples) {
    float sum = 0;
    for (float r : samples.distance) sum += 1 / r;
    return static_cast<float>(samples.distance.size()) / sum;
}

bool stands_apart(Vec3 here, Vec3 direction, Vec3 there) {
    const float elevation = std::asin(clamp(dot(here, direction), -1, 1));
    if (elevation > 15 * degree) return true;
    return std::acos(clamp(dot(here, there), -1, 1)) > 4 * std::max(elevation, 0.0f) + 5 * degree;
}

float minimum_distance(const HemisphereSamples& samples) {
    float least = infinity;
    for (size_t i = 0; i < samples.distance.size(); ++i)
        if (samples.apart[i]) least = std::min(least, samples.distance[i]);
    return least;
}

int clearance_sector(const Frame& frame, Vec3 d) {
    const float turns = std::atan2(dot(d, frame.v), dot(d, frame.u)) * (0.5f * inv_pi) + 0.5f;
    return std::min(static_cast<int>(turns * 12), 11);
}

std::array<float, 12> sector_clearance(const HemisphereSamples& samples) {
    std::array<float, 12> out;
    out.fill(infinity);
    const Frame frame = Frame::around(samples.frame.n);
    for (int k = 0; k < samples.columns; ++k) {
        const float phi = 2 * pi * (static_cast<float>(k) + 0.5f) / static_cast<float>(samples.columns);
        float& sector = out[clearance_sector(frame, tangent(samples.frame, phi))];
        for (int j = samples.rows / 2; j < samples.rows; ++j) {
            if (!samples.apart[size_t(j) * samples.columns + k]) continue;
            const float s = std::sqrt((static_cast<float>(j) + 0.5f) / static_cast<float>(samples.rows));
            sector = std::min(sector, samples.r(j, k) * s);
        }
    }
    return out;
}

}  // namespace eclat
