// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "scene/material.h"

#include "base/error.h"

namespace eclat {

namespace {

class Reader {
  public:
    Reader(const Material& material, const SurfaceCoordinates& at) : material_(material), at_(at) {}
    Color color(int i) const { return material_.parameters[i].color(at_.uv, at_.uv2); }
    float scalar(int i) const { return material_.parameters[i].scalar(at_.uv, at_.uv2); }
    Color base_color(int i) const { return material_.vertex_colors ? color(i) * at_.vertex_color : color(i); }
    float alpha(int i) const { return std::min(scalar(i), 1.0f); }
    Distribution distribution() const { return material_.beckmann ? Distribution::beckmann : Distribution::ggx; }

  private:
    const Material& material_;
    const SurfaceCoordinates& at_;
};

Bsdf metallic_roughness(const Material& m, const Reader& read) {
    MetallicRoughness p;
    p.base_color = read.base_color(0);
    p.metallic = clamp(read.scalar(1), 0, 1);
    p.alpha = read.alpha(2);
    p.ior = read.scalar(3);
    p.specular = read.scalar(4);
    p.specular_color = read.color(5);
    p.transmission = clamp(read.scalar(6), 0, 1);
    p.thin = m.thin_walled;
    return make_metallic_roughness(p);
}

/// The most lobes that one point of a material may need.
int lobe_bound(MaterialKind kind) {
    switch (kind) {
        case MaterialKind::phong:
        case MaterialKind::ward:
        case MaterialKind::plastic: return 2;
        case MaterialKind::metallic_roughness: return 3;
        case MaterialKind::blend: return 0;  // its children's
        default: return 1;
    }
}

}  // namespace

void Material::prepare(const std::vector<Material>& materials) {
    if (kind == MaterialKind::dielectric || kind == MaterialKind::thin_dielectric) transmits = true;
    if (kind == MaterialKind::metallic_roughness) transmits = !is_black(parameters[6].constant);
    refracts =
        kind == MaterialKind::dielectric || (kind == MaterialKind::metallic_roughness && transmits && !thin_walled);
    lobes = lobe_bound(kind);
    for (int child : children)
        if (child >= 0) {
            transmits |= materials[child].transmits;
            refracts |= materials[child].refracts;
            lobes += materials[child].lobes;
        }
    require(lobes <= Bsdf::capacity, "a blend of materials has " + std::to_string(lobes) + " lobes; at most " +
                                         std::to_string(Bsdf::capacity) + " are supported: blend fewer materials");
    if (kind == MaterialKind::plastic)
        coat = make_plastic_table(parameters[2].constant.r, std::min(parameters[3].constant.r, 1.0f),
                                  beckmann ? Distribution::beckmann : Distribution::ggx);
}

Bsdf make_bsdf(const std::vector<Material>& materials, int index, const SurfaceCoordinates& at, bool from_behind) {
    const Material* m = &materials[index];
    if (from_behind && m->two_sided && m->back >= 0) m = &materials[m->back];
    if (from_behind && !m->two_sided && !m->transmits) return {};
    const Reader read(*m, at);
    switch (m->kind) {
        case MaterialKind::diffuse: return make_diffuse(read.base_color(0));
        case MaterialKind::phong: return make_phong(read.base_color(0), read.color(1), read.scalar(2));
        case MaterialKind::ward: return make_ward(read.base_color(0), read.color(1), read.scalar(2), read.scalar(3));
        case MaterialKind::conductor:
            return make_conductor(read.color(0), read.color(1), read.color(2), read.alpha(3), read.alpha(4),
                                  read.distribution());
        case MaterialKind::dielectric:
            return make_dielectric(read.scalar(2), read.alpha(3), read.alpha(4), read.color(0), read.color(1),
                                   read.distribution());
        case MaterialKind::thin_dielectric: return make_thin_dielectric(read.scalar(2), read.color(0), read.color(1));
        case MaterialKind::plastic:
            return make_plastic(m->coat, read.base_color(0), read.color(1), read.distribution(), m->nonlinear);
        case MaterialKind::metallic_roughness: return metallic_roughness(*m, read);
        case MaterialKind::blend: break;
    }
    const float weight = clamp(read.scalar(0), 0, 1);
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
