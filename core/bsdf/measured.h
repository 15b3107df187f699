// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Reflection as it was measured: a lobe whose values come from a table.

#pragma once

#include <array>
#include <memory>

#include "base/frame.h"
#include "bsdf/bsdf_sample.h"

namespace eclat {

/// A table of a measured material, which many points share. It reflects on the side of the normal only, so both directions have
/// z > 0 where it is not 0.
class MeasuredBrdf {
  public:
    virtual ~MeasuredBrdf() = default;

    /// Value without the cosine, and the density of `direction`.
    virtual EvalPdf eval(Vec3 wo, Vec3 wi) const = 0;
    /// Chooses a direction for `wo`, which may lie below the surface, where no light comes from.
    virtual Vec3 direction(Vec3 wo, Vec2 u) const = 0;

    /// Whether it stays the same when both directions turn about the normal.
    virtual bool isotropic() const = 0;

    bool sample(Vec3 wo, Vec2 u, BsdfSample& s) const;
    /// The mean over the azimuth of `wo`, linear between the nodes of a table over its cosine, and at most 1.
    Color albedo(Vec3 wo) const;
    /// The largest entry of that table before it was limited: above 1, more light is reflected than arrives.
    float largest_albedo() const { return largest_albedo_; }

  protected:
    /// Fills the table of the albedo from samples; constructors call it last.
    void integrate();

  private:
    static constexpr size_t albedo_nodes = 17;
    std::array<Color, albedo_nodes> albedo_{};
    float largest_albedo_ = 0;
};

struct MeasuredLobe {
    static constexpr bool is_diffuse = false, is_delta = false;
    const MeasuredBrdf* brdf;

    EvalPdf eval(Vec3 wo, Vec3 wi) const { return brdf->eval(wo, wi); }
    bool sample(Vec3 wo, float, Vec2 u, BsdfSample& s) const { return brdf->sample(wo, u, s); }
    Color albedo(Vec3 wo) const { return brdf->albedo(wo); }
};

}  // namespace eclat
