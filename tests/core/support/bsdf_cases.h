// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The BSDFs that all tests of this folder run through, and directions to try them with.

#pragma once

#include <string>
#include <vector>

#include "bsdf/bsdf.h"
#include "measured_tables.h"

namespace eclat::test {

struct BsdfCase {
    std::string name;
    Bsdf bsdf;
    bool lossless = false;   ///< reflects and transmits everything
    bool two_faced = false;  ///< answers for wo.z < 0 as well
    float ior = 1;           ///< of the inside
};

inline Vec3 direction(float theta_degrees, float phi_degrees) {
    const float t = theta_degrees * pi / 180, p = phi_degrees * pi / 180;
    return {std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)};
}

inline const PlasticTable& smooth_coat() {
    static const PlasticTable table = make_plastic_table(1.5f, 0, Distribution::ggx);
    return table;
}

inline const PlasticTable& rough_coat(Distribution distribution) {
    static const PlasticTable ggx = make_plastic_table(1.5f, 0.3f, Distribution::ggx);
    static const PlasticTable beckmann = make_plastic_table(1.5f, 0.3f, Distribution::beckmann);
    return distribution == Distribution::ggx ? ggx : beckmann;
}

/// What is measured here: a white diffuse base and facets, each with half of the light.
inline Bsdf measured_model() {
    Bsdf model = make_diffuse(Color(0.5f));
    model.append(make_conductor(Color(0), Color(1), Color(1), 0.3f, 0.3f, Distribution::ggx), 0.5f);
    return model;
}

inline Bsdf anisotropic_model() { return make_conductor(Color(0), Color(1), Color(1), 0.25f, 0.5f, Distribution::ggx); }

inline const MerlBrdf& merl() {
    static const MerlBrdf brdf(merl_values(measured_model()));
    return brdf;
}

inline const RglBrdf& rgl() {
    static const RglBrdf brdf(RglTables(measured_model(), {0.3f, 0.3f, Distribution::ggx}, {0}).data());
    return brdf;
}

/// A quarter of the circle, whose symmetry gives the rest.
inline const RglBrdf& anisotropic_rgl() {
    static const RglBrdf brdf = [] {
        std::vector<float> azimuths;
        for (int i = 0; i <= 6; ++i) azimuths.push_back(-pi + float(i) * pi / 12);
        return RglBrdf(RglTables(anisotropic_model(), {0.25f, 0.5f, Distribution::ggx}, azimuths).data());
    }();
    return brdf;
}

inline MetallicRoughness gltf(float metallic, float alpha, float transmission, bool thin) {
    MetallicRoughness p;
    p.metallic = metallic;
    p.alpha = alpha;
    p.transmission = transmission;
    p.thin = thin;
    return p;
}

/// A guide whose densities lie between 0.2 and 4 times the mean, and which is symmetric about no axis.
inline const CosineGuide& uneven_guide() {
    static const CosineGuide guide = [] {
        std::array<float, CosineGuide::cells> weights;
        for (uint32_t i = 0; i < CosineGuide::cells; ++i) weights[i] = 0.2f + float(i * 37 % 64) / 16;
        return CosineGuide(weights);
    }();
    return guide;
}

inline Bsdf aimed(Bsdf bsdf) {
    bsdf.aim_diffuse(uneven_guide(), {0.6f, -0.8f});
    return bsdf;
}

/// White versions, so that every loss of energy is the model's own.
inline std::vector<BsdfCase> white_cases() {
    constexpr auto ggx = Distribution::ggx, beckmann = Distribution::beckmann;
    const Color white(1), half(0.5f), black(0);
    std::vector<BsdfCase> cases{
        {"diffuse", make_diffuse(white), true},
        {"phong 30", make_phong(half, half, 30)},
        {"phong 0", make_phong(black, white, 0)},
        {"phong 5000", make_phong(black, white, 5000)},
        {"ward", make_ward(black, white, 0.2f, 0.4f)},
        {"ward and diffuse", make_ward(half, half, 0.1f, 0.1f)},
        {"mirror", make_conductor(black, white, white, 0, 0, ggx), true},
        {"gold", make_conductor({0.143f, 0.375f, 1.442f}, {3.98f, 2.39f, 1.6f}, white, 0.3f, 0.3f, ggx)},
        {"metal correlated", make_conductor(black, white, white, 0.5f, 0.3f, ggx, Masking::correlated)},
        {"thin dielectric", make_thin_dielectric(1.5f, white, white), true, true},
        {"translucent", make_translucent(half, half), true},
        {"plastic", make_plastic(smooth_coat(), white, white, ggx, false), true},
        {"plastic nonlinear", make_plastic(smooth_coat(), white, white, ggx, true), true},
        {"plastic ggx", make_plastic(rough_coat(ggx), white, white, ggx, false)},
        {"plastic beckmann", make_plastic(rough_coat(beckmann), white, white, beckmann, true)},
        {"gltf smooth", make_metallic_roughness(gltf(0, 0, 0, true)), true},
        {"gltf 0.3", make_metallic_roughness(gltf(0, 0.3f, 0, true)), true},
        {"gltf 1", make_metallic_roughness(gltf(0, 1, 0, true)), true},
        {"gltf metal", make_metallic_roughness(gltf(1, 0.4f, 0, true))},
        {"gltf half metal", make_metallic_roughness(gltf(0.5f, 0.4f, 0, true))},
        {"gltf thin glass", make_metallic_roughness(gltf(0, 0, 1, true)), true},
        {"gltf frosted", make_metallic_roughness(gltf(0, 0.4f, 0.7f, true))},
        {"gltf solid", make_metallic_roughness(gltf(0, 0.3f, 1, false)), false, true, 1.5f},
        {"merl", make_measured(merl(), white)},
        {"rgl", make_measured(rgl(), white)},
        {"rgl anisotropic", make_measured(anisotropic_rgl(), white)},
    };
    for (const float alpha : {0.002f, 0.2f, 1.0f}) {
        const std::string suffix = " alpha " + std::to_string(alpha);
        for (const auto d : {ggx, beckmann}) {
            const std::string name = d == ggx ? "ggx" : "beckmann";
            cases.push_back({name + suffix, make_conductor(black, white, white, alpha, alpha * 0.5f, d)});
            cases.push_back({"dielectric " + name + suffix, make_dielectric(1.5f, alpha, alpha * 0.5f, white, white, d),
                             false, true, 1.5f});
        }
    }
    cases.push_back({"dielectric", make_dielectric(1.5f, 0, 0, white, white, ggx), true, true, 1.5f});
    cases.push_back(
        {"dielectric 1 / 1.33", make_dielectric(1 / 1.33f, 0.3f, 0.3f, white, white, ggx), false, true, 1 / 1.33f});
    cases.push_back({"dielectric 1", make_dielectric(1, 0.3f, 0.3f, white, white, ggx), true, true, 1});
    Bsdf blend;
    blend.append(make_conductor(black, white, white, 0.3f, 0.3f, ggx), 0.25f);
    blend.append(make_plastic(smooth_coat(), {0.9f, 0.5f, 0.1f}, white, ggx, false), 0.75f);
    cases.push_back({"blend", blend});
    cases.push_back({"aimed blend", aimed(blend)});
    cases.push_back({"aimed diffuse", aimed(make_diffuse(white)), true});
    cases.push_back({"aimed translucent", aimed(make_translucent(half, half)), true});
    cases.push_back({"aimed plastic", aimed(make_plastic(smooth_coat(), white, white, ggx, false)), true});
    cases.push_back({"aimed gltf", aimed(make_metallic_roughness(gltf(0, 0.3f, 0, true)))});
    return cases;
}

/// Lobes one at a time, each sampled by one smooth map of the unit square.
inline std::vector<BsdfCase> single_map_cases() {
    constexpr auto ggx = Distribution::ggx, beckmann = Distribution::beckmann;
    const Color white(1), black(0);
    return {
        {"diffuse", make_diffuse(white)},
        {"phong 2", make_phong(black, white, 2)},
        {"phong 100", make_phong(black, white, 100)},
        {"ward", make_ward(black, white, 0.2f, 0.5f)},
        {"ggx", make_conductor(black, white, white, 0.2f, 0.6f, ggx)},
        {"ggx 1", make_conductor(black, white, white, 1, 1, ggx)},
        {"beckmann", make_conductor(black, white, white, 0.2f, 0.6f, beckmann)},
        {"beckmann 1", make_conductor(black, white, white, 1, 1, beckmann)},
        {"reflection ggx", make_dielectric(1.5f, 0.3f, 0.5f, white, black, ggx), false, true},
        {"reflection beckmann", make_dielectric(1.5f, 0.3f, 0.5f, white, black, beckmann), false, true},
        {"refraction ggx", make_dielectric(1.5f, 0.3f, 0.5f, black, white, ggx), false, true},
        {"refraction beckmann", make_dielectric(1.5f, 0.3f, 0.5f, black, white, beckmann), false, true},
        {"refraction ggx 1.002", make_dielectric(1.002f, 0.3f, 0.5f, black, white, ggx), false, true},
        {"refraction beckmann 0.99", make_dielectric(0.99f, 0.3f, 0.5f, black, white, beckmann), false, true},
        {"rgl", make_measured(rgl(), white)},
        {"rgl anisotropic", make_measured(anisotropic_rgl(), white)},
        {"refraction ggx out", make_dielectric(0.7f, 0.3f, 0.1f, black, white, ggx), false, true},
    };
}

/// Seen from above, from nearly overhead to nearly along the surface.
inline std::vector<Vec3> directions_above() {
    return {direction(0, 0),    direction(3, 40),   direction(30, 100),
            direction(60, 220), direction(80, 310), direction(88, 15)};
}

inline std::vector<Vec3> directions_of(const BsdfCase& c) {
    std::vector<Vec3> out = directions_above();
    if (c.two_faced)
        for (const Vec3 w : directions_above()) out.push_back(mirrored(w));
    return out;
}

/// ∫ g(w) dw over the sphere by the midpoint rule in cosθ² (finer along the surface) and φ.
template <class F>
auto integrate_sphere(int n, const F& g) {
    decltype(g(Vec3{})) sum{};
    for (int side = 0; side < 2; ++side)
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < 2 * n; ++j) {
                const float t = (float(i) + 0.5f) / float(n), z = t * t, phi = pi * (float(j) + 0.5f) / float(n);
                const float s = std::sqrt(1 - z * z);
                sum += g({s * std::cos(phi), s * std::sin(phi), side ? -z : z}) * (2 * t / float(n) * pi / float(n));
            }
    return sum;
}

/// `n` samples at the points of a lattice in the unit cube (u_lobe, u): f(sample or nothing).
template <class F>
void for_each_sample(const Bsdf& bsdf, Vec3 wo, LobeSet set, int n, const F& f) {
    // Powers of the root of x⁴ = x + 1: a Kronecker sequence, spread evenly for every n.
    constexpr double g = 1.22074408460575947536;
    const auto fraction = [](double x) { return std::min(float(x - std::floor(x)), below_one); };
    for (int i = 1; i <= n; ++i)
        f(bsdf.sample(wo, fraction(0.5 + i / g), {fraction(0.5 + i / (g * g)), fraction(0.5 + i / (g * g * g))}, set));
}

}  // namespace eclat::test
