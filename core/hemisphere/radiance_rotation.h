// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Rotation of coefficients from one frame to another in single precision, which a query does for each record whose normal
// differs. Rotations about the normal keep the basis of radiance records. Other rotations use inner products with the spherical
// harmonics, which continue the light smoothly below the record's horizon (docs/algorithms/radiance_cache.md).
//
// References   [IvanicRuedenberg96] generators; harmonics/rotation.h has the same series in double precision
// Held to      tests/core/hemisphere/test_radiance_rotation.cpp

#pragma once

#include <vector>

#include "base/frame.h"
#include "harmonics/projection.h"

namespace eclat {

/// Turns coefficients about the normal by the angle whose cosine and sine are given; in place.
void turn_coefficients(int order, float cosine, float sine, float* c);

class RadianceRotation {
  public:
    RadianceRotation() = default;
    explicit RadianceRotation(int order);

    /// Coefficients in `to` of the function that has `c` in `from`; in place, up to `order`.
    void operator()(const Frame& from, const Frame& to, int order, float* c) const;

  private:
    void tilt(float angle, int order, float* c) const;
    size_t index(int l, int k, int m) const { return size_t((m * order_ + l) * order_ + k); }

    int order_ = 0;
    std::vector<float> factors_;  // HemisphereFit::factor
    std::vector<float> ladder_;   // polar_count: of (l, m) and (l, m + 1)
};

}  // namespace eclat
