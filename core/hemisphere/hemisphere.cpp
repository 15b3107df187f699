// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The gradients of irradiance that follow from a stratified gather, for rotation and translation of the point [WardHeckbert92].
// Rotation changes only the cosines. Translation changes the size of the cells: the wall between two cells belongs to the nearer
// of the two hits, and moves over the hemisphere faster the nearer that hit is. Where radiance jumps across the wall, irradiance
// is gained or lost.
//
// Symbol          name here         meaning                                                        unit
//   M, N          rows, columns     rows in θ, columns in φ                                        1
//   θ_j−, θ_j+    row_wall()        upper and lower wall of row j, its angles from the zenith      rad
//   φ_k, φ_k−     phi, wall         middle and lower wall of column k                              rad
//   u_k           tangent()         tangent towards φ_k
//   v_k, v_k−     tangent()         tangents towards φ_k + π/2 and φ_k− + π/2
//   L_jk, r_jk    L(j, k), r(j, k)  radiance in cell (j, k) (W m⁻² sr⁻¹) and distance (m)
//
//   E    = π / (M N) Σ L_jk   in cosine rows; otherwise each row is weighted by its projected solid angle
//   ∇_r E = Σ_k v_k 2 sin(π / N) Σ_j L_jk ∫ sin² θ dθ over row j
//   ∇_t E = Σ_k [ u_k 2π/N Σ_{j ≥ 1} sin θ_j− cos² θ_j− (L_jk − L_{j−1,k}) / min(r_jk, r_{j−1,k})
//                + v_k− Σ_j (sin θ_j+ − sin θ_j−) (L_jk − L_{j,k−1}) / min(r_jk, r_{j,k−1}) ]
//
// References   [Ward88] irradiance and the harmonic mean, [WardHeckbert92] both gradients, [Tabellion04] the least distance
// Departures   The exact integrals over rows and columns take the place of tan at the centre of a row.
// Held to tests/core/hemisphere/test_hemisphere.cpp: exact gradients of a polygon's irradiance.

#include "hemisphere/hemisphere.h"

#include <algorithm>
#include <vector>

namespace eclat {

namespace {

constexpr float degree = pi / 180;

/// Returns the mean of sin² at the two walls of a row.
float row_middle(Rows kind, int j, int rows) {
    if (kind == Rows::cosine) return (static_cast<float>(j) + 0.5f) / static_cast<float>(rows);
    return 0.5f * (sqr(row_wall(kind, j, rows).sin) + sqr(row_wall(kind, j + 1, rows).sin));
}

/// Projected solid angle of the cells of each row in units of π / MN.
std::vector<float> row_weights(const HemisphereSamples& samples) {
    std::vector<float> out(size_t(samples.rows), 1.0f);
    if (samples.kind == Rows::cosine) return out;
    for (int j = 0; j < samples.rows; ++j)
        out[size_t(j)] =
            (sqr(row_wall(samples.kind, j + 1, samples.rows).sin) - sqr(row_wall(samples.kind, j, samples.rows).sin)) *
            static_cast<float>(samples.rows);
    return out;
}

/// Returns the half of the grid to which a cell belongs: 0 or 1.
size_t half_of(size_t cell, size_t columns) { return (cell / columns + cell % columns) % 2; }

/// Returns the limit that is a twentieth of what the cells bring, times `scale`, after the brighter ones have been reduced to it.
float equal_limit(const std::vector<float>& brought, float scale) {
    // This share is chosen by judgement: a smaller one would blur light that records determine well, and a larger one
    // leaves splotches from single rays.
    constexpr float largest_share = 0.05f;
    float limit = infinity;
    for (bool lowered = true; lowered;) {
        float sum = 0;
        lowered = false;
        for (const float cell : brought) {
            sum += std::min(cell, limit);
            lowered = lowered || cell > limit;
        }
        // The limit is reduced until it is the required share of the sum that remains, within a hundredth.
        const float next = largest_share * scale * sum;
        lowered = (limit == infinity || lowered) && next < 0.99f * limit;
        limit = std::min(limit, next);
    }
    return limit;
}

Vec3 tangent(const Frame& frame, float phi) { return frame.u * std::cos(phi) + frame.v * std::sin(phi); }

template <class Gradient>
void accumulate(Gradient& gradient, Vec3 direction, Color amount) {
    for (int c = 0; c < 3; ++c) gradient.channel[c] += direction * amount[c];
}

}  // namespace

int columns_for(int rows) { return static_cast<int>(std::lround(pi * static_cast<float>(rows))); }

RowWall row_wall(Rows kind, int j, int rows) {
    const float part = static_cast<float>(j) / static_cast<float>(rows);
    if (kind == Rows::cosine) return {std::sqrt(part), safe_sqrt(1 - part)};
    // The density (2 z + 1) / 2 over the height z has the integral (z² + z) / 2 below z.
    const float z = 0.5f * (std::sqrt(1 + 8 * (1 - part)) - 1);
    return {safe_sqrt(1 - z * z), z};
}

Vec3 cell_direction(int rows, int columns, int j, int k, Vec2 u, Rows kind) {
    float s2 = (static_cast<float>(j) + u.x) / static_cast<float>(rows);
    if (kind != Rows::cosine) s2 = lerp(sqr(row_wall(kind, j, rows).sin), sqr(row_wall(kind, j + 1, rows).sin), u.x);
    const float phi = 2 * pi * (static_cast<float>(k) + u.y) / static_cast<float>(columns);
    const float s = std::sqrt(s2);
    return {s * std::cos(phi), s * std::sin(phi), safe_sqrt(1 - s2)};
}

float ExcessLimits::at(const HemisphereSamples& samples, size_t cell) const {
    return of_half[half_of(cell, static_cast<size_t>(samples.columns))];
}

// If the limit for a cell rose with the light of the cell, more of the light would count at once as what is left and as excess,
// which aimed rays find whether the grid met it or not: the sum of both would be too large by the covariance of limit and light.
// Pictures of a room under a curtain, which light samples of a small ball light unevenly, were 0.8 % too bright by it.
ExcessLimits excess_limits(const HemisphereSamples& samples) {
    const std::vector<float> weights = row_weights(samples);
    const auto columns = static_cast<size_t>(samples.columns);
    std::array<std::vector<float>, 2> brought;
    for (size_t i = 0; i < samples.radiance.size(); ++i)
        brought[half_of(i, columns)].push_back(luminance(samples.radiance[i]) * weights[i / columns]);
    const auto whole = static_cast<float>(samples.radiance.size());
    const auto limit_of = [&](const std::vector<float>& half) {
        return equal_limit(half, whole / std::max(1.0f, static_cast<float>(half.size())));
    };
    return {{limit_of(brought[1]), limit_of(brought[0])}};
}

size_t cell_at(const HemisphereSamples& samples, Vec3 direction) {
    const auto index = [](float share, int count) {
        return clamp(static_cast<int>(std::floor(share * static_cast<float>(count))), 0, count - 1);
    };
    const int row = index(sqr(direction.x) + sqr(direction.y), samples.rows);
    const float turns = std::atan2(direction.y, direction.x) / (2 * pi);
    const int column = index(turns - std::floor(turns), samples.columns);
    return static_cast<size_t>(row) * static_cast<size_t>(samples.columns) + static_cast<size_t>(column);
}

Color beyond(Color radiance, float limit) {
    const float Y = luminance(radiance);
    return Y > limit ? radiance * (1 - limit / Y) : Color();
}

Color take_excess(HemisphereSamples& samples) {
    const ExcessLimits limits = excess_limits(samples);
    Color taken;
    const std::vector<float> weights = row_weights(samples);
    const auto columns = static_cast<size_t>(samples.columns);
    for (size_t i = 0; i < samples.radiance.size(); ++i) {
        Color& L = samples.radiance[i];
        const float brought = luminance(L) * weights[i / columns];
        const float limit = limits.at(samples, i);
        if (brought <= limit) continue;
        taken += L * ((1 - limit / brought) * weights[i / columns]);
        L *= limit / brought;
    }
    return taken * (pi / static_cast<float>(samples.radiance.size()));
}

Color irradiance(const HemisphereSamples& samples) {
    const std::vector<float> weights = row_weights(samples);
    Color sum;
    for (size_t i = 0; i < samples.radiance.size(); ++i)
        sum += samples.radiance[i] * weights[i / static_cast<size_t>(samples.columns)];
    return sum * (pi / static_cast<float>(samples.radiance.size()));
}

float relative_noise(const HemisphereSamples& samples) {
    const int M = samples.rows, N = samples.columns;
    const std::vector<float> weights = row_weights(samples);
    float sum = 0, squares = 0;
    for (int j = 0; j < M; ++j)
        for (int k = 0; k < N; ++k) {
            const float w = weights[size_t(j)];
            const float here = w * luminance(samples.L(j, k));
            const float beside = w * luminance(samples.L(j, (k + 1) % N));
            const float below = w * luminance(samples.L(j + 1 < M ? j + 1 : j - 1, k));
            // The variance of the difference of two cells is twice that of one.
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
        const RowWall above = row_wall(samples.kind, j, M), below = row_wall(samples.kind, j + 1, M);
        const float lower = std::asin(above.sin), upper = std::asin(below.sin);
        polar.push_back(0.5f * ((upper - below.sin * below.cos) - (lower - above.sin * above.cos)));
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
        const RowWall above = row_wall(samples.kind, j, M);
        row.push_back(above.sin * sqr(above.cos));
        height.push_back(row_wall(samples.kind, j + 1, M).sin - above.sin);
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

float reach(const HemisphereSamples& samples) {
    std::vector<float> met;
    for (float r : samples.distance)
        if (r < infinity) met.push_back(r);
    if (met.empty()) return infinity;
    const auto half = met.begin() + static_cast<std::ptrdiff_t>(met.size() / 2);
    std::nth_element(met.begin(), half, met.end());
    // The order of the other elements depends on the library, so they are sorted before they are summed.
    std::sort(half, met.end());
    float sum = 0;
    for (auto r = half; r != met.end(); ++r) sum += 1 / *r;
    return static_cast<float>(met.end() - half) / sum;
}

float farthest_distance(const HemisphereSamples& samples) {
    float farthest = 0;
    for (float r : samples.distance)
        if (r < infinity) farthest = std::max(farthest, r);
    return farthest;
}

bool stands_apart(Vec3 here, Vec3 direction, Vec3 there) {
    // The normals at the two ends of a chord of a circle differ by twice its elevation. Twice this angle plus 5° is
    // allowed, for facets and normal maps. All three numbers are chosen by judgement: with tighter ones, a curved
    // surface counts as its own obstacle and gets too many records; with looser ones, low steps are overlooked. Common
    // renderers ignore all hits below 10° instead.
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
    // There are three sectors per quadrant, counted from −u. They are found by comparisons, because every lookup calls
    // this.
    const float u = dot(d, frame.u), v = dot(d, frame.v);
    const auto third = [](float along, float across) {
        constexpr float tan_30 = 0.57735027f;
        return across < tan_30 * along ? 0 : tan_30 * across < along ? 1 : 2;
    };
    if (v < 0) return u < 0 ? third(-u, -v) : 3 + third(-v, u);
    return u > 0 ? 6 + third(u, v) : 9 + third(v, -u);
}

std::array<float, 12> sector_clearance(const HemisphereSamples& samples) {
    std::array<float, 12> out;
    out.fill(infinity);
    const Frame frame = Frame::around(samples.frame.n);
    for (int k = 0; k < samples.columns; ++k) {
        const float phi = 2 * pi * (static_cast<float>(k) + 0.5f) / static_cast<float>(samples.columns);
        float& sector = out[clearance_sector(frame, tangent(samples.frame, phi))];
        for (int j = 0; j < samples.rows; ++j) {
            const float s2 = row_middle(samples.kind, j, samples.rows);
            if (s2 < 0.5f || !samples.apart[size_t(j) * samples.columns + k]) continue;
            const float s = std::sqrt(s2);
            sector = std::min(sector, samples.r(j, k) * s);
        }
    }
    return out;
}

}  // namespace eclat
