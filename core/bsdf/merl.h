// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Isotropic materials of the MERL database, tabulated over the half vector and the difference vector.
//
// References   [Matusik03] the data, [Rusinkiewicz98] the coordinates
//
// Symbol       name here   meaning
//   θ_h, θ_d   –           angle of the half vector from the normal, and of wi from the half vector
//   φ_d        –           azimuth of wi around the half vector; φ_d + π is the same by reciprocity
//
// Departures   Values are interpolated in the three angles between the middles of the cells. Directions are sampled from the
//              half vectors' distribution in θ_h, mixed with a cosine lobe.

#pragma once

#include <span>
#include <vector>

#include "bsdf/measured.h"
#include "sampling/discrete.h"

namespace eclat {

class MerlBrdf : public MeasuredBrdf {
  public:
    static constexpr size_t half_angles = 90, difference_angles = 90, difference_azimuths = 180;
    static constexpr size_t cells = half_angles * difference_angles * difference_azimuths;

    /// `values` (3, 90, 90, 180): reflectance in sr^-1 by channel, θ_h, θ_d and φ_d. θ_h of cell i is (i / 90)² · 90°.
    explicit MerlBrdf(std::span<const float> values);

    EvalPdf eval(Vec3 wo, Vec3 wi) const override;
    Vec3 direction(Vec3 wo, Vec2 u) const override;
    bool isotropic() const override { return true; }

  private:
    Color value(Vec3 wi, Vec3 half) const;
    float pdf_of_half(float cosine) const;

    std::vector<Color> values_;
    PiecewiseConstant1D half_;  // over the cells of θ_h
    float cosine_share_ = 0.5f;
};

}  // namespace eclat
