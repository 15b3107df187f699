// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "scene/material.h"

#include "base/error.h"

namespace eclat {

namespace {

class Reader {
  public:
    Reader(const Material& material, const SurfaceCoordinates& at) : material_(material), at_(at) {}
    Color color(size_t i) const { return material_.parameters[i].color(at_.uv, at_.uv2); }
    float scalar(size_t i) const { return material_.parameters[i].scalar(at_.uv, at_.uv2); }
    Color base_color(size_t i) const { return material_.vertex_colors ? color(i) * at_.vertex_color : color(i); }
    float alpha(size_t i) const { return std::min(scalar(i), 1.0f); }
    Distribution distribution() const { return material_.beckmann ? Distribution::beckmann : Distribution::ggx; }
    Masking masking() const { return material_.correlated ? Masking::correlated : Masking::separable; }

  private:
    const Material& material_;
    const SurfaceCoordinates& at_;
};

Bsdf metal_or_plastic(const Material& m, const Reader& read) {
    constexpr auto at = [](std::string_view name) consteval {
        return parameter(MaterialKind::metallic_roughness, name);
    };
    MetallicRoughness p;
    p.base_color = read.base_color(at("base_color"));
    p.metallic = clamp(read.scalar(at("metallic")), 0, 1);
    p.alpha = read.alpha(at("roughness"));
    p.ior = read.scalar(at("ior"));
    p.specular = read.scalar(at("specular"));
    p.specular_color = read.color(at("specular_color"));
    p.transmission = clamp(read.scalar(at("transmission")), 0, 1);
    p.diffuse_transmission = clamp(read.scalar(at("diffuse_transmission")), 0, 1);
    p.diffuse_transmission_color = min(read.color(at("diffuse_transmission_color")), Color(1));
    p.thin = m.thin_walled;
    return make_metallic_roughness(p);
}

/// Returns the greatest number of lobes that a point of a material may need.
int lobe_bound(MaterialKind kind) {
    switch (kind) {
        case MaterialKind::phong:
        case MaterialKind::ward:
        case MaterialKind::translucent:
        case MaterialKind::plastic: return 2;
        case MaterialKind::metallic_roughness: return 3;
        case MaterialKind::blend: return 0;  // its children's
        default: return 1;
    }
}

}  // namespace

void Material::prepare(const std::vector<Material>& materials) {
    if (kind == MaterialKind::dielectric || kind == MaterialKind::thin_dielectric) transmits = true;
    if (kind == MaterialKind::metallic_roughness)
        transmits = !is_black(parameters[parameter(MaterialKind::metallic_roughness, "transmission")].constant);
    pane =
        kind == MaterialKind::thin_dielectric || (kind == MaterialKind::metallic_roughness && transmits && thin_walled);
    refracts =
        kind == MaterialKind::dielectric || (kind == MaterialKind::metallic_roughness && transmits && !thin_walled);
    lobes = lobe_bound(kind);
    if (kind == MaterialKind::translucent) transmits = true;
    if (kind == MaterialKind::metallic_roughness &&
        !is_black(parameters[parameter(MaterialKind::metallic_roughness, "diffuse_transmission")].constant)) {
        transmits = true;
        ++lobes;
    }
    for (int child : children)
        if (child >= 0) {
            transmits |= materials[child].transmits;
            refracts |= materials[child].refracts;
            pane |= materials[child].pane;
            lobes += materials[child].lobes;
        }
    require(kind != MaterialKind::measured || table != nullptr, "measured material: expected a table, got none");
    require(lobes <= Bsdf::capacity, "blend: expected materials with at most " + std::to_string(Bsdf::capacity) +
                                         " lobes, got " + std::to_string(lobes) + ": blend fewer materials");
    if (kind == MaterialKind::plastic)
        coat = make_plastic_table(parameters[parameter(MaterialKind::plastic, "ior")].constant.r,
                                  std::min(parameters[parameter(MaterialKind::plastic, "alpha_u")].constant.r, 1.0f),
                                  beckmann ? Distribution::beckmann : Distribution::ggx);
}

Bsdf make_bsdf(const std::vector<Material>& materials, int index, const SurfaceCoordinates& at, bool from_behind) {
    using enum MaterialKind;
    const Material* m = &materials[index];
    if (from_behind && m->two_sided && m->back >= 0) m = &materials[m->back];
    if (from_behind && m->has_no_back()) return {};
    const Reader read(*m, at);
    switch (m->kind) {
        case diffuse: return make_diffuse(read.base_color(parameter(diffuse, "reflectance")));
        case phong:
            return make_phong(read.base_color(parameter(phong, "diffuse_reflectance")),
                              read.color(parameter(phong, "specular_reflectance")),
                              read.scalar(parameter(phong, "exponent")));
        case ward:
            return make_ward(read.base_color(parameter(ward, "diffuse_reflectance")),
                             read.color(parameter(ward, "specular_reflectance")),
                             read.scalar(parameter(ward, "alpha_u")), read.scalar(parameter(ward, "alpha_v")));
        case conductor:
            return make_conductor(read.color(parameter(conductor, "eta")), read.color(parameter(conductor, "k")),
                                  read.color(parameter(conductor, "specular_reflectance")),
                                  read.alpha(parameter(conductor, "alpha_u")),
                                  read.alpha(parameter(conductor, "alpha_v")), read.distribution(), read.masking());
        case dielectric:
            return make_dielectric(
                read.scalar(parameter(dielectric, "ior")), read.alpha(parameter(dielectric, "alpha_u")),
                read.alpha(parameter(dielectric, "alpha_v")), read.color(parameter(dielectric, "specular_reflectance")),
                read.color(parameter(dielectric, "specular_transmittance")), read.distribution());
        case thin_dielectric:
            return make_thin_dielectric(read.scalar(parameter(thin_dielectric, "ior")),
                                        read.color(parameter(thin_dielectric, "specular_reflectance")),
                                        read.color(parameter(thin_dielectric, "specular_transmittance")));
        case plastic:
            return make_plastic(m->coat, read.base_color(parameter(plastic, "diffuse_reflectance")),
                                read.color(parameter(plastic, "specular_reflectance")), read.distribution(),
                                m->nonlinear);
        case metallic_roughness: return metal_or_plastic(*m, read);
        case translucent:
            return make_translucent(read.base_color(parameter(translucent, "reflectance")),
                                    read.base_color(parameter(translucent, "transmittance")));
        case measured: return make_measured(*m->table, read.color(parameter(measured, "scale")));
        case blend: break;
    }
    const float weight = clamp(read.scalar(parameter(blend, "weight")), 0, 1);
    Bsdf bsdf;
    bsdf.append(make_bsdf(materials, m->children[0], at, from_behind), 1 - weight);
    bsdf.append(make_bsdf(materials, m->children[1], at, from_behind), weight);
    return bsdf;
}

float opacity_at(const Material& material, const SurfaceCoordinates& at) {
    float opacity = material.opacity.scalar(at.uv, at.uv2);
    if (material.vertex_colors) opacity *= at.vertex_alpha;
    if (material.alpha_cutoff >= 0) return opacity < material.alpha_cutoff ? 0.0f : 1.0f;
    return clamp(opacity, 0, 1);
}

}  // namespace eclat
