// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Second derivatives against finite differences of Lambert's polygon formula.

#include "hemisphere/irradiance_hessian.h"

#include <doctest/doctest.h>

#include "plate_scene.h"

using namespace eclat;

namespace {

/// Of f(x, y) at (x, y), by finite differences.
template <class F>
TangentHessian finite_differences(double x, double y, const F& f) {
    const double h = 1e-3;
    const auto at = [&](int i, int j) { return f(x + i * h, y + j * h); };
    return {static_cast<float>((at(1, 0) - 2 * at(0, 0) + at(-1, 0)) / (h * h)),
            static_cast<float>((at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * h * h)),
            static_cast<float>((at(0, 1) - 2 * at(0, 0) + at(0, -1)) / (h * h))};
}

double size_of(const TangentHessian& h) { return std::sqrt(h.uu * h.uu + 2 * h.uv * h.uv + h.vv * h.vv); }
TangentHessian difference(const TangentHessian& a, const TangentHessian& b) {
    return {a.uu - b.uu, a.uv - b.uv, a.vv - b.vv};
}
void add(TangentHessian& sum, const TangentHessian& h) {
    sum.uu += h.uu;
    sum.uv += h.uv;
    sum.vv += h.vv;
}

/// The mean over many gathers, whose noise it takes away.
template <class F>
TangentHessian averaged_hessian(int gathers, const F& f) {
    TangentHessian sum;
    for (int i = 0; i < gathers; ++i) add(sum, f(static_cast<uint32_t>(i)));
    const auto n = static_cast<float>(gathers);
    return {sum.uu / n, sum.uv / n, sum.vv / n};
}

using Polygon = std::vector<std::array<double, 3>>;

}  // namespace

TEST_CASE("the edges of a polygon add up to the second derivatives of its irradiance") {
    // The inside is where a × b points to, of each edge from a to b: clockwise, seen from the origin.
    const Polygon polygons[] = {{{0.2, -0.5, 1}, {1.1, -0.5, 1}, {1.1, 0.6, 1}, {0.2, 0.6, 1}},
                                {{1, -0.4, 0.1}, {0.7, 0.8, 0.3}, {-0.6, 0.5, 2.0}},
                                {{3, -8, 0.5}, {20, 4, 9}, {-2, 5, 1}}};
    for (const Polygon& polygon : polygons) {
        const auto irradiance_at = [&](double x, double y) {
            Polygon seen = polygon;
            for (auto& v : seen) v[0] -= x, v[1] -= y;
            return form(seen, {0, 0, 1});
        };
        const TangentHessian expected = finite_differences(0, 0, irradiance_at);
        // Cut into short edges, as those of a gather are.
        constexpr int parts = 80;
        TangentHessian sum;
        for (size_t i = 0; i < polygon.size(); ++i)
            for (int part = 0; part < parts; ++part) {
                const auto vertex = [&](double t) {
                    const auto &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
                    return Vec3{float(a[0] + t * (b[0] - a[0])), float(a[1] + t * (b[1] - a[1])),
                                float(a[2] + t * (b[2] - a[2]))};
                };
                const Vec3 a = vertex(double(part) / parts), b = vertex(double(part + 1) / parts);
                add(sum, edge_hessian(a / length(a), 1 / length(a), b / length(b), 1 / length(b)));
            }
        CHECK(size_of(difference(sum, expected)) < 2e-3 * size_of(expected));
    }
}

TEST_CASE("occlusion: curvature under ceiling, patch and plate, within 14 % at 64 rows") {
    for (const auto& [x, y] : {std::pair{0.3, 0.2}, {-0.2, 0.1}, {-0.5, -0.3}}) {
        CAPTURE(x);
        const TangentHessian expected = finite_differences(x, y, [](double px, double py) { return exact(px, py); });
        const TangentHessian found = averaged_hessian(30, [&](uint32_t seed) {
            return irradiance_hessian(gather(64, float(x), float(y), seed), Curvature::occlusion, 100);
        });
        CHECK(size_of(difference(found, expected)) < 0.14 * size_of(expected));
    }
}

TEST_CASE("14 rows give the curvature within 40 %") {
    const auto exact_size =
        principal_curvatures(finite_differences(0.3, 0.2, [](double x, double y) { return exact(x, y); })).larger;
    for (uint32_t seed = 0; seed < 20; ++seed) {
        const float found =
            principal_curvatures(irradiance_hessian(gather(14, 0.3f, 0.2f, seed), Curvature::occlusion, 100)).larger;
        CHECK(found > 0.6f * exact_size);
        CHECK(found < 1.4f * exact_size);
    }
}

TEST_CASE("the curvature under a wide uniform ceiling is 0") {
    const auto look = [](Vec3 w) { return Seen{1, 1 / w.z}; };
    for (const Curvature curvature : {Curvature::occlusion, Curvature::radiometric, Curvature::geometric}) {
        const TangentHessian found = averaged_hessian(
            200, [&](uint32_t seed) { return irradiance_hessian(look_around(16, seed, look), curvature, 1e4f); });
        CHECK(size_of(found) < 0.05 * pi);  // E is π, its distance 1
    }
}

TEST_CASE("the curvature from patches that stay visible: a bright rectangle in a dark scene") {
    const auto look = [](Vec3 w) {
        const float t = 1 / w.z, x = t * w.x, y = t * w.y;
        return x > 0.2f && x < 1.1f && y > -0.5f && y < 0.6f ? Seen{1, t} : Seen{};
    };
    const TangentHessian expected =
        finite_differences(0, 0, [](double x, double y) { return form(0.2, 1.1, -0.5, 0.6, 1, x, y, {0, 0, 1}); });
    for (const Curvature curvature : {Curvature::occlusion, Curvature::radiometric}) {
        const TangentHessian found = averaged_hessian(
            200, [&](uint32_t seed) { return irradiance_hessian(look_around(24, seed, look), curvature, 50); });
        const double bound = curvature == Curvature::occlusion ? 0.14 : 0.06;  // a mesh's rims lie half a cell outside
        CHECK(size_of(difference(found, expected)) < bound * size_of(expected));
    }
}

TEST_CASE("at twice the distance the curvature is a quarter; with twice the radiance it is twice as large") {
    const HemisphereSamples near = gather(16, 0.1f, 0.2f);
    HemisphereSamples far = near;
    for (float& r : far.distance) r *= 2;
    HemisphereSamples bright = near;
    for (Color& L : bright.radiance) L *= 2;
    for (const Curvature curvature : {Curvature::occlusion, Curvature::radiometric, Curvature::geometric}) {
        const float once = principal_curvatures(irradiance_hessian(near, curvature, 1000)).larger;
        CHECK(once > 0);
        CHECK(principal_curvatures(irradiance_hessian(far, curvature, 2000)).larger == doctest::Approx(once / 4));
        CHECK(principal_curvatures(irradiance_hessian(bright, curvature, 1000)).larger == doctest::Approx(2 * once));
    }
}

TEST_CASE("the curvature under a sky alone, and in an empty scene, is 0") {
    for (const float radiance : {0.0f, 1.0f}) {
        const auto look = [&](Vec3) { return Seen{radiance, infinity}; };
        for (const Curvature curvature : {Curvature::occlusion, Curvature::radiometric, Curvature::geometric}) {
            const auto bends = principal_curvatures(irradiance_hessian(look_around(8, 1, look), curvature, 1e6f));
            CHECK(bends.larger < 1e-9f);
        }
    }
}

TEST_CASE("principal curvatures: sizes, and the direction of the larger one") {
    const float angle = 0.4f, c = std::cos(angle), s = std::sin(angle);
    // 3 along `angle`, −5 across it.
    const auto bends = principal_curvatures({3 * c * c - 5 * s * s, (3 + 5) * c * s, 3 * s * s - 5 * c * c});
    CHECK(bends.larger == doctest::Approx(5));
    CHECK(bends.smaller == doctest::Approx(3));
    CHECK(std::fabs(std::sin(bends.angle - angle)) == doctest::Approx(1));
    const auto other = principal_curvatures({5 * c * c - 3 * s * s, (5 + 3) * c * s, 5 * s * s - 3 * c * c});
    CHECK(other.larger == doctest::Approx(5));
    CHECK(std::fabs(std::cos(other.angle - angle)) == doctest::Approx(1));
}
