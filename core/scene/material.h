// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Makes the BSDF at a point from textured parameters. Kinds and parameters are those of `Material` in Python.

#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "bsdf/bsdf.h"
#include "scene/texture.h"

namespace eclat {

enum class MaterialKind : uint8_t {
    diffuse,
    phong,
    ward,
    conductor,
    dielectric,
    thin_dielectric,
    plastic,
    metallic_roughness,
    translucent,
    blend
};

namespace detail {
using Names = std::string_view;
inline constexpr Names diffuse[] = {"reflectance"};
inline constexpr Names phong[] = {"diffuse_reflectance", "specular_reflectance", "exponent"};
inline constexpr Names ward[] = {"diffuse_reflectance", "specular_reflectance", "alpha_u", "alpha_v"};
inline constexpr Names conductor[] = {"eta", "k", "specular_reflectance", "alpha_u", "alpha_v"};
inline constexpr Names dielectric[] = {"specular_reflectance", "specular_transmittance", "ior", "alpha_u", "alpha_v"};
inline constexpr Names thin_dielectric[] = {"specular_reflectance", "specular_transmittance", "ior"};
inline constexpr Names plastic[] = {"diffuse_reflectance", "specular_reflectance", "ior", "alpha_u"};
inline constexpr Names metallic_roughness[] = {"base_color",
                                               "metallic",
                                               "roughness",
                                               "ior",
                                               "specular",
                                               "specular_color",
                                               "transmission",
                                               "diffuse_transmission",
                                               "diffuse_transmission_color"};
inline constexpr Names translucent[] = {"reflectance", "transmittance"};
inline constexpr Names blend[] = {"weight"};
}  // namespace detail

/// What the parameters of a kind are called; what they mean is told beside `Material` in Python.
constexpr std::span<const std::string_view> parameter_names(MaterialKind kind) {
    switch (kind) {
        case MaterialKind::diffuse: return detail::diffuse;
        case MaterialKind::phong: return detail::phong;
        case MaterialKind::ward: return detail::ward;
        case MaterialKind::conductor: return detail::conductor;
        case MaterialKind::dielectric: return detail::dielectric;
        case MaterialKind::thin_dielectric: return detail::thin_dielectric;
        case MaterialKind::plastic: return detail::plastic;
        case MaterialKind::metallic_roughness: return detail::metallic_roughness;
        case MaterialKind::translucent: return detail::translucent;
        case MaterialKind::blend: return detail::blend;
    }
    return {};
}

/// The place of a parameter among those of its kind; a name that the kind does not have does not compile.
consteval size_t parameter(MaterialKind kind, std::string_view name) {
    const auto names = parameter_names(kind);
    for (size_t i = 0; i < names.size(); ++i)
        if (names[i] == name) return i;
    throw "no such parameter";
}

struct Material {
    MaterialKind kind = MaterialKind::diffuse;
    std::vector<Value> parameters;  // in the order of `parameter_names(kind)`
    bool two_sided = true;
    int back = -1;             // with two_sided, the material of the other side; −1: the same
    bool back_culled = false;  // without two_sided, rays pass through the back
    int children[2] = {-1, -1};
    bool beckmann = false;
    bool nonlinear = false;
    bool thin_walled = true;
    Value opacity;
    float alpha_cutoff = -1;  // < 0: none
    bool vertex_colors = false;
    bool has_normal_map = false, bump = false;
    Value normal_map;
    float normal_scale = 1;
    bool emits = false;
    Value emission;
    bool emission_two_sided = false;

    bool transmits = false;  // some light goes through, so one-sidedness does not apply
    bool pane = false;       // some light goes straight through, and so do shadow rays
    bool refracts = false;   // inside and outside differ, so its frame is never turned towards the viewer
    PlasticTable coat;       // plastic only
    int lobes = 1;           // that a point of it may need, at most

    /// Nothing is seen of it from behind.
    bool has_no_back() const { return !two_sided && !transmits; }
    /// Rays that come from behind pass through.
    bool culls_back() const { return back_culled && has_no_back(); }

    /// Its lobes depend on directions in the tangent plane.
    bool anisotropic() const {
        return kind == MaterialKind::ward || kind == MaterialKind::conductor || kind == MaterialKind::dielectric;
    }

    /// Fills what depends on constants only; `materials` holds its children, prepared.
    void prepare(const std::vector<Material>& materials);
};

/// What varies over a surface, as materials need it.
struct SurfaceCoordinates {
    Vec2 uv, uv2;
    Color vertex_color{1};
    float vertex_alpha = 1;
};

/// Lobes of `materials[index]`; z of their frame is the side that is looked at.
Bsdf make_bsdf(const std::vector<Material>& materials, int index, const SurfaceCoordinates& at, bool from_behind);

/// Straight-through opacity in [0, 1].
float opacity_at(const Material& material, const SurfaceCoordinates& at);

}  // namespace eclat
