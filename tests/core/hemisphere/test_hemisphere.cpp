// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Gather gradients against finite differences of an irradiance known in closed form (Lambert's polygon formula).

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "plate_scene.h"
#include "sampling/rng.h"

using namespace eclat;

namespace {

/// Mean of `f(seed)` over many gathers, whose noise it takes away: what is left is the bias.
template <class F>
Vec3 averaged(int gathers, const F& f) {
    Vec3 sum{};
    for (int i = 0; i < gathers; ++i) sum += f(static_cast<uint32_t>(i));
    return sum / static_cast<float>(gathers);
}

}  // namespace

TEST_CASE("uniform radiance gives exactly π") {
    HemisphereSamples s = gather(16, 0, 0);
    for (Color& L : s.radiance) L = Color(1);
    CHECK(irradiance(s).r == doctest::Approx(pi).epsilon(1e-6));
}

TEST_CASE("irradiance under ceiling, patch and plate") {
    CHECK(irradiance(gather(64, 0.3f, 0.2f)).g == doctest::Approx(exact(0.3, 0.2)).epsilon(0.005));
}

TEST_CASE("translation gradient against the closed form") {
    const float x = 0.3f, y = 0.2f;
    const double h = 1e-4;
    const double dx = (exact(x + h, y) - exact(x - h, y)) / (2 * h), dy = (exact(x, y + h) - exact(x, y - h)) / (2 * h);
    const TranslationGradient g = translation_gradient(gather(64, x, y));
    const double scale = std::hypot(dx, dy);
    CHECK(std::hypot(g.channel[0].x - dx, g.channel[0].y - dy) < 0.03 * scale);
    CHECK(g.channel[0].z == 0);
}

TEST_CASE("rotation gradient against the closed form") {
    // Turning the normal by α around y moves it by α towards x: dE/dα = (n × n')·gradient / α.
    const float x = 0.3f, y = 0.2f;
    const double a = 1e-3;
    const auto turned = [&](double ax, double ay) {
        // Around the axis (ax, ay, 0): n' = n + axis × n. All that is lit stays above the horizon but for the far
        // ceiling, whose cosine is nearly zero there.
        const std::array<double, 3> n{ay, -ax, 1};
        return exact(x, y, n);
    };
    const double about_x = (turned(a, 0) - turned(-a, 0)) / (2 * a), about_y = (turned(0, a) - turned(0, -a)) / (2 * a);
    const RotationGradient g = rotation_gradient(gather(64, x, y));
    const double scale = std::hypot(about_x, about_y);
    CHECK(std::hypot(g.channel[0].x - about_x, g.channel[0].y - about_y) < 0.05 * scale);
}

TEST_CASE("translation gradient: the bias of 64 rows is below 1.5 %, or 3 % with the edge of a plate overhead") {
    // With an edge that crosses the first row of cells, that row's wall carries the gradient: a sum that starts at the
    // second wall misses it.
    for (const auto& [x, y, bound] : {std::array{0.3, 0.2, 0.015}, {0.07, 0.15, 0.03}}) {
        CAPTURE(x);
        const double h = 1e-4;
        const double dx = (exact(x + h, y) - exact(x - h, y)) / (2 * h),
                     dy = (exact(x, y + h) - exact(x, y - h)) / (2 * h);
        const Vec3 mean = averaged(
            40, [&](uint32_t seed) { return translation_gradient(gather(64, float(x), float(y), seed)).channel[1]; });
        CHECK(std::hypot(mean.x - dx, mean.y - dy) < bound * std::hypot(dx, dy));
    }
}

TEST_CASE("rotation gradient: light from the side, from few rows on, and its sign") {
    // A wall at x = 1 of radiance 1, all above the horizon whichever way the normal turns.
    const float low = 0.02f, high = 2, half = 3;
    const auto irradiance_of = [&](std::array<double, 3> n) {
        return form({{1, -half, low}, {1, half, low}, {1, half, high}, {1, -half, high}}, n);
    };
    const double a = 1e-3;
    const double towards_wall = (irradiance_of({a, 0, 1}) - irradiance_of({-a, 0, 1})) / (2 * a);
    CHECK(towards_wall > 0.5);
    for (const int rows : {8, 16, 32}) {
        CAPTURE(rows);
        const Vec3 mean = averaged(60, [&](uint32_t seed) {
            return rotation_gradient(look_around(rows, seed,
                                                 [&](Vec3 w) {
                                                     const float t = 1 / w.x, y = t * w.y, z = t * w.z;
                                                     return t > 0 && std::abs(y) < half && z > low && z < high
                                                                ? Seen{1, t}
                                                                : Seen{};
                                                 }))
                .channel[2];
        });
        // The normal turns towards +x about +y: (n × n')·gradient.
        CHECK(mean.y == doctest::Approx(towards_wall).epsilon(0.02));
        CHECK(std::abs(mean.x) < 0.02 * towards_wall);
        CHECK(mean.z == 0);
    }
}

TEST_CASE(
    "excess: a few bright cells are reduced to their share, and the removed irradiance is the missing irradiance") {
    const HemisphereSamples calm = gather(16, 0.3f, 0.2f);
    HemisphereSamples same = calm;
    CHECK(is_black(take_excess(same)));
    CHECK(irradiance(same).g == irradiance(calm).g);

    HemisphereSamples bright = calm;
    for (const size_t cell : {size_t(5), size_t(77), size_t(400)}) bright.radiance[cell] = Color(900, 1000, 1100);
    const Color whole = irradiance(bright), taken = take_excess(bright), rest = irradiance(bright);
    for (int c = 0; c < 3; ++c) CHECK(rest[c] + taken[c] == doctest::Approx(whole[c]).epsilon(1e-5));
    // Row and column of the cells 77 and 400 add up to even numbers, those of 5 to an odd one. A limit is a twentieth of twice
    // what remains of the other half: ℓ = S / 10 / (1 − k / 10) with k bright cells in that half and the sum S of its others.
    const auto columns = size_t(bright.columns);
    float even = 0, odd = 0;
    for (size_t i = 0; i < calm.radiance.size(); ++i)
        if (i != 5 && i != 77 && i != 400)
            ((i / columns + i % columns) % 2 ? odd : even) += luminance(calm.radiance[i]);
    CHECK(luminance(bright.radiance[5]) == doctest::Approx(0.1f * even / (1 - 0.2f)).epsilon(0.02));
    CHECK(luminance(bright.radiance[77]) == doctest::Approx(0.1f * odd / (1 - 0.1f)).epsilon(0.02));
    CHECK(luminance(bright.radiance[400]) == doctest::Approx(0.1f * odd / (1 - 0.1f)).epsilon(0.02));
    CHECK(rest.g > irradiance(calm).g * 0.99f);
}

TEST_CASE("excess: what a grid keeps and what aimed rays find above its limits add up to all light on average") {
    // A cell is bright by chance, ten of 800 on average. Ideal aimed rays find the light above the limit of each cell without noise.
    // When the limit rose with the light that it limited, the sum was 2.7 % too large, by the covariance of both.
    constexpr float chance = 10.0f / 800, bright = 100;
    constexpr int grids = 4000;
    HemisphereSamples s = gather(16, 0, 0);
    REQUIRE(s.radiance.size() == 800);
    Rng rng(1, 2);
    double sum = 0;
    for (int grid = 0; grid < grids; ++grid) {
        for (Color& L : s.radiance) L = Color(rng.next() < chance ? bright : 1);
        const ExcessLimits limits = excess_limits(s);
        for (size_t cell = 0; cell < s.radiance.size(); ++cell)
            sum += chance * beyond(Color(bright), limits.at(s, cell)).g * pi / 800 / grids;
        take_excess(s);
        sum += irradiance(s).g / grids;
    }
    const double whole = pi * (chance * bright + (1 - chance));
    // Each grid keeps about ten cells of a tenth of the mean, ± √10 of them, a seventh of the sum: 0.2 % over all grids.
    CHECK(sum == doctest::Approx(whole).epsilon(0.01).scale(0));
}

TEST_CASE("excess: a direction finds its cell") {
    const HemisphereSamples s = gather(16, 0, 0);
    Rng rng(3, 4);
    for (int j = 0; j < s.rows; ++j)
        for (int k = 0; k < s.columns; ++k) {
            const Vec2 inside{0.01f + 0.98f * rng.next(), 0.01f + 0.98f * rng.next()};
            CHECK(cell_at(s, cell_direction(s.rows, s.columns, j, k, inside)) ==
                  size_t(j) * size_t(s.columns) + size_t(k));
        }
}

TEST_CASE("excess in rows of different height: the removed irradiance is the missing irradiance") {
    HemisphereSamples bright = gather(16, 0.3f, 0.2f);
    bright.kind = Rows::balanced;
    for (const size_t cell : {size_t(5), size_t(400)}) bright.radiance[cell] = Color(900, 1000, 1100);
    const Color whole = irradiance(bright), taken = take_excess(bright), rest = irradiance(bright);
    CHECK(taken.g > 0.5f * whole.g);
    for (int c = 0; c < 3; ++c) CHECK(rest[c] + taken[c] == doctest::Approx(whole[c]).epsilon(1e-5));
}

TEST_CASE("noise: none in even light; of n cells with unrelated values their deviation over the root of n") {
    HemisphereSamples s = gather(32, 0, 0);
    for (Color& L : s.radiance) L = Color(2);
    CHECK(relative_noise(s) == doctest::Approx(0).epsilon(1e-6));
    Rng rng(1, 2);
    for (Color& L : s.radiance) L = Color(2 + (rng.next() - 0.5f));
    const double deviation = std::sqrt(1.0 / 12) / 2;
    CHECK(relative_noise(s) ==
          doctest::Approx(deviation / std::sqrt(double(s.radiance.size()))).epsilon(0.05).scale(0));
}

TEST_CASE("distances: a miss is infinitely far, and only what stands apart counts for the minimum") {
    HemisphereSamples s = gather(16, 0, 0);
    s.apart.assign(s.distance.size(), 1);
    for (float& r : s.distance) r = 2;
    CHECK(harmonic_mean_distance(s) == doctest::Approx(2));
    for (int k = 0; k < s.columns; ++k) {
        s.distance[size_t(s.rows - 1) * s.columns + k] = 1e-3f;
        s.apart[size_t(s.rows - 1) * s.columns + k] = 0;
    }
    CHECK(minimum_distance(s) == doctest::Approx(2));
    s.apart.back() = 1;
    CHECK(minimum_distance(s) == doctest::Approx(1e-3f));
    for (float& r : s.distance) r = infinity;
    CHECK(harmonic_mean_distance(s) == infinity);
}

TEST_CASE("the reach of a point is that of the farther half of its hits and depends little on corners and windows") {
    HemisphereSamples s = gather(16, 0, 0);
    for (float& r : s.distance) r = 2;
    CHECK(reach(s) == doctest::Approx(2));
    // A wall close by in almost half of all directions.
    const size_t count = s.distance.size();
    for (size_t i = 0; i < count * 4 / 9; ++i) s.distance[i] = 1e-3f;
    CHECK(reach(s) == doctest::Approx(2));
    CHECK(farthest_distance(s) == 2);
    // A tenth of the farther half sees something a thousand times as far away: the mean would be a hundred times as large.
    for (size_t i = 0; i < count / 20; ++i) s.distance[count - 1 - i] = 2000;
    CHECK(reach(s) == doctest::Approx(2 / 0.9).epsilon(0.01));
    CHECK(farthest_distance(s) == 2000);
    // What is not met does not count.
    for (size_t i = 0; i < count / 20; ++i) s.distance[count - 1 - i] = infinity;
    CHECK(reach(s) == doctest::Approx(2));
    for (float& r : s.distance) r = infinity;
    CHECK(reach(s) == infinity);
    CHECK(farthest_distance(s) == 0);
}

TEST_CASE("a curved surface is not its own obstacle, but walls and lips are") {
    const Vec3 up{0, 0, 1};
    for (float elevation : {0.005f, 0.02f, 0.1f, 0.2f, 0.25f}) {
        const Vec3 w{std::cos(elevation), 0, std::sin(elevation)};
        // Inside of a circle: a chord of elevation e ends where the normal has turned by 2e.
        CHECK(!stands_apart(up, w, {-std::sin(2 * elevation), 0, std::cos(2 * elevation)}));
        CHECK(stands_apart(up, w, {-1, 0, 0}));  // a wall, however far
        CHECK(stands_apart(up, w, -up));         // the back of a panel
        CHECK(!stands_apart(up, w, up));         // a shallow step
    }
    CHECK(stands_apart(up, {std::cos(0.5f), 0, std::sin(0.5f)}, up));
}

TEST_CASE("the clearance of sectors towards a wall is the horizontal distance of the wall") {
    HemisphereSamples s;
    s.rows = 32;
    s.columns = 720;
    // The grid is turned against the frame that sectors belong to.
    const Frame frame = Frame::around({0, 0, 1});
    s.frame = Frame::along({0, 0, 1}, frame.u * std::cos(1.1f) + frame.v * std::sin(1.1f));
    // The plane u = 0.7 above an elevation of 27°, where a ray is at least a tenth longer than its horizontal part; below
    // it the surface itself, and overhead a lamp: both nearer, and neither in the way.
    const float wall = 0.7f;
    for (int j = 0; j < s.rows; ++j)
        for (int k = 0; k < s.columns; ++k) {
            const Vec3 w = s.frame.to_world(cell_direction(s.rows, s.columns, j, k, {0.5f, 0.5f}));
            const bool below = w.z < 0.45f, overhead = w.z > 0.72f;
            s.distance.push_back(below || overhead ? 0.1f : w.x > 0 ? wall / w.x : infinity);
            s.apart.push_back(overhead || (!below && w.x > 0));
        }
    const auto clearance = sector_clearance(s);
    for (int sector = 0; sector < 12; ++sector) {
        // A sector's least distance is at its azimuth nearest to the wall's normal.
        float nearest = infinity;
        for (int step = 0; step <= 100; ++step) {
            const float phi = -pi + 2 * pi * (static_cast<float>(sector) + static_cast<float>(step) / 100) / 12;
            if (std::cos(phi) > 0.05f) nearest = std::min(nearest, wall / std::cos(phi));
        }
        const Vec3 middle{std::cos(-pi + 2 * pi * (static_cast<float>(sector) + 0.5f) / 12),
                          std::sin(-pi + 2 * pi * (static_cast<float>(sector) + 0.5f) / 12), 0};
        const float found = clearance[clearance_sector(frame, middle)];
        CHECK(clearance_sector(frame, middle) == sector);
        if (nearest == infinity)
            CHECK(found == infinity);
        else
            CHECK(found == doctest::Approx(nearest).epsilon(0.03));
    }
}

TEST_CASE("gradients stay finite if an object touches the point") {
    HemisphereSamples s = gather(8, 0.3f, 0.2f);
    s.distance[100] = 1e-30f;
    keep_off(s, 0.25f);
    CHECK(s.distance[100] == 0.25f);
    CHECK(*std::min_element(s.distance.begin(), s.distance.end()) == 0.25f);
    CHECK(std::isfinite(length(translation_gradient(s).channel[0])));
}
