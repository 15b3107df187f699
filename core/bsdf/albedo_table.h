// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Directional albedo of a GGX surface with Schlick's reflectance, as a table.
// Schlick's reflectance is linear in F0 and F90, so E(cosθ, α) = F0 · A(cosθ, α) + F90 · B(cosθ, α), and two numbers per entry
// serve all colours. Masking is height-correlated; only single scattering counts, so 1 − A − B is lost between facets.
//
// References   [Karis13] the split, [Schlick94], [Heitz14]

#pragma once

#include <array>

#include "base/color.h"
#include "base/vec.h"

namespace eclat {

/// Factors of F0 and F90.
struct SplitAlbedo {
    float f0 = 0, f90 = 0;

    /// The entry for a surface that reflects all light.
    Color white() const { return Color(f0 + f90); }
    float of(float reflectance_0, float reflectance_90) const { return f0 * reflectance_0 + f90 * reflectance_90; }
};

/// Interpolates bilinearly in sqrt(cosθ) and sqrt(α), both uniform in [0, 1], so that the table is finer where the
/// albedo is more curved.
class AlbedoTable {
  public:
    static constexpr int cos_count = 48, alpha_count = 24;

    AlbedoTable();

    SplitAlbedo at(float cos_theta, float alpha) const;
    /// 2 ∫ E(μ) μ dμ of the interpolated table.
    SplitAlbedo mean(float alpha) const;

  private:
    SplitAlbedo entry(int i, int j) const { return entries_[size_t(i * alpha_count + j)]; }

    std::array<SplitAlbedo, size_t(cos_count) * alpha_count> entries_;
    std::array<SplitAlbedo, alpha_count> means_;
};

namespace detail {

/// A position in a table of `count` entries over [0, 1].
struct TablePosition {
    int index;
    float fraction;
    TablePosition(float x, int count) {
        const float scaled = clamp(x, 0, 1) * float(count - 1);
        index = std::min(int(scaled), count - 2);
        fraction = scaled - float(index);
    }
};

inline SplitAlbedo lerp(SplitAlbedo a, SplitAlbedo b, float t) {
    return {eclat::lerp(a.f0, b.f0, t), eclat::lerp(a.f90, b.f90, t)};
}

}  // namespace detail

inline SplitAlbedo AlbedoTable::at(float cos_theta, float alpha) const {
    const detail::TablePosition c(std::sqrt(std::max(cos_theta, 0.0f)), cos_count), a(std::sqrt(alpha), alpha_count);
    return detail::lerp(detail::lerp(entry(c.index, a.index), entry(c.index, a.index + 1), a.fraction),
                        detail::lerp(entry(c.index + 1, a.index), entry(c.index + 1, a.index + 1), a.fraction),
                        c.fraction);
}

inline SplitAlbedo AlbedoTable::mean(float alpha) const {
    const detail::TablePosition a(std::sqrt(alpha), alpha_count);
    return detail::lerp(means_[size_t(a.index)], means_[size_t(a.index) + 1], a.fraction);
}

/// Filled before main() runs, by quadrature, in about 15 ms.
extern const AlbedoTable albedo_table;

inline SplitAlbedo split_albedo(float cos_theta, float alpha) { return albedo_table.at(cos_theta, alpha); }

}  // namespace eclat
