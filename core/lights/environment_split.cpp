// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "lights/environment_split.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/color.h"

namespace eclat {

namespace {

/// The tolerated noise relative to the irradiance, for one gather of the usual number of rays (14 rows, π · 14² rays).
/// It is the usual `max_error` of records.
constexpr double tolerated_noise = 0.02;
constexpr double gather_rays = M_PI * 14 * 14;
constexpr double cell_solid_angle = 2 * M_PI / gather_rays;

/// A texel: its luminance, its solid angle, and the block of the sky in which it lies.
struct Texel {
    float luminance;
    float solid_angle;
    uint32_t block;
};

struct Sky {
    std::vector<Texel> texels;
    uint32_t blocks = 0;
};

/// Blocks are about square and as large as a cell of a gather; each larger texel is a block.
Sky sky_in_blocks(std::span<const float> rgb, uint32_t width, uint32_t height) {
    const double side = std::sqrt(cell_solid_angle);
    const auto bands = static_cast<uint32_t>(std::clamp(std::round(M_PI / side), 1.0, double(height)));
    std::vector<uint32_t> first(bands + 1, 0), count(bands);
    for (uint32_t band = 0; band < bands; ++band) {
        const double sine = std::sin(M_PI * (band + 0.5) / bands);
        count[band] = static_cast<uint32_t>(std::clamp(std::round(2 * M_PI * sine / side), 1.0, double(width)));
        first[band + 1] = first[band] + count[band];
    }
    Sky sky{{}, first[bands]};
    sky.texels.reserve(size_t(width) * height);
    for (uint32_t y = 0; y < height; ++y) {
        const double rim = std::cos(M_PI * y / height) - std::cos(M_PI * (y + 1) / height);
        const auto solid_angle = static_cast<float>(2 * M_PI / width * rim);
        const auto band = static_cast<uint32_t>(uint64_t(y) * bands / height);
        for (uint32_t x = 0; x < width; ++x) {
            const float* p = rgb.data() + (size_t(y) * width + x) * 3;
            const auto column = static_cast<uint32_t>(uint64_t(x) * count[band] / width);
            sky.texels.push_back({luminance(Color(p[0], p[1], p[2])), solid_angle, first[band] + column});
        }
    }
    return sky;
}

/// Returns the relative noise of a gather of the image clamped at `limit`; it is infinite if nothing is left of the
/// image.
double relative_noise(const Sky& sky, double limit) {
    struct Moments {
        double solid_angle = 0, first = 0, second = 0;
    };
    std::vector<Moments> of_block(sky.blocks);
    for (const Texel& t : sky.texels) {
        const double L = std::min<double>(t.luminance, limit);
        Moments& m = of_block[t.block];
        m.solid_angle += t.solid_angle;
        m.first += t.solid_angle * L;
        m.second += t.solid_angle * L * L;
    }
    double spread = 0, all = 0;
    for (const Moments& m : of_block) {
        if (m.solid_angle > 0) spread += std::max(0.0, m.second - m.first * m.first / m.solid_angle);
        all += m.first;
    }
    return all > 0 ? std::sqrt(cell_solid_angle / 6 * spread) / (all / 4) : INFINITY;
}

}  // namespace

float smooth_limit(std::span<const float> rgb, uint32_t width, uint32_t height) {
    const Sky sky = sky_in_blocks(rgb, width, height);
    double high = 0;
    for (const Texel& t : sky.texels) high = std::max<double>(high, t.luminance);
    if (high == 0 || relative_noise(sky, high) <= tolerated_noise) return INFINITY;
    // The noise grows with the limit, from that of an image that is even where it is not black.
    double low = high * 1e-12;
    if (relative_noise(sky, low) > tolerated_noise) return 0;
    constexpr int halvings = 16;  // of a range of 10¹²: to 0.04 % of the limit
    for (int i = 0; i < halvings; ++i) {
        const double middle = std::sqrt(low * high);
        (relative_noise(sky, middle) <= tolerated_noise ? low : high) = middle;
    }
    return static_cast<float>(low);
}

}  // namespace eclat
