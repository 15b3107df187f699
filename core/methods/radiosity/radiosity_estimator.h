// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The estimators of radiosity.

#pragma once

#include "methods/radiosity/radiosity_gathering.h"
#include "transport/estimator.h"

namespace eclat {

/// Both borrow the field.
Estimator radiosity_estimator(const World& world, const RadiosityField& field, int gather_rays, int max_depth);
PointEstimator radiosity_point_estimator(const World& world, const RadiosityField& field);

}  // namespace eclat
