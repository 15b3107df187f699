// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The hits of a gather are connected to a mesh; each triangle has the radiance of its farthest vertex, so that the steep
// triangles at a discontinuity of depth move with the silhouette in front [Schwarzhaupt12]. Irradiance then changes only because
// edges between triangles of different radiance move over the hemisphere.
//
// Symbol      name here        meaning                                                            unit
//   p(t)                       a point of an edge, seen from x, p = a/near_a + t (b/near_b − a/near_a)   m
//   c                          p(0) × p(1): at right angles to the plane through x and the edge   m²
//   ΔL        jump             radiance on the side that c points to, minus that on the other       W m⁻² sr⁻¹
//
// An edge that is fixed in space sweeps solid angle as x moves in the tangent plane (Reynolds' transport theorem), so
//   ∇E = Σ ΔL c ∫ p_z / |p|⁴ dt ,   and once more   ∂²E/∂x_i∂x_j = 2 Σ ΔL ∫ p_z (c_i p_j + c_j p_i) / |p|⁶ dt ,
// where the antisymmetric part of each edge is left out: it cancels around every vertex. With the chord m(s) between the
// unit directions in place of p nothing is divided by the edge's length, and nothing cancels:
//   p = m |p| / |m| ,  1/|p| = ((1−s) near_a + s near_b) / |m| ,  c dt = (a × b) |p|² ds / |m|² .
//
// Departure   [Schwarzhaupt12] adds up closed-form Hessians of whole triangles, which takes the ring below the last row of
//             samples for black. Here an edge counts only where radiance jumps, so the last row reaches down to the horizon.
// Held to     tests/core/hemisphere/test_irradiance_hessian.cpp: finite differences of Lambert's polygon formula.

#include "hemisphere/irradiance_hessian.h"

#include <utility>

namespace eclat {

namespace {

// Without light there is no curvature, and records would be valid everywhere. This share of the mean radiance is
// therefore added everywhere, with darkness below the last row [Schwarzhaupt12].
constexpr float added_share = 0.01f;

/// The mesh's vertices: columns 0 … N of each row, the last one being the first again.
struct Vertices {
    int rows, stride;
    std::vector<float> x, y, z, near, radiance;

    size_t at(int j, int k) const { return size_t(j) * stride + k; }
};

Vertices vertices_of(const HemisphereSamples& samples, float far) {
    Vertices v{samples.rows, samples.columns + 1, {}, {}, {}, {}, {}};
    for (int j = 0; j < samples.rows; ++j)
        for (int k = 0; k <= samples.columns; ++k) {
            const size_t cell = size_t(j) * samples.columns + k % samples.columns;
            const Vec3 w = samples.direction[cell];
            v.x.push_back(w.x);
            v.y.push_back(w.y);
            v.z.push_back(w.z);
            v.near.push_back(1 / std::min(samples.distance[cell], far));
            v.radiance.push_back(luminance(samples.radiance[cell]));
        }
    return v;
}

/// Edges from vertices `from + i` to `to + i` for i in [0, count), with `jump[i]` across each.
TangentHessian edges(const Vertices& v, size_t from, size_t to, const float* jump, int count) {
    float uu = 0, uv = 0, vv = 0;
    // Gauss's two points: the integrand is nearly a polynomial of degree two.
    constexpr float points[2] = {0.21132487f, 0.78867513f};
    constexpr int width = 8;  // fixed, so that sums never depend on the compiler's choice of vectors
    float sum_uu[width] = {}, sum_uv[width] = {}, sum_vv[width] = {};
    const auto add = [&](int i, int lane) {
        const size_t a = from + i, b = to + i;
        const float cx = v.y[a] * v.z[b] - v.z[a] * v.y[b], cy = v.z[a] * v.x[b] - v.x[a] * v.z[b];
        for (float s : points) {
            const float mx = v.x[a] + s * (v.x[b] - v.x[a]), my = v.y[a] + s * (v.y[b] - v.y[a]),
                        mz = v.z[a] + s * (v.z[b] - v.z[a]);
            const float m2 = mx * mx + my * my + mz * mz, near = v.near[a] + s * (v.near[b] - v.near[a]);
            const float f = jump[i] * mz * near * near / (m2 * m2 * m2);
            sum_uu[lane] += f * 2 * cx * mx;
            sum_uv[lane] += f * (cx * my + cy * mx);
            sum_vv[lane] += f * 2 * cy * my;
        }
    };
    int i = 0;
    for (; i + width <= count; i += width)
        for (int lane = 0; lane < width; ++lane) add(i + lane, lane);
    for (; i < count; ++i) add(i, 0);
    for (int lane = 0; lane < width; ++lane) {
        uu += sum_uu[lane];
        uv += sum_uv[lane];
        vv += sum_vv[lane];
    }
    return {uu, uv, vv};
}

TangentHessian operator+(const TangentHessian& a, const TangentHessian& b) {
    return {a.uu + b.uu, a.uv + b.uv, a.vv + b.vv};
}

TangentHessian of_mesh(const HemisphereSamples& samples, float far) {
    const Vertices v = vertices_of(samples, far);
    const int M = samples.rows, N = samples.columns;
    const auto farthest = [&](size_t a, size_t b, size_t c) {
        const size_t ab = v.near[b] < v.near[a] ? b : a;
        return v.radiance[v.near[c] < v.near[ab] ? c : ab];
    };
    // Each quad has two triangles, (a, c, b) and (b, c, e); `right` repeats its last column at the front.
    std::vector<float> left(size_t(M) * N), right(size_t(M) * (N + 1));
    for (int j = 0; j + 1 < M; ++j) {
        for (int k = 0; k < N; ++k) {
            const size_t a = v.at(j, k), b = v.at(j, k + 1), c = v.at(j + 1, k), e = v.at(j + 1, k + 1);
            left[size_t(j) * N + k] = farthest(a, c, b);
            right[size_t(j) * (N + 1) + k + 1] = farthest(b, c, e);
        }
        right[size_t(j) * (N + 1)] = right[size_t(j) * (N + 1) + N];
    }
    TangentHessian sum;
    std::vector<float> jump(N);
    // The area inside the first row is a fan from its first vertex.
    std::vector<float> fan(N);
    for (int k = 1; k + 1 < N; ++k) fan[k] = farthest(v.at(0, 0), v.at(0, k), v.at(0, k + 1));
    fan[0] = fan[1];
    fan[N - 1] = fan[N - 2];
    for (int k = 2; k + 1 < N; ++k) {
        jump[0] = fan[k] - fan[k - 1];
        sum = sum + edges(v, v.at(0, 0), v.at(0, k), jump.data(), 1);
    }
    for (int k = 0; k < N; ++k) jump[k] = fan[k] - left[k];
    sum = sum + edges(v, v.at(0, 0), v.at(0, 1), jump.data(), N);
    for (int j = 0; j + 1 < M; ++j) {
        const float *A = &left[size_t(j) * N], *B = &right[size_t(j) * (N + 1)];
        for (int k = 0; k < N; ++k) jump[k] = A[k] - B[k + 1];
        sum = sum + edges(v, v.at(j + 1, 0), v.at(j, 1), jump.data(), N);
        for (int k = 0; k < N; ++k) jump[k] = A[k] - B[k];
        sum = sum + edges(v, v.at(j, 0), v.at(j + 1, 0), jump.data(), N);
        if (j + 2 == M) break;
        for (int k = 0; k < N; ++k) jump[k] = B[k + 1] - A[N + k];
        sum = sum + edges(v, v.at(j + 1, 0), v.at(j + 1, 1), jump.data(), N);
    }
    float mean = 0;
    for (const Color& L : samples.radiance) mean += luminance(L);
    mean /= static_cast<float>(samples.radiance.size());
    std::fill(jump.begin(), jump.end(), added_share * mean);
    return sum + edges(v, v.at(M - 1, 0), v.at(M - 1, 1), jump.data(), N);
}

// Each cell is a small patch of area ΔA at y with normal n', L ΔA cos θ cos θ' / r² = L ΔA p_z (−p·n') / |p|⁴ with
// p = y − x; its second derivatives in x, with ΔA (−p·n') / |p|³ = Δω.
TangentHessian of_patches(const HemisphereSamples& samples, bool by_radiance) {
    TangentHessian sum;
    float mean = 0;
    for (const Color& L : samples.radiance) mean += luminance(L);
    mean /= static_cast<float>(samples.radiance.size());
    for (size_t i = 0; i < samples.radiance.size(); ++i) {
        const float r = samples.distance[i];
        if (!(r < infinity)) continue;
        const Vec3 w = samples.direction[i], n = samples.hit_normal[i];
        const float facing = -dot(w, n);
        if (facing < 0.05f) continue;  // the visible area of such patches is negligible
        const float L = by_radiance ? luminance(samples.radiance[i]) : mean;
        // k = q / |p|⁴ with q = −p·n' and ∂p = −∂x: k_ij = (q_i g_j + q_j g_i) + q g_ij, g = |p|⁻⁴.
        const float nx = n.x / facing, ny = n.y / facing;
        const auto second = [&](float wi, float wj, float ni, float nj, float same) {
            return 4 * (ni * wj + nj * wi) + 24 * wi * wj - 4 * same;
        };
        const float scale = L / (r * r);
        sum.uu += scale * second(w.x, w.x, nx, nx, 1);
        sum.uv += scale * second(w.x, w.y, nx, ny, 0);
        sum.vv += scale * second(w.y, w.y, ny, ny, 1);
    }
    const float share = pi / static_cast<float>(samples.radiance.size());  // of cos θ dω, a cell's
    return {sum.uu * share, sum.uv * share, sum.vv * share};
}

}  // namespace

TangentHessian edge_hessian(Vec3 a, float near_a, Vec3 b, float near_b) {
    const Vertices v{1, 2, {a.x, b.x}, {a.y, b.y}, {a.z, b.z}, {near_a, near_b}, {0, 0}};
    const float jump = 1;
    return edges(v, 0, 1, &jump, 1);
}

TangentHessian irradiance_hessian(const HemisphereSamples& samples, Curvature curvature, float far) {
    if (curvature == Curvature::occlusion) return of_mesh(samples, far);
    return of_patches(samples, curvature == Curvature::radiometric);
}

PrincipalCurvatures principal_curvatures(const TangentHessian& h) {
    const float mean = 0.5f * (h.uu + h.vv), half = 0.5f * (h.uu - h.vv);
    const float spread = std::sqrt(half * half + h.uv * h.uv);
    PrincipalCurvatures out{std::fabs(mean + spread), std::fabs(mean - spread), 0.5f * std::atan2(h.uv, half)};
    if (out.larger < out.smaller) {
        std::swap(out.larger, out.smaller);
        out.angle += 0.5f * pi;
    }
    return out;
}

}  // namespace eclat
