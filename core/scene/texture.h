// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Images on surfaces, and material parameters that read them. (0, 0) is the top-left corner, v grows downwards.

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/color.h"

namespace eclat {

enum class Wrap : uint8_t { repeat, mirror, clamp };

/// A caller's image, (height, width, channels) in C order: either bytes (0..255 mean 0..1) or floats.
struct ImageView {
    uint32_t width = 0, height = 0, channels = 0;
    const uint8_t* bytes = nullptr;
    const float* floats = nullptr;
};

struct TextureOptions {
    bool srgb = false;  // decode the colour channels; alpha (the second of two, the fourth of four) is linear always
    Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
    bool nearest = false;
};

/// Up to four channels; what the image lacks reads as grey (colour) or 1 (alpha).
using Texel = std::array<float, 4>;

/// An owned image. Bytes stay bytes, padded to one, two or four channels, and are decoded by table at each lookup;
/// floats stay floats (bump maps and radiance need the precision), decoded once.
class Texture {
  public:
    /// Throws std::invalid_argument for an empty image, channels outside 1..4, or texels that are not finite.
    Texture(const ImageView& image, const TextureOptions& options);

    /// The filtered texel at any `uv`; one that is not finite reads as (0, 0).
    Texel lookup(Vec2 uv) const;
    /// The same of one of the image's own channels; < 0: the luminance of RGB.
    float lookup(Vec2 uv, int channel) const;
    /// Column `x` of row `y`, unfiltered.
    Texel texel(uint32_t x, uint32_t y) const;

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    uint32_t channels() const { return channels_; }
    const TextureOptions& options() const { return options_; }

  private:
    const float* color_table() const;
    Texel texel_at(size_t index) const;
    /// Filters what `read` finds at the index of a stored texel.
    template <class Read>
    auto filter(Vec2 uv, const Read& read) const;

    uint32_t width_, height_, channels_;
    uint32_t stride_;  // stored channels of a texel
    TextureOptions options_;
    std::vector<uint8_t> bytes_;
    std::vector<float> floats_;
};

/// A parameter of a material: a constant, times a texel where there is a texture.
///
/// The texture is borrowed and must outlive the value. `channel` counts the image's own channels; < 0 reads RGB, of
/// which a scalar takes the luminance.
struct Value {
    Color constant{1.0f};
    const Texture* texture = nullptr;
    int channel = -1;
    uint8_t uv_set = 0;
    bool invert = false;                                     // 1 − texel instead of texel
    bool square = false;                                     // constant² · texel²
    std::array<float, 6> uv_transform = {1, 0, 0, 0, 1, 0};  // 2×3, row by row

    bool is_constant() const { return texture == nullptr; }

    /// `uv` is of the set that `uv_set` names.
    Color color(Vec2 uv) const { return texture ? finish(texture->lookup(transform(uv))) : finish(constant); }
    Color color(Vec2 uv, Vec2 uv2) const { return color(uv_set == 0 ? uv : uv2); }
    float scalar(Vec2 uv) const { return scalar_at(transform(uv)); }
    float scalar(Vec2 uv, Vec2 uv2) const { return scalar(uv_set == 0 ? uv : uv2); }

    /// The scalar where the texture is read at `at`: after the transform.
    float scalar_at(Vec2 at) const;
    /// Where the texture is read for a surface's `uv`.
    Vec2 transform(Vec2 uv) const {
        const auto& m = uv_transform;
        return {m[0] * uv.x + m[1] * uv.y + m[2], m[3] * uv.x + m[4] * uv.y + m[5]};
    }
    /// The parameter's colour where the texture reads `t`.
    Color finish(const Texel& t) const {
        Color c = channel < 0 ? Color(t[0], t[1], t[2]) : Color(t[texel_channel()]);
        if (invert) c = Color(1.0f) - c;
        return finish(constant * c);
    }

  private:
    Color finish(Color c) const { return square ? c * c : c; }
    /// The second channel of two is alpha, which a texel keeps in its fourth place.
    int texel_channel() const { return channel == 1 && texture->channels() == 2 ? 3 : channel & 3; }
};

}  // namespace eclat
