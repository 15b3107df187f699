// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Weights of samples that several techniques can generate [Veach97 §9.2]. An infinite density (a delta) has the weight 1.

#pragma once

namespace eclat {

/// Returns the weight of a sample that was drawn with density `pdf` and that another technique would draw with density
/// `other`.
inline float balance_heuristic(float pdf, float other) {
    if (!(pdf > 0)) return 0;
    return 1 / (1 + other / pdf);
}

/// Returns the weight with squared densities, which is better if each technique is good in a different region.
inline float power_heuristic(float pdf, float other) {
    if (!(pdf > 0)) return 0;
    const float ratio = other / pdf;
    return 1 / (1 + ratio * ratio);
}

}  // namespace eclat
