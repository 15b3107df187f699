// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Microfacet models of rough surfaces: the distribution of normals, masking, and sampling of the visible normals.
//
// References   [Walter07], [Heitz14]; ggx.h and beckmann.h hold the two distributions

#pragma once

#include "bsdf/beckmann.h"
#include "bsdf/ggx.h"

namespace eclat {

enum class Distribution : uint8_t { ggx, beckmann };

/// Masking and shadowing: independent of each other, or correlated by height (GGX only) [Heitz14 sec. 6].
enum class Masking : uint8_t { separable, correlated };

/// Below this, an interface is treated as smooth: single precision no longer resolves the peak.
constexpr float smallest_alpha = 1e-3f;

struct Microfacets {
    float alpha_u = 0.1f, alpha_v = 0.1f;
    Distribution distribution = Distribution::ggx;
    Masking masking = Masking::separable;

    Microfacets() = default;
    Microfacets(float au, float av, Distribution d, Masking m = Masking::separable)
        : alpha_u(std::max(au, smallest_alpha)), alpha_v(std::max(av, smallest_alpha)), distribution(d), masking(m) {}

    static bool smooth(float alpha_u, float alpha_v) { return std::max(alpha_u, alpha_v) < smallest_alpha; }

    /// D(m), m.z > 0.
    float density(Vec3 m) const {
        return distribution == Distribution::ggx ? ggx_density(m, alpha_u, alpha_v)
                                                 : beckmann_density(m, alpha_u, alpha_v);
    }

    /// σ(w) = w.z / G1(w): the normaliser of the density of visible normals.
    float visible_area(Vec3 w) const {
        return distribution == Distribution::ggx ? ggx_visible_area(w, alpha_u, alpha_v)
                                                 : beckmann_visible_area(w, alpha_u, alpha_v);
    }

    /// G1(w), w.z > 0: the share that no other facet hides.
    float unmasked(Vec3 w) const {
        return w.z / (distribution == Distribution::ggx ? ggx_visible_area(w, alpha_u, alpha_v)
                                                        : beckmann_fitted_area(w, alpha_u, alpha_v));
    }

    /// G2(a, b) / (4 a.z b.z), for directions on the upper side (mirror a refracted one).
    float visibility(Vec3 a, Vec3 b) const {
        if (distribution == Distribution::beckmann)
            return 0.25f / (beckmann_fitted_area(a, alpha_u, alpha_v) * beckmann_fitted_area(b, alpha_u, alpha_v));
        const float s_a = ggx_stretch(a, alpha_u, alpha_v), s_b = ggx_stretch(b, alpha_u, alpha_v);
        if (masking == Masking::correlated) return 0.5f / (a.z * s_b + b.z * s_a);  // [Heitz14 eq. 99]
        return 1 / ((a.z + s_a) * (b.z + s_b));
    }

    /// Normal with density D(m) · max(0, dot(wo, m)) / σ(wo), wo.z > 0.
    Vec3 sample_visible_normal(Vec3 wo, Vec2 u) const {
        return distribution == Distribution::ggx ? sample_ggx_visible_normal(wo, u, alpha_u, alpha_v)
                                                 : sample_beckmann_visible_normal(wo, u, alpha_u, alpha_v);
    }
};

}  // namespace eclat
