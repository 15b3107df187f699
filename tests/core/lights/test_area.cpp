// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Emissive triangles: irradiance against Lambert's closed form, solid angles against Van Oosterom and Strackee's,
// densities against the sampler, textured emission against quadrature.

#include <doctest/doctest.h>

#include <initializer_list>
#include <vector>

#include "lights/area.h"
#include "lights/mean_emission.h"
#include "running_mean.h"
#include "sampling/rng.h"

using namespace eclat;

namespace {

constexpr std::span<const Value> untextured;

EmitterTriangle emitter(Vec3 p0, Vec3 p1, Vec3 p2, float radiance = 1) {
    return {.p0 = p0, .p1 = p1, .p2 = p2, .emission = Value{.constant = Color(radiance)}};
}

struct Dvec {
    double x, y, z;
};
Dvec minus(Vec3 a, Vec3 b) { return {double(a.x) - b.x, double(a.y) - b.y, double(a.z) - b.z}; }
double dot(Dvec a, Dvec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Dvec cross(Dvec a, Dvec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
double length(Dvec a) { return std::sqrt(dot(a, a)); }

/// Irradiance under a triangle of unit radiance that lies above the horizon, Lambert 1760.
double lambert(const EmitterTriangle& t, Vec3 at, Vec3 normal) {
    const Dvec corner[3] = {minus(t.p0, at), minus(t.p1, at), minus(t.p2, at)}, n = minus(normal, {});
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
        const Dvec a = corner[i], b = corner[(i + 1) % 3], c = cross(a, b);
        sum += std::atan2(length(c), dot(a, b)) * dot(n, c) / length(c);
    }
    return std::abs(sum) / 2;
}

/// The same where the triangle crosses the horizon of `normal`: it is cut off there.
double clipped_lambert(const EmitterTriangle& t, Vec3 at, Vec3 normal) {
    const Dvec n = minus(normal, {});
    std::vector<Dvec> corners;
    const Dvec given[3] = {minus(t.p0, at), minus(t.p1, at), minus(t.p2, at)};
    for (int i = 0; i < 3; ++i) {
        const Dvec a = given[i], b = given[(i + 1) % 3];
        const double over_a = dot(n, a), over_b = dot(n, b);
        if (over_a >= 0) corners.push_back(a);
        if ((over_a >= 0) == (over_b >= 0)) continue;
        const double s = over_a / (over_a - over_b);
        corners.push_back({a.x + s * (b.x - a.x), a.y + s * (b.y - a.y), a.z + s * (b.z - a.z)});
    }
    double sum = 0;
    for (size_t i = 0; i < corners.size(); ++i) {
        const Dvec a = corners[i], b = corners[(i + 1) % corners.size()], c = cross(a, b);
        if (length(c) > 0) sum += std::atan2(length(c), dot(a, b)) * dot(n, c) / length(c);
    }
    return std::abs(sum) / 2;
}

double solid_angle(const EmitterTriangle& t, Vec3 at) {
    const Dvec a = minus(t.p0, at), b = minus(t.p1, at), c = minus(t.p2, at);
    const double la = length(a), lb = length(b), lc = length(c);
    const double below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    return 2 * std::atan2(std::abs(dot(a, cross(b, c))), below);
}

struct Sight {
    Vec3 at, normal;
};

// From far to almost touching; the triangle below spans z = 1 and faces down.
const EmitterTriangle ceiling = emitter({-1, -1, 1}, {-1, 1, 1}, {2, -1, 1});
const Sight sights[] = {
    {{0, 0, -30}, {0, 0, 1}},
    {{0.3f, 0.2f, -4}, normalize({0.3f, -0.1f, 1})},
    {{0.1f, -0.2f, 0}, {0, 0, 1}},
    {{0, 0, 0.9f}, {0, 0, 1}},
    {{-0.2f, -0.3f, 0.999f}, {0, 0, 1}},
    {{-5, 3, 0.5f}, normalize({1, -0.5f, 0.2f})},
    {{1, 0.5f, 0.7f}, {0, 0, 1}},
};

}  // namespace

TEST_CASE("irradiance under a triangle is Lambert's, from afar, near by and almost touching") {
    const AreaLight light(ceiling, 0);
    for (const Sight& sight : sights) {
        CAPTURE(sight.at.z);
        RunningMean irradiance, angle;
        Rng rng(7, 1);
        for (int i = 0; i < 40000; ++i) {
            const LightSample s = light.sample(untextured, sight.at, {rng.next(), rng.next()});
            REQUIRE(s.pdf_solid_angle > 0);
            REQUIRE(s.radiance.r == 1);
            irradiance.add(std::max(0.0f, dot(s.wi, sight.normal)) / s.pdf_solid_angle);
            angle.add(1 / s.pdf_solid_angle);
        }
        CHECK(irradiance.agrees(lambert(ceiling, sight.at, sight.normal)));
        CHECK(angle.agrees(solid_angle(ceiling, sight.at)));
    }
}

TEST_CASE("the density of a hit is the one it was sampled with") {
    const AreaLight light(ceiling, 0);
    for (const Sight& sight : sights) {
        CAPTURE(sight.at.z);
        Rng rng(8, 1);
        for (int i = 0; i < 1000; ++i) {
            const LightSample s = light.sample(untextured, sight.at, {rng.next(), rng.next()});
            const Vec3 hit = sight.at + s.wi * s.distance;
            CHECK(hit.z == doctest::Approx(1).epsilon(1e-5));
            CHECK(light.pdf_solid_angle(sight.at, hit) == doctest::Approx(s.pdf_solid_angle).epsilon(1e-3));
        }
    }
}

TEST_CASE("irradiance is Lambert's at all distances, near the triangle's plane and under slivers, with little noise") {
    const EmitterTriangle square_half = emitter({-1, -1, 0}, {-1, 1, 0}, {2, -1, 0});
    const EmitterTriangle sliver = emitter({-1, 0, 0}, {0, 1e-4f, 0}, {1, 0, 0});
    for (const EmitterTriangle& triangle : {square_half, sliver}) {
        const AreaLight light(triangle, 0);
        // Under the middle, under an edge's neighbourhood, beside the triangle, and beyond a corner.
        for (const Vec2 foot : {Vec2{0, 5e-5f}, Vec2{-1.001f, 0}, Vec2{-1.3f, 0.2f}, Vec2{3, -1.5f}}) {
            for (float height = 1e-4f; height < 2e3f; height *= 10) {
                const Vec3 at{foot.x, foot.y, -height}, up{0, 0, 1};
                const Vec3 aslant = normalize(normalize(Vec3{0, 0.1f, height}) + normalize(Vec3{0, 0, 0} - at));
                for (const Vec3 normal : {up, aslant}) {
                    CAPTURE(triangle.p1.y);
                    CAPTURE(foot.x);
                    CAPTURE(height);
                    CAPTURE(normal.z);
                    const double truth = clipped_lambert(triangle, at, normal);
                    RunningMean irradiance;
                    Rng rng(17, 1);
                    for (int i = 0; i < 2000; ++i) {
                        const LightSample s = light.sample(untextured, at, {rng.next(), rng.next()});
                        const double cosine = std::max(0.0f, dot(s.wi, normal));
                        irradiance.add(s.pdf_solid_angle > 0 ? cosine / s.pdf_solid_angle : 0);
                    }
                    CHECK(std::abs(irradiance.mean() - truth) <= 5 * irradiance.standard_error() + 1e-4 * truth);
                    CHECK(irradiance.standard_error() < 0.05 * truth);
                }
            }
        }
    }
}

TEST_CASE("the density over a triangle integrates to one, from all distances and near its plane") {
    const AreaLight light(ceiling, 0);
    for (const float height : {1e-4f, 1e-2f, 1.0f, 1e2f}) {
        for (const float x : {-0.3f, -1.001f, -1.2f}) {
            CAPTURE(height);
            CAPTURE(x);
            // The plane in polar coordinates about the foot, with radii in geometric steps, which resolve what is near.
            const Vec3 at{x, 0.1f, 1 - height};
            double sum = 0;
            constexpr int around = 1440, steps = 4000;
            const double first = 1e-3 * height, ratio = std::pow(10 / first, 1.0 / steps);
            for (int i = 0; i < around; ++i) {
                const double phi = 2 * M_PI * (i + 0.5) / around;
                for (int k = 0; k < steps; k += 4) {
                    const double inner = k == 0 ? 0 : first * std::pow(ratio, k),
                                 outer = first * std::pow(ratio, k + 4);
                    const double r = k == 0 ? outer * 0.7 : std::sqrt(inner * outer);
                    const Vec3 on{static_cast<float>(x + r * std::cos(phi)),
                                  static_cast<float>(0.1 + r * std::sin(phi)), 1};
                    if (on.x < -1 || on.y < -1 || 2 * on.x + 3 * on.y > 1) continue;
                    const auto cosine = [&](double radius) { return height / std::hypot(radius, double(height)); };
                    const double angle = (cosine(inner) - cosine(outer)) * 2 * M_PI / around;
                    sum += light.pdf_solid_angle(at, on) * angle;
                }
            }
            CHECK(sum == doctest::Approx(1).epsilon(0.01));
        }
    }
}

TEST_CASE("a large triangle is sampled with one density, the reciprocal of its solid angle") {
    const AreaLight light(ceiling, 0);
    const Vec3 at{0.1f, -0.2f, 0};
    const double expected = 1 / solid_angle(ceiling, at);
    for (const Vec2 u : {Vec2{0, 0}, Vec2{0.3f, 0.9f}, Vec2{below_one, below_one}}) {
        CHECK(light.sample(untextured, at, u).pdf_solid_angle == doctest::Approx(expected).epsilon(1e-5));
    }
}

TEST_CASE("triangles emit on one side or on both") {
    EmitterTriangle t = ceiling;
    const Vec3 below{0, 0, 0}, above{0, 0, 2}, level{5, 5, 1};
    for (const bool two_sided : {false, true}) {
        t.two_sided = two_sided;
        const AreaLight light(t, 0);
        CHECK(light.sample(untextured, below, {0.3f, 0.4f}).radiance.g == 1);
        CHECK((light.sample(untextured, above, {0.3f, 0.4f}).pdf_solid_angle > 0) == two_sided);
        CHECK(light.sample(untextured, level, {0.3f, 0.4f}).pdf_solid_angle == 0);
        CHECK(light.emitted(untextured, {0.2f, 0.2f}, {0, 0, -1}).r == 1);
        CHECK(light.emitted(untextured, {0.2f, 0.2f}, {0, 0, 1}).r == (two_sided ? 1 : 0));
    }
}

TEST_CASE("broken triangles and points on the triangle give nothing, not NaN") {
    const Vec3 p{1, 2, 3};
    for (const EmitterTriangle& t : {emitter(p, p, p), emitter({0, 0, 0}, {1, 1, 1}, {2, 2, 2})}) {
        const AreaLight light(t, 0);
        CHECK(light.area() == 0);
        CHECK(light.sample(untextured, {}, {0.1f, 0.5f}).pdf_solid_angle == 0);
        CHECK(light.emitted(untextured, {}, {0, 0, 1}).r == 0);
        CHECK(light.pdf_solid_angle({5, 5, 5}, p) == 0);
    }
    EmitterTriangle t = ceiling;
    t.two_sided = true;
    const AreaLight light(t, 0);
    for (const Vec3 on : {t.p0, t.p1, (t.p0 + t.p1 + t.p2) * (1.0f / 3), (t.p0 + t.p1) * 0.5f}) {
        for (const float height : {0.0f, 1e-7f, -1e-7f, 1e-30f}) {
            const LightSample s = light.sample(untextured, on + Vec3{0, 0, height}, {0.4f, 0.7f});
            CHECK(s.pdf_solid_angle >= 0);
            if (s.pdf_solid_angle > 0) CHECK(is_finite(s.wi));
        }
    }
}

TEST_CASE("textured emission: samples agree with hits") {
    std::vector<float> image(16 * 16 * 3);
    Rng rng(9, 9);
    for (float& x : image) x = rng.next();
    const Texture texture(ImageView{16, 16, 3, nullptr, image.data()}, {});
    EmitterTriangle t = ceiling;
    t.emission.texture = &texture;
    t.uv0 = {0.1f, 0.2f};
    t.uv1 = {0.8f, 0.3f};
    t.uv2 = {0.4f, 0.9f};
    const AreaLight light(t, 0);
    const std::vector<Value> emissions = {t.emission};
    const Vec3 n = cross(t.p1 - t.p0, t.p2 - t.p0);
    for (const Vec3 at : {Vec3{0, 0, 0.5f}, Vec3{0, 0, -10}}) {
        for (int i = 0; i < 1000; ++i) {
            const LightSample s = light.sample(emissions, at, {rng.next(), rng.next()});
            const Vec3 d = at + s.wi * s.distance - t.p0;
            const Vec2 bary{dot(cross(d, t.p2 - t.p0), n) / dot(n, n), dot(cross(t.p1 - t.p0, d), n) / dot(n, n)};
            const Color seen = light.emitted(emissions, bary, -s.wi);
            for (int c = 0; c < 3; ++c) CHECK(s.radiance[c] == doctest::Approx(seen[c]).epsilon(1e-3));
        }
    }
}

TEST_CASE("the mean emission over a footprint is near the texture's mean, and 0 only if nothing emits") {
    const uint32_t size = 1500;  // more than the blocks' number, so that blocks hold several texels
    std::vector<uint8_t> image(size * size, 0);
    image[700 * size + 300] = 255;
    for (uint32_t y = 1000; y < 1200; ++y) {
        for (uint32_t x = 1000; x < 1200; ++x) image[y * size + x] = 51;
    }
    const float s = size;
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirror, Wrap::clamp}) {
        const Texture texture(ImageView{size, size, 1, image.data(), nullptr}, {.wrap_u = wrap, .wrap_v = wrap});
        const MeanEmission mean(Value{.constant = Color(2.0f), .texture = &texture});
        CHECK(mean.over({1020 / s, 1020 / s}, {1180 / s, 1020 / s}, {1020 / s, 1180 / s}).mean.g ==
              doctest::Approx(0.4));
        // A triangle that only the filter of the lone texel reaches.
        CHECK(mean.over({290 / s, 690 / s}, {300 / s, 690 / s}, {300 / s, 700 / s}).weight > 0);
        // All of the picture, in which point samples miss the lone texel; dark far away.
        CHECK(mean.over({0.1f, 0.1f}, {0.9f, 0.1f}, {0.1f, 0.9f}).weight > 0);
        CHECK(mean.over({0.02f, 0.02f}, {0.1f, 0.02f}, {0.02f, 0.1f}).weight == 0);
        // Beyond the picture, and where coordinates are useless.
        CHECK((mean.over({2.02f, 2.02f}, {2.1f, 2.02f}, {2.02f, 2.1f}).weight == 0));
        CHECK(mean.over({1e9f, 0}, {1e9f, 1}, {0, 1e9f}).weight > 0);
        CHECK(mean.over({NAN, 0}, {0, 1}, {1, 0}).weight > 0);
        if (wrap == Wrap::repeat) CHECK(mean.over({-0.2f, 2.7f}, {-0.21f, 2.7f}, {-0.2f, 2.71f}).mean.r > 0);
        if (wrap == Wrap::mirror) CHECK(mean.over({-0.7f, 2.7f}, {-0.71f, 2.7f}, {-0.7f, 2.71f}).mean.r > 0);
        if (wrap == Wrap::mirror) CHECK(mean.over({-0.2f, 0.2f}, {-0.21f, 0.2f}, {-0.2f, 0.21f}).weight == 0);
    }
}

TEST_CASE("no light comes to a lamp from itself, though rounding puts its points before or behind it") {
    Rng rng(5, 0);
    for (int i = 0; i < 2000; ++i) {
        const auto corner = [&] { return Vec3{rng.next(), rng.next(), rng.next()} * 2 - Vec3{1, 1, 1}; };
        EmitterTriangle t = emitter(corner(), corner(), corner());
        const Vec3 e1 = t.p1 - t.p0, e2 = t.p2 - t.p0, normal = normalize(cross(e1, e2));
        const Vec2 b = square_to_triangle({rng.next(), rng.next()});
        const Vec3 on = t.p0 + e1 * b.x + e2 * b.y;
        const Vec2 u{rng.next(), rng.next()};
        const LightSample one = AreaLight(t, 0).sample(untextured, on, u);
        CHECK((!(one.pdf_solid_angle > 0) || eclat::dot(one.wi, normal) < 1e-6));
        t.two_sided = true;
        const LightSample two = AreaLight(t, 0).sample(untextured, on, u);
        CHECK(!(two.pdf_solid_angle > 0));
    }
}
