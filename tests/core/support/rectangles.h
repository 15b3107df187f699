// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Form factors of rectangles in closed form [Howell10].

#pragma once

#include <cmath>

/// Between equal rectangles of a × b that face each other at distance c.
inline double parallel_rectangles(double a, double b, double c) {
    const double x = a / c, y = b / c, p = 1 + x * x, q = 1 + y * y;
    return 2 / (M_PI * x * y) *
           (0.5 * std::log(p * q / (p + y * y)) + x * std::sqrt(q) * std::atan(x / std::sqrt(q)) +
            y * std::sqrt(p) * std::atan(y / std::sqrt(p)) - x * std::atan(x) - y * std::atan(y));
}

/// From the rectangle of width w to one of height h at a right angle, which share an edge of length l.
inline double perpendicular_rectangles(double width, double height, double l) {
    const double w = width / l, h = height / l, w2 = w * w, h2 = h * h, s = std::sqrt(w2 + h2);
    return 1 / (M_PI * w) *
           (w * std::atan(1 / w) + h * std::atan(1 / h) - s * std::atan(1 / s) +
            0.25 * (std::log((1 + w2) * (1 + h2) / (1 + w2 + h2)) +
                    w2 * std::log(w2 * (1 + w2 + h2) / ((1 + w2) * (w2 + h2))) +
                    h2 * std::log(h2 * (1 + h2 + w2) / ((1 + h2) * (h2 + w2)))));
}
