// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The closed family of lobes. Each has: is_diffuse, is_delta; eval, sample (false: absorbed), albedo.

#pragma once

#include <variant>

#include "bsdf/dielectric.h"
#include "bsdf/lambert.h"
#include "bsdf/metallic_roughness.h"
#include "bsdf/phong.h"
#include "bsdf/plastic.h"
#include "bsdf/reflection.h"
#include "bsdf/thin_dielectric.h"
#include "bsdf/ward.h"

namespace eclat {

/// Up to eleven alternatives, std::visit is a switch that the compiler inlines.
using Lobe = std::variant<LambertLobe, CoupledDiffuseLobe, CoatedDiffuseLobe, RoughReflectionLobe, MirrorLobe,
                          RoughDielectricLobe, SmoothDielectricLobe, ThinDielectricLobe, PhongLobe, WardLobe,
                          DiffuseTransmissionLobe>;

static_assert(std::variant_size_v<Lobe> <= 11);

}  // namespace eclat
