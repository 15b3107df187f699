// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Scene-linear RGB, Rec. 709 primaries: radiance, irradiance, albedo, throughput.

#pragma once

#include "base/vec.h"

namespace eclat {

struct Color {
    float r = 0, g = 0, b = 0;

    Color() = default;
    explicit Color(float grey) : r(grey), g(grey), b(grey) {}
    Color(float r, float g, float b) : r(r), g(g), b(b) {}

    float operator[](int i) const { return i == 0 ? r : i == 1 ? g : b; }
    float& operator[](int i) { return i == 0 ? r : i == 1 ? g : b; }
    Color& operator+=(Color o) { return *this = {r + o.r, g + o.g, b + o.b}; }
    Color& operator*=(Color o) { return *this = {r * o.r, g * o.g, b * o.b}; }
    Color& operator*=(float s) { return *this = {r * s, g * s, b * s}; }
};

inline Color operator+(Color a, Color b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }
inline Color operator-(Color a, Color b) { return {a.r - b.r, a.g - b.g, a.b - b.b}; }
inline Color operator*(Color a, Color b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }
inline Color operator/(Color a, Color b) { return {a.r / b.r, a.g / b.g, a.b / b.b}; }
inline Color operator*(Color a, float s) { return {a.r * s, a.g * s, a.b * s}; }
inline Color operator*(float s, Color a) { return a * s; }
inline Color operator/(Color a, float s) { return a * (1 / s); }

inline float max_component(Color a) { return std::max(a.r, std::max(a.g, a.b)); }
inline float mean(Color a) { return (a.r + a.g + a.b) * (1.0f / 3); }
inline bool is_black(Color a) { return a.r == 0 && a.g == 0 && a.b == 0; }
inline bool is_finite(Color a) { return std::isfinite(a.r) && std::isfinite(a.g) && std::isfinite(a.b); }
inline Color max(Color a, Color b) { return {std::max(a.r, b.r), std::max(a.g, b.g), std::max(a.b, b.b)}; }
inline Color min(Color a, Color b) { return {std::min(a.r, b.r), std::min(a.g, b.g), std::min(a.b, b.b)}; }

/// Returns the relative luminance Y for Rec. 709 primaries (ITU-R BT.709).
inline float luminance(Color a) { return 0.2126f * a.r + 0.7152f * a.g + 0.0722f * a.b; }

}  // namespace eclat
