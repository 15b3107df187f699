// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include <doctest/doctest.h>

#include "methods/photon_map/kernel.h"

using namespace eclat;

TEST_CASE("kernels have the integral 1 over the unit disc, and quantiles are its inverse") {
    for (const Kernel kernel : {Kernel::uniform, Kernel::cone, Kernel::epanechnikov}) {
        constexpr int n = 20000;
        double sum = 0;
        for (int i = 0; i < n; ++i) {
            const double x = (i + 0.5) / n;
            sum += 2 * M_PI * x * double(kernel_weight(kernel, float(x * x))) / n;
            if (i % 1000 == 500) {
                const double edge = (i + 1.0) / n;
                CHECK(kernel_quantile2(kernel, float(sum)) == doctest::Approx(edge * edge).epsilon(2e-4));
            }
        }
        CHECK(sum == doctest::Approx(1).epsilon(1e-5));
    }
}
