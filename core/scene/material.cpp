// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "scene/material.h"

namespace eclat {

namespace {

// Below this α a microfacet surface is drawn as a perfect mirror: its lobe is narrower than float directions resolve.
constexpr float smooth_alpha = 1e-3f;

class Reader {
  public:
    Reader(const Material& material, const SurfaceCoordinates& at) : material_(material), at_(at) {}
    Color color(int i) const { return material_.parameters[i].color(at_.uv, at_.uv2); }
    float scalar(int i) const { return material_.parameters[i].scalar(at_.uv, at_.uv2); }
    Color base_color(int i) const { return material_.vertex_colors ? color(i) * at_.vertex_color : color(i); }
    Microfacets facets(int u, int v) const {
        const float ax = std::min(scalar(u), 1.0f), ay = v < 0 ? ax : std::min(scalar(v), 1.0f);
        if (std::max(ax, ay) < smooth_alpha) return {0, 0, material_.beckmann};
        return {std::max(ax, smooth_alpha), std::max(ay, smooth_alpha), material_.beckmann};
    }

  private:
    const Material& material_;
    const SurfaceCoordinates& at_;
};

Lobe lambert(Color reflectance) {
    Lobe lobe;
    lobe.color = reflectance;
    return lobe;
}

void add_plastic(Bsdf& bsdf, const Material& m, const Reader& read) {
    Lobe base, coat;
    const Color albedo = read.base_color(0);
    base.kind = Lobe::Kind::coated_diffuse;
    base.ior = coat.ior = read.scalar(2);
    base.coat_reflectance = m.external_reflectance;
    // What the base scatters and the coat sends back inside, summed over all bounces.
    const Color bounces = m.nonlinear ? albedo * m.internal_reflectance : Color(m.internal_reflectance);
    base.color = albedo / (Color(1) - bounces) * (1 / sqr(base.ior));
    coat.kind = Lobe::Kind::reflection;
    coat.fresnel = Lobe::Fresnel::dielectric;
    coat.color = read.color(1);
    coat.facets = read.facets(3, -1);
    bsdf.add(base);
    bsdf.add(coat);
}

void add_metallic_roughness(Bsdf& bsdf, const Material& m, const Reader& read) {
    const Color base_color = read.base_color(0);
    const float metallic = clamp(read.scalar(1), 0, 1), ior = read.scalar(3);
    const float transmission = clamp(read.scalar(6), 0, 1) * (1 - metallic);
    const float f0 = sqr((ior - 1) / (ior + 1)), specular = read.scalar(4);
    const Microfacets facets = read.facets(2, -1);

    // The dielectric's diffuse base lies under its interface: light enters and leaves through it, so that together
    // they reflect at most what arrives, and reciprocally.
    Lobe diffuse;
    diffuse.kind = Lobe::Kind::coated_diffuse;
    diffuse.ior = ior;
    diffuse.coat_reflectance = m.external_reflectance;
    diffuse.color = base_color * ((1 - metallic - transmission) / std::max(1e-4f, 1 - m.external_reflectance));
    bsdf.add(diffuse);

    Lobe interface;
    interface.kind = Lobe::Kind::reflection;
    interface.fresnel = Lobe::Fresnel::schlick;
    interface.facets = facets;
    const Color dielectric_f0 = min(read.color(5) * f0, Color(1)) * specular;
    interface.eta = dielectric_f0 * (1 - metallic) + base_color * metallic;
    interface.k = Color(specular * (1 - metallic) + metallic);
    interface.color = Color(1 - transmission);
    bsdf.add(interface);

    if (transmission > 0) {
        Lobe through;
        through.kind = m.thin_walled ? Lobe::Kind::thin : Lobe::Kind::refraction;
        through.facets = facets;
        through.ior = ior;
        through.color = Color(transmission);
        through.transmittance = base_color * transmission;
        bsdf.add(through);
    }
}

}  // namespace

void Material::prepare(const std::vector<Material>& materials) {
    if (kind == MaterialKind::dielectric || kind == MaterialKind::thin_dielectric) transmits = true;
    if (kind == MaterialKind::metallic_roughness) transmits = !is_black(parameters[6].constant);
    refracts = kind == MaterialKind::dielectric || (kind == MaterialKind::metallic_roughness && transmits && !thin_walled);
    for (int child : children)
        if (child >= 0) {
            transmits |= materials[child].transmits;
            refracts |= materials[child].refracts;
        }
    if (kind != MaterialKind::plastic && kind != MaterialKind::metallic_roughness) return;
    const float ior = parameters[kind == MaterialKind::plastic ? 2 : 3].constant.r;
    external_reflectance = fresnel_diffuse_reflectance(ior);
    // From inside nearly all that the diffuse base sends beyond the critical angle returns; both directions pass the
    // same power, which ties the two reflectances: 1 − F_in = (1 − F_out) / ior² [Egan79].
    internal_reflectance = 1 - (1 - external_reflectance) / sqr(ior);
}

Bsdf make_bsdf(const std::vector<Material>& materials, int index, const SurfaceCoordinates& at, bool from_behind) {
    const Material* m = &materials[index];
    Bsdf bsdf;
    if (from_behind && m->two_sided && m->back >= 0) m = &materials[m->back];
    if (from_behind && !m->two_sided && !m->transmits) return bsdf;
    const Reader read(*m, at);
    Lobe lobe;
    switch (m->kind) {
        case MaterialKind::diffuse: bsdf.add(lambert(read.base_color(0))); break;
        case MaterialKind::phong:
            bsdf.add(lambert(read.base_color(0)));
            lobe.kind = Lobe::Kind::phong;
            lobe.color = read.color(1);
            lobe.exponent = std::max(0.0f, read.scalar(2));
            bsdf.add(lobe);
            break;
        case MaterialKind::ward:
            bsdf.add(lambert(read.base_color(0)));
            lobe.kind = Lobe::Kind::ward;
            lobe.color = read.color(1);
            lobe.facets = {std::max(smooth_alpha, read.scalar(2)), std::max(smooth_alpha, read.scalar(3)), true};
            bsdf.add(lobe);
            break;
        case MaterialKind::conductor:
            lobe.kind = Lobe::Kind::reflection;
            lobe.eta = read.color(0);
            lobe.k = read.color(1);
            lobe.color = read.color(2);
            lobe.facets = read.facets(3, 4);
            bsdf.add(lobe);
            break;
        case MaterialKind::dielectric:
        case MaterialKind::thin_dielectric:
            lobe.kind = m->kind == MaterialKind::dielectric ? Lobe::Kind::refraction : Lobe::Kind::thin;
            lobe.color = read.color(0);
            lobe.transmittance = read.color(1);
            lobe.ior = read.scalar(2);
            if (m->kind == MaterialKind::dielectric) lobe.facets = read.facets(3, 4);
            bsdf.add(lobe);
            break;
        case MaterialKind::plastic: add_plastic(bsdf, *m, read); break;
        case MaterialKind::metallic_roughness: add_metallic_roughness(bsdf, *m, read); break;
        case MaterialKind::blend: {
            const float weight = clamp(read.scalar(0), 0, 1);
            bsdf.append(make_bsdf(materials, m->children[0], at, from_behind), 1 - weight);
            bsdf.append(make_bsdf(materials, m->children[1], at, from_behind), weight);
            break;
        }
    }
    return bsdf;
}

float opacity_at(const Material& material, const SurfaceCoordinates& at) {
    float opacity = material.opacity.scalar(at.uv, at.uv2);
    if (material.vertex_colors) opacity *= at.vertex_alpha;
    if (material.alpha_cutoff >= 0) return opacity < material.alpha_cutoff ? 0.0f : 1.0f;
    return clamp(opacity, 0, 1);
}

}  // namespace eclat
