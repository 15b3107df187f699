// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "tables/radiance_tables.h"

#include <algorithm>

#include "harmonics/quadrature.h"

namespace eclat {

namespace {

/// The lobe of a table for a lobe of a BSDF; false where there is none, by kind.
bool table_lobe(const Lobe& lobe, TableLobe& out) {
    if (const auto* phong = std::get_if<PhongLobe>(&lobe)) {
        out = {TableLobe::Kind::phong, phong->exponent, phong->exponent};
        return true;
    }
    if (const auto* ward = std::get_if<WardLobe>(&lobe)) {
        out = {TableLobe::Kind::ward, ward->alpha_u, ward->alpha_v};
        return true;
    }
    const auto* rough = std::get_if<RoughReflectionLobe>(&lobe);
    if (!rough || rough->through) return false;
    const Microfacets& f = rough->facets;
    const auto kind = f.distribution == Distribution::ggx ? TableLobe::Kind::ggx : TableLobe::Kind::beckmann;
    out = {kind, f.alpha_u, f.alpha_v, f.masking};
    return true;
}

bool same(const TableLobe& a, const TableLobe& b) {
    return a.kind == b.kind && a.u == b.u && a.v == b.v && a.masking == b.masking;
}

bool same(const InterfaceReflectance& a, const InterfaceReflectance& b) {
    const auto equal = [](Color x, Color y) { return x.r == y.r && x.g == y.g && x.b == y.b; };
    return a.kind == b.kind && equal(a.a, b.a) && equal(a.b, b.b);
}

// Narrower than this no order up to 12 follows a lobe anywhere but at steep views; tables need not be made.
constexpr float least_alpha = 0.1f, largest_exponent = 60;

bool wide_enough(const TableLobe& lobe) {
    if (lobe.kind == TableLobe::Kind::phong) return lobe.u <= largest_exponent;
    return std::min(lobe.u, lobe.v) >= least_alpha;
}

/// Whether the exponent or roughness of a material is the same everywhere.
bool constant_shape(const Material& material) {
    using enum MaterialKind;
    const auto constant = [&](std::initializer_list<size_t> parameters) {
        return std::all_of(parameters.begin(), parameters.end(),
                           [&](size_t i) { return material.parameters[i].is_constant(); });
    };
    switch (material.kind) {
        case phong: return constant({parameter(phong, "exponent")});
        case metallic_roughness: return constant({parameter(metallic_roughness, "roughness")});
        case ward: return constant({parameter(ward, "alpha_u"), parameter(ward, "alpha_v")});
        case conductor: return constant({parameter(conductor, "alpha_u"), parameter(conductor, "alpha_v")});
        default: return true;
    }
}

template <class F>
void for_each_lobe(const std::vector<Material>& materials, const F& f) {
    for (size_t i = 0; i < materials.size(); ++i) {
        if (materials[i].kind == MaterialKind::blend) continue;  // its children come by themselves
        const Bsdf bsdf = make_bsdf(materials, int(i), {}, false);
        for (int k = 0; k < bsdf.count(); ++k) f(materials[i], bsdf.lobe(k));
    }
}

}  // namespace

LobeTable::LobeTable(const BrdfTable& table, const HemisphereFit& fit)
    : lobes_(table.lobes()),
      grid_(table.grid()),
      order_(table.order()),
      terms_(table.terms()),
      count_(size_t(table.count_per_term())),
      orders_(table.nodes().orders),
      coefficients_(table.nodes().coefficients) {
    const size_t all = size_t(coefficient_count(order_));
    std::vector<double> c(all), uniform(all);
    // ∫ Y_l^0 over the hemisphere, from that of P.
    for (const QuadratureNode& node : gauss_legendre(order_ + 4)) {
        std::vector<double> P(size_t(polar_count(order_)));
        legendre(order_, node.x, std::sqrt(1 - node.x * node.x), P.data());
        for (int l = 0; l < order_; ++l)
            uniform[size_t(coefficient_index(l, 0))] += 2 * pi_double * node.weight * P[size_t(polar_index(l, 0))];
    }
    fit.orthonormalize(order_, uniform);
    const bool isotropic = grid_.isotropic();
    for (size_t i = 0; i < orders_.size(); ++i) {
        double energy = 0, albedo = 0;
        for (size_t t = 0; t < size_t(terms_); ++t) {
            float* node = coefficients_.data() + (i * size_t(terms_) + t) * count_;
            const auto place = [&](int l, int m) { return isotropic ? polar_index(l, m) : coefficient_index(l, m); };
            for (int l = 0; l < order_; ++l)
                for (int m = -l; m <= l; ++m)
                    c[size_t(coefficient_index(l, m))] = isotropic && m < 0 ? 0 : double(node[size_t(place(l, m))]);
            fit.orthonormalize(order_, c);
            for (int l = 0; l < order_; ++l)
                for (int m = isotropic ? 0 : -l; m <= l; ++m)
                    node[size_t(place(l, m))] = float(c[size_t(coefficient_index(l, m))]);
            // The dip in the reflectance of metals has little effect on the width of a lobe.
            if (t > 1) continue;
            for (size_t k = 0; k < all; ++k) {
                energy += c[k] * c[k];
                albedo += c[k] * uniform[k];
            }
        }
        const double lambertian = 1.5 * pi_double;
        widths_.push_back(float(energy > 0 ? std::sqrt(albedo * albedo / energy / lambertian) : 0));
    }
    shares_ = shares_of_nodes();
}

// The share increases with the number of nodes between this one and the nearest node that is not cached.
std::vector<float> LobeTable::shares_of_nodes() const {
    constexpr int ramp = 4;
    const auto directions = static_cast<int>(grid_.directions());
    const int rows = grid_.isotropic() ? 1 : static_cast<int>(std::lround(std::sqrt(float(directions))));
    const int columns = directions / rows;
    std::vector<float> out(orders_.size());
    for (size_t i = 0; i < out.size(); ++i) {
        const int lobe = static_cast<int>(i) / directions, at = static_cast<int>(i) % directions;
        int nearest = ramp;
        for (int dy = -ramp; dy <= ramp; ++dy)
            for (int dx = -ramp; dx <= ramp; ++dx) {
                const int y = at / columns + dy, x = at % columns + dx;
                if (y < 0 || y >= rows || x < 0 || x >= columns) continue;
                if (orders_[size_t(lobe * directions + y * columns + x)] == 0)
                    nearest = std::min(nearest, std::max(std::abs(dx), std::abs(dy)));
            }
        out[i] = static_cast<float>(nearest) / ramp;
    }
    return out;
}

float LobeTable::share(Vec3 wo, float alpha) const {
    float sum = 0;
    for (const TableCorner& corner : grid_.around(wo, alpha)) sum += corner.weight * shares_[corner.node];
    return sum;
}

void LobeTable::add(Vec3 wo, float alpha, float share, const Color* colors, ReflectedFactors& out) const {
    const TableCorners around = grid_.around(wo, alpha);
    // The sufficient order decides whether the lobe is cached; all coefficients of the table are used for the
    // reflection.
    const int order = order_;
    float width = 0;
    for (const TableCorner& corner : around) width += corner.weight * widths_[corner.node];
    const bool isotropic = grid_.isotropic();
    const auto needed = size_t(isotropic ? polar_count(order) : coefficient_count(order));
    const auto all = size_t(coefficient_count(order));
    for (size_t channel = 0; channel < (out.grey ? 1 : 3); ++channel) {
        std::array<float, max_radiance_coefficients> c{};
        for (size_t t = 0; t < size_t(terms_); ++t) {
            const float color = share * colors[t][int(channel)];
            if (color == 0) continue;
            for (const TableCorner& corner : around) {
                const float scale = color * corner.weight;
                const float* node = coefficients_.data() + (corner.node * size_t(terms_) + t) * count_;
                for (size_t i = 0; i < needed; ++i) c[i] += scale * node[i];
            }
        }
        std::array<float, max_radiance_coefficients> turned;
        if (isotropic) {
            // From azimuth 0 to that of wo, by multiples of its angle.
            const float length = std::sqrt(wo.x * wo.x + wo.y * wo.y);
            const float re = length > 0 ? wo.x / length : 1, im = length > 0 ? wo.y / length : 0;
            float cosine = 1, sine = 0;
            for (int m = 0; m < order; ++m) {
                for (int l = m; l < order; ++l) {
                    const float p = c[size_t(polar_index(l, m))];
                    turned[size_t(coefficient_index(l, m))] = p * cosine;
                    if (m > 0) turned[size_t(coefficient_index(l, -m))] = p * sine;
                }
                const float next = cosine * re - sine * im;
                sine = cosine * im + sine * re;
                cosine = next;
            }
        } else {
            // φ → π − φ and φ → −φ, from the quadrant of the table to that of wo.
            turned = c;
            for (int l = 1; l < order; ++l)
                for (int m = 1; m <= l; ++m) {
                    const float x = wo.x < 0 && m % 2 == 1 ? -1.0f : 1.0f;
                    turned[size_t(coefficient_index(l, m))] *= x;
                    turned[size_t(coefficient_index(l, -m))] *=
                        x * (wo.x < 0 ? -1.0f : 1.0f) * (wo.y < 0 ? -1.0f : 1.0f);
                }
        }
        std::array<float, max_radiance_coefficients>& sum = out.factors[channel];
        for (auto i = size_t(coefficient_count(out.order)); i < all; ++i) sum[i] = 0;
        for (size_t i = 0; i < all; ++i) sum[i] += turned[i];
    }
    out.order = std::max(out.order, order);
    out.width = std::min(out.width, width);
}

RadianceTables::Wanted RadianceTables::wanted(const std::vector<Material>& materials) {
    Wanted out;
    for_each_lobe(materials, [&](const Material& material, const Lobe& lobe) {
        TableLobe key;
        if (!table_lobe(lobe, key)) return;
        if (!constant_shape(material)) {
            out.roughness = out.roughness || material.kind == MaterialKind::metallic_roughness;
            return;
        }
        if (wide_enough(key) &&
            std::none_of(out.lobes.begin(), out.lobes.end(), [&](const TableLobe& other) { return same(key, other); }))
            out.lobes.push_back(key);
    });
    return out;
}

RadianceTables::RadianceTables(const std::vector<Material>& materials, const std::vector<const BrdfTable*>& tables,
                               int order)
    : order_(order), fit_(order, radiance_tikhonov), uniform_(size_t(order)) {
    require(order >= 1 && order <= max_radiance_order, "order must be in [1, 12], got " + std::to_string(order));
    for (const BrdfTable* table : tables) {
        require(table->options().basis == Basis::spherical && table->order() == order,
                "radiance caching needs spherical tables of order " + std::to_string(order));
        tables_.emplace_back(*table, fit_);
    }
    for_each_lobe(materials, [&](const Material&, const Lobe& lobe) {
        const auto* rough = std::get_if<RoughReflectionLobe>(&lobe);
        if (!rough || rough->reflectance.kind == InterfaceReflectance::Kind::schlick) return;
        if (std::none_of(interfaces_.begin(), interfaces_.end(),
                         [&](const Interface& known) { return same(known.reflectance, rough->reflectance); }))
            interfaces_.push_back({rough->reflectance, split_fresnel(rough->reflectance)});
    });
    std::vector<double> uniform(size_t(coefficient_count(order))), P(size_t(polar_count(order)));
    for (const QuadratureNode& node : gauss_legendre(order + 4)) {
        legendre(order, node.x, std::sqrt(1 - node.x * node.x), P.data());
        for (int l = 0; l < order; ++l)
            uniform[size_t(coefficient_index(l, 0))] += 2 * pi_double * node.weight * P[size_t(polar_index(l, 0))];
    }
    fit_.orthonormalize(order, uniform);
    for (int l = 0; l < order; ++l) uniform_[size_t(l)] = float(uniform[size_t(coefficient_index(l, 0))]);
}

const LobeTable* RadianceTables::table_of(const Lobe& lobe) const {
    TableLobe key;
    if (!table_lobe(lobe, key)) return nullptr;
    for (const LobeTable& table : tables_) {
        const TableLobe& own = table.lobe();
        if (table.over_roughness() ? own.kind == key.kind && own.masking == key.masking && key.u == key.v
                                   : same(own, key))
            return &table;
    }
    return nullptr;
}

FresnelFactors RadianceTables::factors_of(const InterfaceReflectance& reflectance) const {
    for (const Interface& known : interfaces_)
        if (same(known.reflectance, reflectance)) return known.factors;
    return split_fresnel(reflectance);
}

bool RadianceTables::reflects(const Bsdf& bsdf, Vec3 wo) const {
    ReflectedFactors factors;
    reflect(bsdf, wo, factors);
    return factors.order > 0;
}

void RadianceTables::reflect(const Bsdf& bsdf, Vec3 wo, ReflectedFactors& out) const {
    out.order = 0;
    out.shares.fill(0);
    out.width = 1;
    out.grey = true;
    out.albedo = Color();
    if (!(wo.z > 0)) return;
    struct Cacheable {
        int lobe;
        const LobeTable* table;
        float alpha;
        FresnelFactors colors;
    };
    std::array<Cacheable, Bsdf::capacity> found;
    size_t count = 0;
    for (int i = 0; i < bsdf.count(); ++i) {
        const LobeTable* table = table_of(bsdf.lobe(i));
        if (!table) continue;
        Cacheable& c = found[count++];
        c = {i, table, 0, {bsdf.weight(i), Color(), Color()}};
        if (const auto* rough = std::get_if<RoughReflectionLobe>(&bsdf.lobe(i))) {
            c.alpha = rough->facets.alpha_u;
            const FresnelFactors fresnel = factors_of(rough->reflectance);
            for (size_t t = 0; t < fresnel_terms; ++t) c.colors[t] = fresnel[t] * bsdf.weight(i);
        }
        for (const Color& color : c.colors) out.grey = out.grey && color.r == color.g && color.g == color.b;
    }
    int room = Bsdf::capacity - bsdf.count();
    for (size_t k = 0; k < count; ++k) {
        float& share = out.shares[size_t(found[k].lobe)];
        share = found[k].table->share(wo, found[k].alpha);
        // The rest of a lobe becomes another lobe.
        if (share > 0 && share < 1 && room-- <= 0) share = std::round(share);
        if (share > 0) found[k].table->add(wo, found[k].alpha, share, found[k].colors.data(), out);
    }
    for (int channel = 0; channel < 3; ++channel) {
        const auto& f = out.factors[out.grey ? 0 : size_t(channel)];
        for (int l = 0; l < out.order; ++l)
            out.albedo[channel] += f[size_t(coefficient_index(l, 0))] * uniform_[size_t(l)];
    }
}

}  // namespace eclat
