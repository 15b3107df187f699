// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A point light whose intensity was measured over directions, as manufacturers of luminaires publish it [IES19].

#pragma once

#include <array>
#include <vector>

#include "lights/light_sample.h"
#include "sampling/discrete.h"

namespace eclat {

/// Intensities at nodes of spherical coordinates, between which they are linear in both angles. Outside of the nodes nothing is
/// emitted.
struct IntensityTable {
    std::vector<float> polar;    // degrees from the third axis, ascending within [0, 180]
    std::vector<float> azimuth;  // degrees from the first axis towards the second, ascending over at most 360
    std::vector<float> values;   // relative intensities, one row for each polar angle
};

class ProfileLight {
  public:
    /// The axes are orthonormal and of either handedness; `intensity` in W sr^-1 multiplies the table.
    ProfileLight(Vec3 position, const std::array<Vec3, 3>& axes, Color intensity, IntensityTable table);

    LightSample sample(Vec3 from) const {
        const Vec3 to = position_ - from;
        const float d2 = length_squared(to);
        if (!(d2 > 0)) return {};
        const float distance = std::sqrt(d2);
        const Vec3 wi = to * (1 / distance);
        const float value = relative_intensity(-wi);
        if (!(value > 0)) return {};
        return {wi, distance, intensity_ * (value / d2), 1, true};
    }

    /// Chooses a cell between nodes in proportion to its flux, and a direction in the cell uniformly in solid angle.
    PhotonSample emit(Vec2 u) const;

    Color power() const { return intensity_ * static_cast<float>(cells_.total()); }

    /// The table towards a unit vector.
    float relative_intensity(Vec3 w) const;

  private:
    Vec3 position_;
    std::array<Vec3, 3> axes_;
    Color intensity_;
    IntensityTable table_;
    PiecewiseConstant2D cells_;  // by flux, a row for each interval of the polar angle
};

}  // namespace eclat
