// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// How the field of light bends, as its gradients at several records tell: by how they differ.
//
// A record extrapolates along its tangent, which lies above the field on both sides where the field bends down: under a
// window of cloth all records erred alike, and pictures of a room were 2 to 3 % too bright, of gloss as of irradiance. The
// covariance of gradients g_i and ways P − P_i, with the weights w_i of the records,
//   Σ w_i (P − P_i) · g_i / Σ w_i − (Σ w_i (P − P_i) / Σ w_i) · (Σ w_i g_i / Σ w_i) ,
// is twice what the tangents leave out around the mean way, exactly for a quadratic field [KraaijpoelLeeuwen10].
//
// References   [KraaijpoelLeeuwen10] half of the first order
// Held to      tests/core/records/test_record_cache.cpp, tests/core/records/test_radiance_record_cache.cpp

#include <array>

#include "base/color.h"
#include "base/vec.h"
#include "hemisphere/gradients.h"

namespace eclat {

class Bending {
  public:
    void add(const TranslationGradient& gradient, Vec3 way, float weight) {
        ways_ += way * weight;
        weights_ += weight;
        for (int c = 0; c < 3; ++c) {
            gradients_[static_cast<size_t>(c)] += gradient.channel[static_cast<size_t>(c)] * weight;
            along_[c] += dot(gradient.channel[static_cast<size_t>(c)], way) * weight;
        }
    }

    /// Returns the covariance of gradient and way in a colour channel, summed over the axes, in the unit of the field.
    float covariance(int channel) const {
        return (along_[channel] - dot(gradients_[static_cast<size_t>(channel)], ways_) / weights_) / weights_;
    }

  private:
    float weights_ = 0;
    Vec3 ways_;
    std::array<Vec3, 3> gradients_;
    Color along_;
};

}  // namespace eclat
