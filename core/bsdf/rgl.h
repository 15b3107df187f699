// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Materials measured with an adaptive parameterisation.
//
// References   [DupuyJakob18] the format, the mapping and its use for sampling
//
// Symbol       name here    meaning
//   ω_o          wo           the direction of the viewer, for which the tables are stored
//   ω_m          half         the half vector
//   D, σ         normals, projected   the distribution of microfacet normals and its projected area
//   D_ω          visible      the distribution of the normals that are visible from wo, a warp of the square
//   L            luminance    the distribution of what is left after that warp, another warp
//   S            channels     f · cos θ_i · 4 σ / D by channel, at the point that the inverse of D_ω gives
//
// Angles lie on the square as u = √(2 θ / π) and v = (φ + π) / 2π. Tables of an anisotropic material may end at half or at a
// quarter of the circle, from φ_o = −π on: a half turn of both directions, or mirroring both, then gives the rest.
//
// Departures   None. The values are not exactly reciprocal, because viewer and light were measured on different grids.

#pragma once

#include <span>
#include <vector>

#include "bsdf/measured.h"
#include "sampling/bilinear_warp.h"

namespace eclat {

/// An array of a file of the RGL database, by rows.
struct RglTable {
    size_t width = 0, height = 0;
    std::span<const float> values{};
};

struct RglData {
    ParameterNodes nodes;  // φ_o and θ_o in radians; at most two of φ_o mean an isotropic material
    bool jacobian = true;  // whether the channels are divided by D / 4 σ
    RglTable normals, projected, visible, luminance;
    std::array<RglTable, 3> channels;
};

class RglBrdf : public MeasuredBrdf {
  public:
    explicit RglBrdf(RglData data);

    EvalPdf eval(Vec3 wo, Vec3 wi) const override;
    Vec3 direction(Vec3 wo, Vec2 u) const override;
    bool isotropic() const override { return isotropic_; }

  private:
    /// What depends on the viewer only.
    struct View {
        float phi;
        Vec2 place;  // of wo on the square
        Slices slices;
    };
    View view_of(Vec3 wo) const;
    /// Signs of x and y that bring `wo` to the part of the circle that the tables hold.
    Vec2 signs(Vec3 wo) const;

    bool isotropic_, jacobian_;
    int symmetries_ = 1;  // the tables hold one of so many parts of the circle
    ParameterNodes nodes_;
    BilinearTable normals_, projected_;
    BilinearWarp visible_, luminance_;
    std::array<BilinearTable, 3> channels_;
};

}  // namespace eclat
