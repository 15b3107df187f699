// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The closed family of lobes. Each has: is_diffuse, is_delta; eval, sample (false: absorbed), albedo.

#pragma once

#include <variant>

#include "bsdf/dielectric.h"
#include "bsdf/lambert.h"
#include "bsdf/measured.h"
#include "bsdf/metallic_roughness.h"
#include "bsdf/phong.h"
#include "bsdf/plastic.h"
#include "bsdf/reflection.h"
#include "bsdf/thin_dielectric.h"
#include "bsdf/ward.h"

namespace eclat {

using Lobe = std::variant<LambertLobe, CoupledDiffuseLobe, CoatedDiffuseLobe, RoughReflectionLobe, MirrorLobe,
                          RoughDielectricLobe, SmoothDielectricLobe, ThinDielectricLobe, PhongLobe, WardLobe,
                          DiffuseTransmissionLobe, MeasuredLobe>;

/// Calls `f` with the alternative that the lobe holds, as std::visit does, which the compiler inlines up to eleven alternatives
/// only.
template <class F>
auto visit_lobe(const F& f, const Lobe& lobe) {
    static_assert(std::variant_size_v<Lobe> == 12);
    switch (lobe.index()) {
        case 0: return f(*std::get_if<0>(&lobe));
        case 1: return f(*std::get_if<1>(&lobe));
        case 2: return f(*std::get_if<2>(&lobe));
        case 3: return f(*std::get_if<3>(&lobe));
        case 4: return f(*std::get_if<4>(&lobe));
        case 5: return f(*std::get_if<5>(&lobe));
        case 6: return f(*std::get_if<6>(&lobe));
        case 7: return f(*std::get_if<7>(&lobe));
        case 8: return f(*std::get_if<8>(&lobe));
        case 9: return f(*std::get_if<9>(&lobe));
        case 10: return f(*std::get_if<10>(&lobe));
        default: return f(*std::get_if<11>(&lobe));
    }
}

}  // namespace eclat
