// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// A Monte Carlo mean against the truth, in standard errors.

#pragma once

#include <cmath>

namespace eclat {

class RunningMean {
  public:
    void add(double x) {
        ++count_;
        sum_ += x;
        squares_ += x * x;
    }
    double mean() const { return sum_ / count_; }
    double standard_error() const {
        const double m = mean(), variance = squares_ / count_ - m * m;
        return std::sqrt(variance > 0 ? variance / count_ : 0);
    }
    /// |mean − truth| within 5 standard errors (a false alarm in 2 million) and float's rounding.
    bool agrees(double truth) const {
        return std::abs(mean() - truth) <= 5 * standard_error() + 2e-6 * std::abs(truth);
    }

  private:
    double count_ = 0, sum_ = 0, squares_ = 0;
};

}  // namespace eclat
