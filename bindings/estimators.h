// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Estimators as Python holds them: opaque, made by named functions, and handed to `render` and `irradiance`.

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
