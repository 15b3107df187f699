// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "tables/brdf_table.h"

#include "base/parallel.h"
#include "harmonics/quadrature.h"

namespace eclat {

namespace {

/// f · cos of facets for F0 = 1, and for the F0 of common dielectrics: between them lie the shapes of all lobes.
constexpr double dielectric_f0 = 0.04;

struct Integrals {
    std::vector<double> coefficients;  // term after term, all n² of the basis
    double white = 0, dielectric = 0;  // ∫ (f cos)²
};

/// All integrals over wi with `count` heights and 2 `count` azimuths.
Integrals integrate(const TableLobe& lobe, Vec3 wo, Basis basis, int order, int count) {
    const size_t terms = size_t(lobe.terms()), n = size_t(order), all = n * n;
    Integrals out;
    out.coefficients.resize(terms * all);
    // If the lobe is symmetric in φ, half of the azimuths suffice.
    const int azimuths = lobe.isotropic() ? count : 2 * count;
    const double step = pi_double / count, weight = lobe.isotropic() ? 2 * step : step;
    std::vector<double> cosines(size_t(azimuths) * n), sines(cosines.size());
    for (int k = 0; k < azimuths; ++k)
        for (size_t m = 0; m < n; ++m) {
            cosines[size_t(k) * n + m] = std::cos(double(m) * step * (k + 0.5));
            sines[size_t(k) * n + m] = lobe.isotropic() ? 0 : std::sin(double(m) * step * (k + 0.5));
        }
    std::vector<double> with_cos(terms * n), with_sin(terms * n), P(size_t(polar_count(order)));
    std::array<double, fresnel_terms> f{};
    for (const QuadratureNode& height : hemisphere_heights(count)) {
        std::fill(with_cos.begin(), with_cos.end(), 0.0);
        std::fill(with_sin.begin(), with_sin.end(), 0.0);
        const double sine = std::sqrt(1 - height.x * height.x);
        for (size_t k = 0; k < size_t(azimuths); ++k) {
            const double phi = step * (double(k) + 0.5);
            lobe.eval(wo, {float(sine * std::cos(phi)), float(sine * std::sin(phi)), float(height.x)}, f.data());
            const double white = terms == 1 ? f[0] : f[0] + f[1];
            const double dielectric = terms == 1 ? f[0] : dielectric_f0 * f[0] + f[1];
            out.white += height.weight * weight * white * white;
            out.dielectric += height.weight * weight * dielectric * dielectric;
            for (size_t t = 0; t < terms; ++t)
                for (size_t m = 0; m < n; ++m) {
                    with_cos[t * n + m] += f[t] * cosines[k * n + m];
                    with_sin[t * n + m] += f[t] * sines[k * n + m];
                }
        }
        if (basis == Basis::hemispherical)
            hemispherical_legendre(order, height.x, P.data());
        else
            legendre(order, height.x, sine, P.data());
        for (size_t t = 0; t < terms; ++t)
            for (int l = 0; l < order; ++l)
                for (int m = 0; m <= l; ++m) {
                    const double p = height.weight * weight * P[size_t(polar_index(l, m))];
                    double* c = out.coefficients.data() + t * all;
                    c[coefficient_index(l, m)] += p * with_cos[t * n + size_t(m)];
                    if (m > 0) c[coefficient_index(l, -m)] += p * with_sin[t * n + size_t(m)];
                }
    }
    return out;
}

/// Coefficients for the reflectance F0 = f0, F90 = 1.
std::vector<double> combined(const Integrals& integrals, size_t count, double f0) {
    std::vector<double> out(integrals.coefficients.begin(), integrals.coefficients.begin() + long(count));
    if (integrals.coefficients.size() > count)
        for (size_t i = 0; i < count; ++i) out[i] = f0 * out[i] + integrals.coefficients[count + i];
    return out;
}

bool converged(const Integrals& before, const Integrals& now) {
    double change = 0, norm = 0;
    for (size_t i = 0; i < now.coefficients.size(); ++i) {
        const double d = now.coefficients[i] - before.coefficients[i];
        change += d * d;
        norm += now.coefficients[i] * now.coefficients[i];
    }
    const double tolerance = BrdfTable::quadrature_tolerance;
    return change <= tolerance * tolerance * norm && std::fabs(now.white - before.white) <= tolerance * now.white;
}

/// e_n for n = 1 … order.
std::vector<double> errors_by_order(const std::vector<double>& c, double energy, int order, const HemisphereFit* fit) {
    std::vector<double> captured(static_cast<size_t>(order));
    if (fit)
        captured = fit->energies(c);
    else
        for (int l = 0; l < order; ++l) {
            captured[size_t(l)] = l > 0 ? captured[size_t(l) - 1] : 0;
            for (int i = l * l; i < (l + 1) * (l + 1); ++i) captured[size_t(l)] += c[size_t(i)] * c[size_t(i)];
        }
    for (double& e : captured) e = energy > 0 ? std::sqrt(std::max(0.0, 1 - e / energy)) : 0;
    return captured;
}

}  // namespace

void TableLobe::eval(Vec3 wo, Vec3 wi, double* out) const {
    const auto single = [&](const EvalPdf& e) { out[0] = double(e.f.r) * double(wi.z); };
    switch (kind) {
        case Kind::lambert: single(LambertLobe{}.eval(wo, wi)); return;
        case Kind::phong: single(PhongLobe{u}.eval(wo, wi)); return;
        case Kind::ward: single(WardLobe{u, v}.eval(wo, wi)); return;
        default: break;
    }
    const Microfacets facets(u, v, kind == Kind::ggx ? Distribution::ggx : Distribution::beckmann, masking);
    const Vec3 m = normalize(wo + wi);
    const double white = double(facets.density(m)) * double(facets.visibility(wo, wi)) * double(wi.z);
    const std::array<float, fresnel_terms> fresnel = fresnel_term_values(dot(wo, m));
    for (size_t t = 0; t < fresnel_terms; ++t) out[t] = white * double(fresnel[t]);
}

BrdfTable::BrdfTable(std::vector<TableLobe> lobes, const BrdfTableOptions& options, Progress& progress)
    : lobes_(std::move(lobes)), options_(options), isotropic_(!lobes_.empty() && lobes_.front().isotropic()) {
    check();
    const size_t count = lobes_.size() * grid_.directions();
    nodes_.orders.resize(count);
    nodes_.errors.resize(count);
    nodes_.coefficients.resize(count * size_t(terms() * count_per_term()));
    progress.begin(count);
    parallel_for(count, options_.threads, [&](size_t i) {
        progress.check();
        make_node(i);
        progress.advance();
    });
}

BrdfTable::BrdfTable(std::vector<TableLobe> lobes, const BrdfTableOptions& options, Nodes nodes)
    : lobes_(std::move(lobes)),
      options_(options),
      isotropic_(!lobes_.empty() && lobes_.front().isotropic()),
      nodes_(std::move(nodes)) {
    check();
    const size_t count = lobes_.size() * grid_.directions();
    require(nodes_.orders.size() == count && nodes_.errors.size() == count &&
                nodes_.coefficients.size() == count * size_t(terms() * count_per_term()),
            "BRDF table: expected arrays for these lobes, this order and this resolution, got arrays of other sizes");
    for (const uint8_t order : nodes_.orders)
        require(order <= options_.order, "BRDF table: expected orders of at most " + std::to_string(options_.order) +
                                             ", got " + std::to_string(order));
}

void BrdfTable::check() {
    require(!lobes_.empty(), "BRDF table: expected at least one lobe, got none");
    require(options_.order >= 1 && options_.order <= BrdfTableOptions::max_order,
            "order must be in [1, 12], got " + std::to_string(options_.order));
    require(options_.resolution >= 2, "resolution must be at least 2, got " + std::to_string(options_.resolution));
    for (size_t i = 1; i < lobes_.size(); ++i)
        require(lobes_[i].kind == lobes_[0].kind && lobes_[i].isotropic() && lobes_[0].isotropic() &&
                    lobes_[i].u > lobes_[i - 1].u,
                "BRDF table: expected isotropic lobes of one kind with increasing roughness, got others");
    std::vector<float> alphas;
    for (const TableLobe& lobe : lobes_) alphas.push_back(lobe.u);
    grid_ = TableGrid(options_.resolution, isotropic_, alphas);
    if (options_.basis == Basis::spherical) fit_ = std::make_shared<const HemisphereFit>(options_.order);
}

/// wo of a node: back from the paraboloid map; outside its disc, where only the corners of cells at the rim lie, the
/// nearest direction of the rim. At the horizon itself there is nothing to see.
Vec3 BrdfTable::direction(size_t i) const {
    const size_t n = size_t(options_.resolution);
    float x = float(i % n) / float(n - 1), y = isotropic_ ? 0 : float(i / n) / float(n - 1);
    constexpr float rim = 0.9995f;  // cosθ = 5e-4
    const float r = std::sqrt(x * x + y * y);
    if (r > rim) x *= rim / r, y *= rim / r;
    const float r2 = x * x + y * y;
    return {2 * x / (1 + r2), 2 * y / (1 + r2), (1 - r2) / (1 + r2)};
}

void BrdfTable::make_node(size_t i) {
    const TableLobe& lobe = lobes_[i / grid_.directions()];
    const Vec3 wo = direction(i % grid_.directions());
    const int order = options_.order;
    const size_t count = size_t(coefficient_count(order));

    // The steps are halved until the result no longer changes.
    constexpr int coarsest = 16, finest = 256;
    Integrals before = integrate(lobe, wo, options_.basis, order, coarsest), now = before;
    bool done = false;
    for (int steps = 2 * coarsest; steps <= finest && !done; steps *= 2) {
        now = integrate(lobe, wo, options_.basis, order, steps);
        done = converged(before, now);
        std::swap(before, now);
    }
    const Integrals& result = before;

    // This is the smallest order that suffices for metals and dielectrics. A lobe that the quadrature does not resolve
    // is not resolved by any order.
    const auto white = errors_by_order(combined(result, count, 1), result.white, order, fit_.get());
    const auto dielectric =
        errors_by_order(combined(result, count, dielectric_f0), result.dielectric, order, fit_.get());
    nodes_.errors[i] = done ? float(white.back()) : 1;
    nodes_.orders[i] = done && !options_.adaptive ? uint8_t(order) : 0;
    for (int n = order; options_.adaptive && done && n >= 1; --n)
        if (std::max(white[size_t(n) - 1], dielectric[size_t(n) - 1]) <= options_.max_error)
            nodes_.orders[i] = uint8_t(n);

    float* out = nodes_.coefficients.data() + i * size_t(terms() * count_per_term());
    for (size_t t = 0; t < size_t(terms()); ++t) {
        const double* c = result.coefficients.data() + t * count;
        for (int l = 0; l < order; ++l)
            for (int m = isotropic_ ? 0 : -l; m <= l; ++m) *out++ = float(c[coefficient_index(l, m)]);
    }
}

/// From the table's azimuth or quadrant to that of `wo`.
void BrdfTable::turn_to(Vec3 wo, std::span<double> coefficients) const {
    if (isotropic_) return rotate_about_z(options_.order, std::atan2(double(wo.y), double(wo.x)), coefficients);
    for (int l = 1; l < options_.order; ++l)
        for (int m = 1; m <= l; ++m) {
            // φ → π − φ and φ → −φ.
            const double x = wo.x < 0 && m % 2 == 1 ? -1 : 1;
            coefficients[size_t(coefficient_index(l, m))] *= x;
            coefficients[size_t(coefficient_index(l, -m))] *= x * (wo.x < 0 ? -1 : 1) * (wo.y < 0 ? -1 : 1);
        }
}

float BrdfTable::error(Vec3 wo, float alpha) const {
    const TableCorners around = grid_.around(wo, alpha);
    float sum = 0;
    for (const TableCorner& corner : around) sum += corner.weight * nodes_.errors[corner.node];
    return around.empty() ? 1 : sum;
}

int BrdfTable::lookup(Vec3 wo, float alpha, std::span<float> out) const {
    if (!(wo.z > 0)) return 0;
    const TableCorners around = grid_.around(wo, alpha);
    int order = 0;
    for (const TableCorner& corner : around) {
        if (corner.weight == 0) continue;
        if (nodes_.orders[corner.node] == 0) return 0;
        order = std::max(order, int(nodes_.orders[corner.node]));
    }
    const int stored = count_per_term();
    std::vector<double> c(size_t(coefficient_count(options_.order)));
    for (int t = 0; t < terms(); ++t) {
        std::fill(c.begin(), c.end(), 0.0);
        for (const TableCorner& corner : around) {
            const float* node =
                nodes_.coefficients.data() + (corner.node * size_t(terms()) + size_t(t)) * size_t(stored);
            for (int l = 0; l < order; ++l)
                for (int m = isotropic_ ? 0 : -l; m <= l; ++m)
                    c[size_t(coefficient_index(l, m))] +=
                        double(corner.weight) * double(node[isotropic_ ? polar_index(l, m) : coefficient_index(l, m)]);
        }
        turn_to(wo, c);
        if (fit_) fit_->fit(order, c);
        for (int i = 0; i < coefficient_count(order); ++i)
            out[size_t(t * coefficient_count(order) + i)] = float(c[size_t(i)]);
    }
    return order;
}

}  // namespace eclat
