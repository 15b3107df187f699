// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Tables as MERL and RGL measure them, of BSDFs that are known in closed form.

#pragma once

#include <vector>

#include "bsdf/bsdf.h"
#include "bsdf/merl.h"
#include "bsdf/microfacet.h"
#include "bsdf/rgl.h"

namespace eclat::test {

/// The values (3, 90, 90, 180) of an isotropic BSDF.
inline std::vector<float> merl_values(const Bsdf& bsdf) {
    constexpr size_t heights = MerlBrdf::half_angles, differences = MerlBrdf::difference_angles,
                     azimuths = MerlBrdf::difference_azimuths;
    std::vector<float> values(3 * MerlBrdf::cells);
    for (size_t h = 0; h < heights; ++h)
        for (size_t d = 0; d < differences; ++d)
            for (size_t p = 0; p < azimuths; ++p) {
                const float root = (float(h) + 0.5f) / float(heights), theta = root * root * pi / 2;
                const float delta = (float(d) + 0.5f) * pi / 180, phi = (float(p) + 0.5f) * pi / 180;
                const Vec3 half{std::sin(theta), 0, std::cos(theta)}, rising{std::cos(theta), 0, -std::sin(theta)};
                const Vec3 aside =
                    rising * (std::sin(delta) * std::cos(phi)) + Vec3{0, 1, 0} * (std::sin(delta) * std::sin(phi));
                const Vec3 wi = half * std::cos(delta) + aside, wo = half * std::cos(delta) - aside;
                const size_t cell = (h * differences + d) * azimuths + p;
                const Color f = bsdf.eval(wo, wi, LobeSet::all).f;
                for (size_t i = 0; i < 3; ++i)
                    // What lies below the horizon has the value of the last cell above it.
                    values[i * MerlBrdf::cells + cell] = wi.z > 0 && wo.z > 0 ? f[int(i)]
                                                         : d == 0 ? 0.0f
                                                                  : values[i * MerlBrdf::cells + cell - azimuths];
            }
    return values;
}

/// The tables of a BSDF, whose normals are supposed to be distributed as `facets`.
struct RglTables {
    static constexpr size_t side = 32;
    std::vector<float> phi, theta, normals, projected, visible, luminance, channels;

    RglTables(const Bsdf& bsdf, const Microfacets& facets, std::vector<float> azimuths) : phi(std::move(azimuths)) {
        for (int i = 0; i < 10; ++i) theta.push_back(std::min(float(i) * 10, 88.0f) * pi / 180);
        for (size_t i = 0; i < side * side; ++i) {
            const Vec3 w = at_node(i);
            normals.push_back(facets.density(w));
            projected.push_back(facets.visible_area({w.x, w.y, std::max(w.z, 1e-3f)}));
        }
        for (const float azimuth : phi)
            for (const float angle : theta) {
                const Vec3 wo = towards(angle, phi.size() > 2 ? azimuth : 0);
                for (size_t i = 0; i < side * side; ++i) {
                    const Vec3 m = at_node(i);
                    const float u = float(i % side) / (side - 1);
                    visible.push_back(std::max(dot(wo, m), 0.0f) * facets.density(m) * u *
                                      std::sqrt(1 - std::min(m.z * m.z, 1.0f)));
                }
            }
        const size_t slices = phi.size() * theta.size();
        const BilinearWarp warp(side, side, slices, visible);
        const BilinearTable densities(side, side, 1, normals);
        channels.resize(3 * slices * side * side);
        for (size_t slice = 0; slice < slices; ++slice) {
            const Vec3 wo = towards(theta[slice % theta.size()], phi.size() > 2 ? phi[slice / theta.size()] : 0);
            for (size_t i = 0; i < side * side; ++i) {
                const Slices only{{slice}, {1}, 1};
                const Vec2 place = warp.sample({float(i % side) / (side - 1), float(i / side) / (side - 1)}, only).at;
                const Vec3 m = towards(place.x * place.x * pi / 2, (2 * place.y - 1) * pi), wi = reflected(wo, m);
                const float scale = 4 * facets.visible_area(wo) * wi.z / densities.eval(place, {{0}, {1}, 1});
                const Color f = wi.z > 0 ? bsdf.eval(wo, wi, LobeSet::all).f * scale : Color();
                for (size_t k = 0; k < 3; ++k) channels[(k * slices + slice) * side * side + i] = f[int(k)];
                luminance.push_back(std::max(eclat::luminance(f), 1e-6f));
            }
        }
    }

    RglData data() const {
        const auto of = [](const std::vector<float>& values) { return RglTable{side, side, values}; };
        RglData out{.nodes = {phi, theta},
                    .normals = of(normals),
                    .projected = of(projected),
                    .visible = of(visible),
                    .luminance = of(luminance),
                    .channels = {}};
        const size_t size = channels.size() / 3;
        for (size_t k = 0; k < 3; ++k) out.channels[k] = {side, side, {channels.data() + k * size, size}};
        return out;
    }

  private:
    static Vec3 towards(float theta, float phi) {
        return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
    }
    /// The direction of a node of the square.
    static Vec3 at_node(size_t i) {
        const float u = float(i % side) / (side - 1), v = float(i / side) / (side - 1);
        return towards(u * u * pi / 2, (2 * v - 1) * pi);
    }
};

}  // namespace eclat::test
