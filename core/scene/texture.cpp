// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "scene/texture.h"

#include <algorithm>
#include <string>

#include "base/error.h"

namespace eclat {

namespace {

/// sRGB's transfer function, encoded to linear [IEC61966].
double srgb_to_linear(double x) { return x <= 0.04045 ? x / 12.92 : std::pow((x + 0.055) / 1.055, 2.4); }

using Table = std::array<float, 256>;

Table make_table(bool srgb) {
    Table table;
    for (int i = 0; i < 256; ++i) {
        const double x = i / 255.0;
        table[i] = static_cast<float>(srgb ? srgb_to_linear(x) : x);
    }
    return table;
}

const Table linear_table = make_table(false);
const Table srgb_table = make_table(true);

/// The order of stored texels: tiles of 8 × 8, and inside of them squares of 4 × 4 and of 2 × 2, each row by row. The four texels
/// of a lookup then mostly lie in one line of the cache; in rows, they lie in two.
class Tiling {
  public:
    Tiling(uint32_t width, uint32_t height) : across_((width + side - 1) / side), down_((height + side - 1) / side) {}

    /// The number of texels with those that fill the tiles at the edges.
    size_t size() const { return size_t(across_) * down_ * side * side; }
    /// The place of the texel in column `x` of row `y`.
    size_t operator()(uint32_t x, uint32_t y) const {
        return (size_t(y / side) * across_ + x / side) * (side * side) + (apart[x % side] | apart[y % side] << 1);
    }

  private:
    static constexpr uint32_t side = 8;
    static constexpr uint32_t apart[side] = {0,  1,  4,  5,
                                             16, 17, 20, 21};  // the bits of a number, at every second place

    uint32_t across_, down_;
};

bool is_alpha(uint32_t channel, uint32_t channels) { return channel == 3 || (channels == 2 && channel == 1); }

/// Folds a coordinate into [0, 1], where the image is.
float fold(float x, Wrap wrap) {
    if (wrap == Wrap::clamp) return clamp(x, 0, 1);
    if (wrap == Wrap::repeat) return x - std::floor(x);
    const float period = x - 2 * std::floor(x * 0.5f);
    return period > 1 ? 2 - period : period;
}

/// The two neighbours of a coordinate along one axis, and how far it is from the first to the second.
struct Neighbors {
    uint32_t first, second;
    float t;
};

Neighbors neighbors(float x, uint32_t size, Wrap wrap) {
    const float at = fold(x, wrap) * static_cast<float>(size) - 0.5f;
    const float floor = std::floor(at);
    const int i = static_cast<int>(floor), n = static_cast<int>(size);
    // Beyond an edge is the other edge, or, mirrored and clamped alike, the edge itself.
    const bool around = wrap == Wrap::repeat;
    const int first = i < 0 ? (around ? n - 1 : 0) : std::min(i, n - 1);
    const int second = i + 1 < n ? i + 1 : (around ? 0 : n - 1);
    return {static_cast<uint32_t>(first), static_cast<uint32_t>(second), at - floor};
}

uint32_t nearest(float x, uint32_t size, Wrap wrap) {
    return std::min(static_cast<uint32_t>(fold(x, wrap) * static_cast<float>(size)), size - 1);
}

float blend(float a, float b, float t) { return a * (1 - t) + b * t; }
Texel blend(const Texel& a, const Texel& b, float t) {
    Texel out;
    for (int i = 0; i < 4; ++i) out[i] = blend(a[i], b[i], t);
    return out;
}

}  // namespace

Texture::Texture(const ImageView& image, const TextureOptions& options)
    : width_(image.width), height_(image.height), channels_(image.channels), options_(options) {
    const std::string shape =
        std::to_string(height_) + " x " + std::to_string(width_) + " x " + std::to_string(channels_);
    require(width_ > 0 && height_ > 0 && channels_ >= 1 && channels_ <= 4,
            "texture: expected height, width >= 1 and 1 to 4 channels, got " + shape);
    // Texel coordinates must be exact in float.
    require(width_ <= 1u << 22 && height_ <= 1u << 22, "texture: expected at most 4194304 texels a side, got " + shape);
    require((image.bytes != nullptr) != (image.floats != nullptr), "texture: expected either bytes or floats");
    stride_ = image.bytes && channels_ == 3 ? 4 : channels_;
    const Tiling tiling(width_, height_);
    if (image.bytes) {
        bytes_.resize(tiling.size() * stride_);
        for (uint32_t y = 0; y < height_; ++y)
            for (uint32_t x = 0; x < width_; ++x) {
                const uint8_t* from = image.bytes + (size_t(y) * width_ + x) * channels_;
                uint8_t* to = bytes_.data() + tiling(x, y) * stride_;
                for (uint32_t c = 0; c < stride_; ++c) to[c] = c < channels_ ? from[c] : 255;
            }
        return;
    }
    floats_.resize(tiling.size() * stride_);
    for (uint32_t y = 0; y < height_; ++y)
        for (uint32_t x = 0; x < width_; ++x)
            for (uint32_t c = 0; c < channels_; ++c) {
                const float value = image.floats[(size_t(y) * width_ + x) * channels_ + c];
                if (!std::isfinite(value))
                    require(false, "texture: texels must be finite, got " + std::to_string(value) + " at row " +
                                       std::to_string(y) + ", column " + std::to_string(x));
                const bool decode = options_.srgb && !is_alpha(c, channels_);
                floats_[tiling(x, y) * stride_ + c] = decode ? static_cast<float>(srgb_to_linear(value)) : value;
            }
}

const float* Texture::color_table() const { return (options_.srgb ? srgb_table : linear_table).data(); }

Texel Texture::texel(uint32_t x, uint32_t y) const { return texel_at(Tiling(width_, height_)(x, y) * stride_); }

Texel Texture::texel_at(size_t at) const {
    if (!bytes_.empty()) {
        const uint8_t* p = bytes_.data() + at;
        const float* table = color_table();
        if (stride_ == 4) return {table[p[0]], table[p[1]], table[p[2]], linear_table[p[3]]};
        const float grey = table[p[0]];
        return {grey, grey, grey, stride_ == 2 ? linear_table[p[1]] : 1};
    }
    const float* p = floats_.data() + at;
    if (stride_ >= 3) return {p[0], p[1], p[2], stride_ == 4 ? p[3] : 1};
    return {p[0], p[0], p[0], stride_ == 2 ? p[1] : 1};
}

template <class Read>
auto Texture::filter(Vec2 uv, const Read& read) const {
    if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) uv = {0, 0};
    const Tiling tiling(width_, height_);
    const auto at = [&](uint32_t x, uint32_t y) { return read(tiling(x, y) * stride_); };
    if (options_.nearest) return at(nearest(uv.x, width_, options_.wrap_u), nearest(uv.y, height_, options_.wrap_v));
    const Neighbors x = neighbors(uv.x, width_, options_.wrap_u);
    const Neighbors y = neighbors(uv.y, height_, options_.wrap_v);
    return blend(blend(at(x.first, y.first), at(x.second, y.first), x.t),
                 blend(at(x.first, y.second), at(x.second, y.second), x.t), y.t);
}

Texel Texture::lookup(Vec2 uv) const {
    if (!bytes_.empty() && stride_ == 4) {
        const float* table = color_table();
        const uint8_t* bytes = bytes_.data();
        return filter(uv, [=](size_t i) {
            return Texel{table[bytes[i]], table[bytes[i + 1]], table[bytes[i + 2]], linear_table[bytes[i + 3]]};
        });
    }
    return filter(uv, [this](size_t i) { return texel_at(i); });
}

float Texture::lookup(Vec2 uv, int channel) const {
    if (channel < 0 && channels_ <= 2) channel = 0;  // grey
    if (channel < 0) {
        const Texel t = lookup(uv);
        return eclat::luminance(Color(t[0], t[1], t[2]));
    }
    const auto own = static_cast<uint32_t>(channel);
    if (own >= channels_) return lookup(uv)[own & 3];
    if (bytes_.empty()) return filter(uv, [floats = floats_.data() + own](size_t i) { return floats[i]; });
    const float* table = is_alpha(own, channels_) ? linear_table.data() : color_table();
    return filter(uv, [=, bytes = bytes_.data() + own](size_t i) { return table[bytes[i]]; });
}

float Value::scalar_at(Vec2 at) const {
    float x = constant.r;
    if (texture) {
        const float y = texture->lookup(at, channel);
        x *= invert ? 1 - y : y;
    }
    return square ? x * x : x;
}

}  // namespace eclat
