// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Textures: decoding, filtering, wrapping, and the values that read them.

#include <doctest/doctest.h>

#include <initializer_list>
#include <limits>
#include <stdexcept>

#include "sampling/rng.h"
#include "scene/texture.h"

using namespace eclat;

namespace {

Texture from_bytes(uint32_t width, uint32_t height, uint32_t channels, const std::vector<uint8_t>& texels,
                   TextureOptions options = {}) {
    return Texture(ImageView{width, height, channels, texels.data(), nullptr}, options);
}

Texture from_floats(uint32_t width, uint32_t height, uint32_t channels, const std::vector<float>& texels,
                    TextureOptions options = {}) {
    return Texture(ImageView{width, height, channels, nullptr, texels.data()}, options);
}

/// One row 0, 1, 2, 3.
Texture ramp(Wrap wrap, bool nearest = false) {
    return from_floats(4, 1, 1, {0, 1, 2, 3}, {.wrap_u = wrap, .wrap_v = wrap, .nearest = nearest});
}

float at(const Texture& texture, float u, float v = 0.5f) { return texture.lookup({u, v})[0]; }

/// By the standard's formula, in double.
double decode(double x) { return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4); }

}  // namespace

TEST_CASE("bytes and floats decode alike, colour by sRGB, alpha never") {
    for (int i = 0; i < 256; i += 5) {
        const uint8_t b = static_cast<uint8_t>(i);
        const float f = static_cast<float>(i) / 255;
        const Texel bytes = from_bytes(1, 1, 4, {b, b, 7, b}, {.srgb = true}).lookup({0.3f, 0.9f});
        const Texel floats = from_floats(1, 1, 4, {f, f, 7 / 255.0f, f}, {.srgb = true}).lookup({0.3f, 0.9f});
        for (int c = 0; c < 4; ++c) CHECK(bytes[c] == doctest::Approx(floats[c]).epsilon(1e-6));
        CHECK(bytes[0] == doctest::Approx(decode(i / 255.0)).epsilon(1e-6));
        CHECK(bytes[3] == doctest::Approx(i / 255.0).epsilon(1e-6));
        CHECK(from_bytes(1, 1, 1, {b}).lookup({0, 0})[0] == doctest::Approx(i / 255.0).epsilon(1e-6));
    }
}

TEST_CASE("missing channels read as grey and opaque; the second of two channels is alpha") {
    const auto check = [](const Texel& t, std::initializer_list<float> expected) {
        int i = 0;
        for (const float e : expected) CHECK(t[i++] == doctest::Approx(e).epsilon(1e-6));
    };
    const float half = 128 / 255.0f, decoded = static_cast<float>(decode(half));
    check(from_bytes(1, 1, 1, {128}).lookup({0, 0}), {half, half, half, 1});
    check(from_bytes(1, 1, 2, {128, 51}, {.srgb = true}).lookup({0, 0}), {decoded, decoded, decoded, 0.2f});
    check(from_bytes(1, 1, 3, {255, 0, 51}).lookup({0, 0}), {1, 0, 0.2f, 1});
    check(from_floats(1, 1, 2, {0.5f, 0.25f}).lookup({0, 0}), {0.5f, 0.5f, 0.5f, 0.25f});
    check(from_floats(1, 1, 3, {5, -1, 2}).lookup({0, 0}), {5, -1, 2, 1});
}

TEST_CASE("bilinear lookup interpolates between texel centres; row 0 is v = 0") {
    const Texture t = from_floats(2, 2, 1, {0, 1, 2, 4}, {.wrap_u = Wrap::clamp, .wrap_v = Wrap::clamp});
    CHECK(at(t, 0.25f, 0.25f) == 0);
    CHECK(at(t, 0.75f, 0.25f) == 1);
    CHECK(at(t, 0.25f, 0.75f) == 2);
    CHECK(at(t, 0.5f, 0.5f) == doctest::Approx(1.75));
    CHECK(at(t, 0.5f, 0) == doctest::Approx(0.5));
    CHECK(at(t, 1, 1) == 4);
}

TEST_CASE("wrapping: repeat joins the edges, mirror turns back, clamp holds") {
    const Texture repeat = ramp(Wrap::repeat), mirror = ramp(Wrap::mirror), hold = ramp(Wrap::clamp);
    CHECK(at(repeat, 0) == doctest::Approx(1.5));
    CHECK(at(repeat, 1) == doctest::Approx(1.5));
    CHECK(at(mirror, 0) == 0);
    CHECK(at(mirror, 1) == 3);
    CHECK(at(hold, -5) == 0);
    CHECK(at(hold, 5) == 3);
    for (float u = 0.01f; u < 1; u += 0.07f) {
        for (const float turns : {-6.0f, -1.0f, 1.0f, 4.0f}) {
            CHECK(at(repeat, u + turns) == doctest::Approx(at(repeat, u)).epsilon(1e-4));
            CHECK(at(mirror, u + 2 * turns) == doctest::Approx(at(mirror, u)).epsilon(1e-4));
        }
        CHECK(at(mirror, -u) == doctest::Approx(at(mirror, u)).epsilon(1e-4));
        CHECK(at(mirror, 2 - u) == doctest::Approx(at(mirror, u)).epsilon(1e-4));
    }
}

TEST_CASE("nearest lookup takes the texel whose square contains the point") {
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirror, Wrap::clamp}) {
        const Texture t = ramp(wrap, true);
        for (int i = 0; i < 4; ++i) {
            CHECK(at(t, (i + 0.01f) / 4) == i);
            CHECK(at(t, (i + 0.99f) / 4) == i);
        }
    }
    CHECK(at(ramp(Wrap::repeat, true), 1) == 0);
    CHECK(at(ramp(Wrap::mirror, true), 1.1f) == 3);
}

TEST_CASE("no coordinate, however large or invalid, reads outside the image") {
    const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
    const float denormal = std::numeric_limits<float>::denorm_min(), most = std::numeric_limits<float>::max();
    for (const bool nearest : {false, true}) {
        for (const Wrap wrap : {Wrap::repeat, Wrap::mirror, Wrap::clamp}) {
            const Texture t = ramp(wrap, nearest);
            for (const float u : {inf, -inf, nan, most, -most, 1e9f, -1e9f, 1e-20f, -1e-20f, denormal, -denormal, -0.0f,
                                  8388607.5f, -8388607.5f, 2147483648.0f, std::nextafter(1.0f, 0.0f)}) {
                CHECK(at(t, u, u) >= 0);
                CHECK(at(t, u, u) <= 3);
                CHECK(at(t, u) >= 0);
                CHECK(at(t, 0.1f, u) <= 3);
            }
            CHECK(at(t, nan, 0.5f) == at(t, 0, 0));
        }
    }
}

TEST_CASE("a value is its constant times the texel") {
    const Texture t = from_bytes(1, 1, 4, {51, 102, 153, 204});
    Value v{.constant = Color(1, 2, 3)};
    CHECK(v.color({0, 0}).b == 3);
    CHECK(v.scalar({0, 0}) == 1);
    CHECK(v.is_constant());
    v.texture = &t;
    CHECK_FALSE(v.is_constant());
    CHECK(v.color({0, 0}).g == doctest::Approx(0.8));
    CHECK(v.scalar({0, 0}) == doctest::Approx(0.2126 * 0.2 + 0.7152 * 0.4 + 0.0722 * 0.6));
    v.channel = 3;
    CHECK(v.color({0, 0}).g == doctest::Approx(1.6));
    CHECK(v.scalar({0, 0}) == doctest::Approx(0.8));
    v.invert = true;
    CHECK(v.color({0, 0}).b == doctest::Approx(0.6));
    CHECK(v.scalar({0, 0}) == doctest::Approx(0.2));
    v.square = true;
    CHECK(v.color({0, 0}).b == doctest::Approx(0.36));
    v.constant = Color(0.5f);
    CHECK(v.scalar({0, 0}) == doctest::Approx(0.01));
    // Without a texture there is nothing to invert; the constant is still squared.
    v.texture = nullptr;
    CHECK(v.color({0, 0}).r == doctest::Approx(0.25));
    CHECK(v.scalar({0, 0}) == doctest::Approx(0.25));
}

TEST_CASE("channel numbers refer to the channels of the image") {
    const Texture grey_alpha = from_bytes(1, 1, 2, {51, 102});
    Value v{.texture = &grey_alpha, .channel = 1};
    CHECK(v.scalar({0, 0}) == doctest::Approx(0.4));
    v.channel = 0;
    CHECK(v.scalar({0, 0}) == doctest::Approx(0.2));
    const Texture rgb = from_bytes(1, 1, 3, {51, 102, 153});
    v.texture = &rgb;
    v.channel = 1;
    CHECK(v.scalar({0, 0}) == doctest::Approx(0.4));
    v.channel = 3;
    CHECK(v.scalar({0, 0}) == 1);
}

TEST_CASE("the uv set is chosen, then transformed") {
    const Texture t = ramp(Wrap::clamp);
    Value v{.texture = &t, .uv_transform = {0, 1, 0.25f, 1, 0, 0}};
    CHECK(v.scalar({0.9f, 0.125f}) == doctest::Approx(at(t, 0.375f)));
    v.uv_set = 1;
    CHECK(v.scalar({0, 0}, {0, 0.5f}) == doctest::Approx(at(t, 0.75f)));
    CHECK(v.color({0, 0}, {0, 0.5f}).r == doctest::Approx(at(t, 0.75f)));
    v.uv_transform = {3e38f, 3e38f, 0, 0, 0, 0};
    CHECK(v.scalar({1, 1}, {1, 1}) == 0);
}

TEST_CASE("bad images are refused with what was expected and got") {
    const std::vector<float> one = {1, 1, 1, 1, 1};
    CHECK_THROWS_WITH_AS(from_floats(0, 3, 1, one),
                         "texture: expected height, width >= 1 and 1 to 4 channels, got 3 x 0 x 1",
                         std::invalid_argument);
    CHECK_THROWS_AS(from_floats(1, 1, 5, one), std::invalid_argument);
    CHECK_THROWS_AS(from_floats(1, 1, 0, one), std::invalid_argument);
    CHECK_THROWS_AS(Texture(ImageView{1, 1, 1, nullptr, nullptr}, {}), std::invalid_argument);
    CHECK_THROWS_WITH_AS(from_floats(2, 2, 1, {0, 0, 0, NAN}),
                         "texture: texels must be finite, got nan at row 1, column 1", std::invalid_argument);
}
