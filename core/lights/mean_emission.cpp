// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "lights/mean_emission.h"

#include "sampling/warp.h"

namespace eclat {

namespace {

constexpr uint32_t most_blocks = 1024;  // a side: 4 MB
constexpr uint32_t most_samples = 64, least_samples = 4;

Color shine(const Value& emission, const Texel& texel) { return max(emission.finish(texel), Color(0.0f)); }

}  // namespace

MeanEmission::MeanEmission(const Value& emission) : emission_(emission) {
    const uint32_t width = emission.texture->width(), height = emission.texture->height();
    block_ = (std::max(width, height) + most_blocks - 1) / most_blocks;
    columns_ = (width + block_ - 1) / block_;
    rows_ = (height + block_ - 1) / block_;
    counts_.resize(size_t(columns_ + 1) * (rows_ + 1), 0);
    double sum = 0;
    uint64_t lit = 0;
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            const float l = luminance(shine(emission, emission.texture->texel(x, y)));
            if (!(l > 0)) continue;
            sum += l;
            ++lit;
            counts_[size_t(y / block_ + 1) * (columns_ + 1) + x / block_ + 1] = 1;
        }
    }
    if (lit > 0) lit_mean_ = sum / static_cast<double>(lit);
    for (uint32_t y = 1; y <= rows_; ++y) {
        uint32_t* row = counts_.data() + size_t(y) * (columns_ + 1);
        const uint32_t* above = row - (columns_ + 1);
        uint32_t running = 0;
        for (uint32_t x = 1; x <= columns_; ++x) {
            running += row[x];
            row[x] = above[x] + running;
        }
    }
}

MeanEmission::Range MeanEmission::reach(float a, float b, float c, uint32_t size, Wrap wrap) const {
    const Range everything = {0, (size + block_ - 1) / block_};
    float low = std::min(a, std::min(b, c)), high = std::max(a, std::max(b, c));
    // If the rounding error of a coordinate exceeds a texel (floats have 23 bits), any texel may be read.
    const float n = static_cast<float>(size);
    if (!(std::abs(low) * n < 0x1p21f && std::abs(high) * n < 0x1p21f)) return everything;
    if (wrap == Wrap::clamp) {
        low = clamp(low, 0, 1);
        high = clamp(high, 0, 1);
    } else {
        const float period = std::floor(low);
        if (std::floor(high) != period) return everything;
        const bool flip = wrap == Wrap::mirror && std::fmod(period, 2.0f) != 0;
        const float from = low - period, to = high - period;
        low = flip ? 1 - to : from;
        high = flip ? 1 - from : to;
    }
    // One texel more on both sides for the bilinear lookup, one for rounding.
    const int first = static_cast<int>(low * n) - 2, last = static_cast<int>(high * n) + 2;
    if (wrap == Wrap::repeat && (first < 0 || last >= static_cast<int>(size))) return everything;
    return {static_cast<uint32_t>(std::max(first, 0)) / block_,
            std::min(static_cast<uint32_t>(last) / block_ + 1, everything.end)};
}

uint32_t MeanEmission::lit_blocks(Range x, Range y) const {
    const uint32_t* upper = counts_.data() + size_t(y.begin) * (columns_ + 1);
    const uint32_t* lower = counts_.data() + size_t(y.end) * (columns_ + 1);
    return lower[x.end] - lower[x.begin] - upper[x.end] + upper[x.begin];
}

MeanEmission::Estimate MeanEmission::over(Vec2 uv0, Vec2 uv1, Vec2 uv2) const {
    const Texture& texture = *emission_.texture;
    const Vec2 a = emission_.transform(uv0), b = emission_.transform(uv1), c = emission_.transform(uv2);
    const Range x = reach(a.x, b.x, c.x, texture.width(), texture.options().wrap_u);
    const Range y = reach(a.y, b.y, c.y, texture.height(), texture.options().wrap_v);
    const uint32_t lit = lit_blocks(x, y);
    if (lit == 0) return {};

    // Point samples: an additive recurrence with the plastic number's powers, evenly spread for any count.
    const uint32_t blocks = (x.end - x.begin) * (y.end - y.begin);
    const uint64_t wanted = uint64_t(blocks) * block_ * block_;
    const uint32_t samples = static_cast<uint32_t>(std::clamp<uint64_t>(wanted, least_samples, most_samples));
    std::array<double, 3> sum = {0, 0, 0};
    for (uint32_t i = 0; i < samples; ++i) {
        const double p = (i + 0.5) * 0.7548776662466927, q = (i + 0.5) * 0.5698402909980532;
        const Vec2 bary =
            square_to_triangle({static_cast<float>(p - std::floor(p)), static_cast<float>(q - std::floor(q))});
        const Vec2 uv = uv0 + bary.x * (uv1 - uv0) + bary.y * (uv2 - uv0);
        const Color radiance = max(emission_.color(uv), Color(0.0f));
        for (int k = 0; k < 3; ++k) sum[k] += radiance[k];
    }
    Estimate out;
    out.mean = Color(static_cast<float>(sum[0] / samples), static_cast<float>(sum[1] / samples),
                     static_cast<float>(sum[2] / samples));
    // A tenth of the weight is proportional to the share of lit blocks, so that emission that the points missed can
    // still be sampled.
    out.weight = 0.9 * luminance(out.mean) + 0.1 * lit_mean_ * lit / blocks;
    return out;
}

}  // namespace eclat
