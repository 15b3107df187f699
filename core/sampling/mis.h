// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Weights of samples that several techniques can generate [Veach97 §9.2]. An infinite density (a delta) has the weight 1.

#pragma once

namespace eclat {

/// Weight of a sample drawn with density `pdf` that another technique would have drawn with `other`.
inline float balance_heuristic(float pdf, float other) {
    if (!(pdf > 0)) return 0;
    return 1 / (1 + other / pdf);
}

/// The same with squared densities, which suits techniques that are each good somewhere.
inline float power_heuristic(float pdf, float other) {
    if (!(pdf > 0)) return 0;
    const float ratio = other / pdf;
    return 1 / (1 + ratio * ratio);
}

}  // namespace eclat
