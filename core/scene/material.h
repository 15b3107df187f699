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
    measured,
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
inline constexpr Names measured[] = {"scale"};
inline constexpr Names blend[] = {"weight"};
}  // namespace detail

/// Returns the names of the parameters of a kind; `Material` in Python documents their meaning.
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
        case MaterialKind::measured: return detail::measured;
        case MaterialKind::blend: return detail::blend;
    }
    return {};
}

/// Returns the index of a parameter among those of its kind; a name that the kind does not have does not compile.
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
    bool hidden_from_camera = false;
    int children[2] = {-1, -1};
    bool beckmann = false;
    bool correlated = false;  // whether masking and shadowing of a conductor are correlated, with GGX only
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
    std::shared_ptr<const MeasuredBrdf> table;  // measured only
    int lobes = 1;                              // greatest number of lobes that a point may need

    /// Returns whether it is black or invisible from behind.
    bool has_no_back() const { return !two_sided && !transmits; }
    /// Returns whether rays that come from behind pass through.
    bool culls_back() const { return back_culled && has_no_back(); }

    /// Returns whether its lobes depend on directions in the tangent plane.
    bool anisotropic() const {
        return kind == MaterialKind::ward || kind == MaterialKind::conductor || kind == MaterialKind::dielectric ||
               (kind == MaterialKind::measured && !table->isotropic());
    }

    /// Computes the values that depend only on constants; `materials` contains its children, which must have been
    /// prepared.
    void prepare(const std::vector<Material>& materials);
};

/// The data of a surface point that materials need.
struct SurfaceCoordinates {
    Vec2 uv, uv2;
    Color vertex_color{1};
    float vertex_alpha = 1;
};

/// Makes the lobes of `materials[index]`; the z axis of their frame is on the visible side.
Bsdf make_bsdf(const std::vector<Material>& materials, int index, const SurfaceCoordinates& at, bool from_behind);

/// Straight-through opacity in [0, 1].
float opacity_at(const Material& material, const SurfaceCoordinates& at);

}  // namespace eclat
