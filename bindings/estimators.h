// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Estimators for Python: opaque objects that named functions make, and that `render` and `irradiance` take.

#pragma once

#include "transport/estimator.h"

namespace eclat {

struct EstimatorHolder {
    Estimator call;
};

struct PointEstimatorHolder {
    PointEstimator call;
};

}  // namespace eclat
