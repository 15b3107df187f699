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
    /// `surfaces` has one entry per node. All arguments must outlive this object.
    RadiositySystem(const PatchTree& tree, std::span<const PatchSurface> surfaces, const Exchanges& exchanges,
                    int threads);

    const PatchTree& tree() const { return tree_; }
    const PatchSurface& surface(uint32_t patch) const { return surfaces_[patch]; }
    const Exchanges& exchanges() const { return exchanges_; }
    const OtherSides& other_sides() const { return other_sides_; }
    int threads() const { return threads_; }

    /// Computes a factor for each patch with which the sum of its form factors equals its closure. The factors of both
    /// patches multiply their exchange, which therefore stays symmetric. The iteration ends when the largest error of a
    /// sum is below `tolerance`, or after `most` steps.
    void balance(float tolerance, int most, Progress& progress);
    float factor(uint32_t patch) const { return factor_[patch]; }
    /// The ratio of the irradiance of the exposed part of a patch to that which links give.
    float receives(uint32_t patch) const { return surfaces_[patch].unknown() ? 0 : factor_[patch]; }
    /// The ratio of the light that a patch sends over links, for which it is fully exposed, to its radiosity.
    float sends(uint32_t patch) const { return factor_[patch] * surfaces_[patch].opacity * surfaces_[patch].exposed; }
    /// This is 1 for patches whose light is known. The others are left out, and their share of the form factors is
    /// distributed over the known ones.
    std::vector<Color> known() const;
    /// The sum of the form factors of each patch to the patches whose light is known, by node.
    std::vector<float> row_sums() const;

    /// Returns the transmitted radiosity of a patch, from the irradiance of all nodes.
    Color let_through(uint32_t patch, std::span<const Color> irradiance) const;
    /// Returns the radiosity of a patch: the emitted, reflected and transmitted light.
    Color leaving(uint32_t patch, std::span<const Color> irradiance) const {
        const PatchSurface& s = surfaces_[patch];
        return s.emitted + s.albedo * irradiance[patch] + let_through(patch, irradiance);
    }

    /// Returns the light that nodes send, from the radiosity of patches; both are by node.
    std::vector<Color> pull(std::span<const Color> radiosity) const;
    /// Returns the irradiance of patches from other patches with these radiosities; both are by node.
    std::vector<Color> irradiance(std::span<const Color> radiosity) const;

  private:
    const PatchTree& tree_;
    std::span<const PatchSurface> surfaces_;
    const Exchanges& exchanges_;
    OtherSides other_sides_;
    int threads_;
    std::vector<float> factor_;
};

/// The light of patches, by node, in W m⁻².
struct PatchLight {
    std::vector<Color> direct;  // irradiance from lights, patches that emit included
    std::vector<Color> total;   // irradiance
    int sweeps = 0;
    float residual = 0;  // power that has not been reflected yet, relative to the total
};

struct SolveLimits {
    float residual = 1e-5f;
    int sweeps = 1000;  // greatest number of gathering sweeps, each of which adds one bounce
};

/// Solves by gathering: in each sweep, all patches gather from all others (Jacobi iteration).
PatchLight solve_by_gathering(const RadiositySystem& system, const SolveLimits& limits, Progress& progress);

/// Solves by progressive refinement [Cohen88]: in each step, the few patches with the most unsent power send it to all
/// others.
PatchLight solve_by_shooting(const RadiositySystem& system, const SolveLimits& limits, Progress& progress);

/// Evaluates the solution once more at the centre of each patch, with the form factors from there to the other ends of
/// the links, so that light that links distributed uniformly over a larger node varies over its parts [Lischinski93,
/// local pass].
void refine_locally(const RadiositySystem& system, PatchLight& light, Progress& progress);

}  // namespace eclat
