// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The radiosity equation over linked patches, and two ways to solve it [Goral84]:
//
//   B_i = E_i + ρ_i I_i + τ_i I_i',   I_i = H_i + Σ_j F_ij B_j
//
//   B_i   radiosity                                      W m⁻²
//   E_i   radiosity of its own light                     W m⁻²
//   H_i   irradiance from lights that are no patches     W m⁻²
//   F_ij  form factor
//   I_i   irradiance                                     W m⁻²
//   I_i'  the same of what lies behind it                W m⁻²
//   ρ, τ  albedo, and transmittance from the back
//
// Irradiance comes down the tree from where links end to the patches below (push); radiosity goes up as the mean by area
// (pull) [Hanrahan91].

#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/progress.h"
#include "methods/radiosity/links.h"
#include "methods/radiosity/other_sides.h"
#include "methods/radiosity/patch_surfaces.h"

namespace eclat {

class RadiositySystem {
  public:
    /// All are borrowed. `surfaces` has one a node.
    RadiositySystem(const PatchTree& tree, std::span<const PatchSurface> surfaces, const Exchanges& exchanges,
                    int threads);

    const PatchTree& tree() const { return tree_; }
    const PatchSurface& surface(uint32_t patch) const { return surfaces_[patch]; }
    const Exchanges& exchanges() const { return exchanges_; }
    const OtherSides& other_sides() const { return other_sides_; }
    int threads() const { return threads_; }

    /// Finds a factor for each patch so that the form factors of every patch sum to its closure, and applies it to all that
    /// it gives and takes: exchanges stay symmetric. Steps until the worst sum errs by less than `tolerance`, or `most`.
    void balance(float tolerance, int most, Progress& progress);
    float factor(uint32_t patch) const { return factor_[patch]; }
    /// Irradiance of the exposed part of a patch over what links bring it: links know only that part.
    float receives(uint32_t patch) const { return surfaces_[patch].unknown() ? 0 : factor_[patch]; }
    /// What a patch sends over links, which take all of it for exposed, over its radiosity.
    float sends(uint32_t patch) const { return factor_[patch] * surfaces_[patch].opacity * surfaces_[patch].exposed; }
    /// 1 for patches whose light is known: the others are left out, and what they would have sent is shared among those.
    std::vector<Color> known() const;
    /// Sums of form factors of all patches with those whose light is known, by node.
    std::vector<float> row_sums() const;

    /// Radiosity of what a patch lets through, from the irradiance of all, by node.
    Color let_through(uint32_t patch, std::span<const Color> irradiance) const;
    /// All that leaves a patch: its own light, and what it reflects and lets through.
    Color leaving(uint32_t patch, std::span<const Color> irradiance) const {
        const PatchSurface& s = surfaces_[patch];
        return s.emitted + s.albedo * irradiance[patch] + let_through(patch, irradiance);
    }

    /// What nodes send, from the radiosity of patches; both by node.
    std::vector<Color> pull(std::span<const Color> radiosity) const;
    /// Irradiance of patches by other patches of these radiosities; both by node.
    std::vector<Color> irradiance(std::span<const Color> radiosity) const;

  private:
    const PatchTree& tree_;
    std::span<const PatchSurface> surfaces_;
    const Exchanges& exchanges_;
    OtherSides other_sides_;
    int threads_;
    std::vector<float> factor_;
};

/// By node, of patches; W m⁻².
struct PatchLight {
    std::vector<Color> direct;  // irradiance from lights, patches that emit included
    std::vector<Color> total;   // irradiance
    int sweeps = 0;
    float residual = 0;  // of power that has not been reflected yet, relative to all
};

struct SolveLimits {
    float residual = 1e-5f;
    int sweeps = 1000;  // of gathering; each adds one bounce
};

/// All patches at a time gather from all others, sweep by sweep (Jacobi).
PatchLight solve_by_gathering(const RadiositySystem& system, const SolveLimits& limits, Progress& progress);

/// A few patches at a time, those with the most power that they have not sent yet, send it to all others: progressive
/// refinement [Cohen88].
PatchLight solve_by_shooting(const RadiositySystem& system, const SolveLimits& limits, Progress& progress);

/// The solution once more at the middle of each patch, with links of larger nodes that it is a part of taken there: what was
/// the same for all parts of a node varies over them [Lischinski93, local pass].
void refine_locally(const RadiositySystem& system, PatchLight& light, Progress& progress);

}  // namespace eclat
