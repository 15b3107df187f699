// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Probes: the light that arrives at points in space from all sides, as coefficients of spherical harmonics.
//
// Symbol   name here      meaning
//   L(ω)     –              radiance that arrives from direction ω                               W m⁻² sr⁻¹
//   Y_i      harmonics      spherical harmonics, orthonormal, of the axes of the world
//   c_i      coefficients   ∫ L(ω) Y_i(ω) dω over the sphere [RamamoorthiHanrahan01]        W m⁻²
//   A_l      –              π, 2π/3, π/4, 0, −π/24, …: E(n) = Σ A_l c_lm Y_lm(n) is the irradiance [RamamoorthiHanrahan01]
//
// L is the sum of light that surfaces scatter, which the estimator of a method finds along N uniform directions, and of
// light straight from lights, for which lights are sampled as well (transport/arriving_light.h).
//
// References   [RamamoorthiHanrahan01]
// Held to      tests/core/transport/test_space_probes.cpp, tests/methods/test_probe_light.py

#pragma once

#include <span>
#include <vector>

#include "transport/estimator.h"
#include "transport/point_irradiance.h"

namespace eclat {

struct ProbeOptions {
    Component component = Component::total;
    int order = 3;       // number of bands, hence order² coefficients
    int samples = 1024;  // number of directions, and of light samples, per probe
    uint32_t seed = 0;
    int threads = 0;
};

/// Coefficients of all probes, order² of each.
struct ProbeCoefficients {
    std::vector<Color> values;
    /// Half the difference between the two halves of the samples, whose magnitude is the standard error of each. It is 0
    /// where there is only one sample.
    std::vector<Color> errors;
    size_t dropped = 0;  // number of radiances that were not finite and count as dark
};

/// Projects the light at each of `positions`. `scattered` gives the light along rays; what it finds on the first edge
/// straight from a source is left out, because it is direct light. It is not called if only direct light is wanted.
ProbeCoefficients project_probes(const World& world, std::span<const Vec3> positions, const Estimator& scattered,
                                 const ProbeOptions& options, Progress& progress);

/// Projects the light that arrives at points of surfaces from the side of their normals, likewise. Below the surface it is 0.
ProbeCoefficients project_probes(const World& world, std::span<const PointNormal> points, const Estimator& scattered,
                                 const ProbeOptions& options, Progress& progress);

}  // namespace eclat
