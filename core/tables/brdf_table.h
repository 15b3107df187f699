// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Tables, over view directions wo, of the harmonic coefficients of f · cosθ_i as a function of wi. Their dot product with the
// coefficients of incident radiance is the reflected radiance. The cosine is included here and nowhere else.
//
// References   [Krivanek05] tables on the paraboloid map with an order for each direction
//
// Symbol       name here    meaning
//   p          –            wo on the paraboloid map: (wo.x, wo.y) / (1 + wo.z), a point of the unit disc
//   e_n        error        relative L2 error ‖f cos − its sum of order n‖ / ‖f cos‖ over wi
//
// Isotropic lobes are tabulated over |p| with wo at azimuth 0, where their sin coefficients vanish; others over p in one
// quadrant, which mirrors into the rest. Where no order within the table's brings e below `max_error`, the direction has
// order 0: not to be cached. Spherical tables hold inner products, and read as least-squares fits (HemisphereFit).

#pragma once

#include <memory>
#include <span>
#include <vector>

#include "base/progress.h"
#include "bsdf/lobe.h"
#include "tables/split_fresnel.h"
#include "tables/table_grid.h"
#include "harmonics/projection.h"
#include "harmonics/rotation.h"

namespace eclat {

/// A lobe of white colour. Facets (ggx, beckmann) have a coefficient for each Fresnel term, the others one.
struct TableLobe {
    enum class Kind : uint8_t { lambert, phong, ward, ggx, beckmann };

    Kind kind = Kind::ggx;
    float u = 0.3f, v = 0.3f;  ///< Phong: the exponent is u; else α along u and v
    Masking masking = Masking::separable;

    bool has_facets() const { return kind == Kind::ggx || kind == Kind::beckmann; }
    bool isotropic() const { return kind == Kind::lambert || kind == Kind::phong || u == v; }
    int terms() const { return has_facets() ? fresnel_terms : 1; }
    /// f · wi.z for each term.
    void eval(Vec3 wo, Vec3 wi, double* out) const;
};

struct BrdfTableOptions {
    Basis basis = Basis::hemispherical;
    int order = 10;          ///< largest order, up to max_order
    double max_error = 0.2;  ///< largest e_n of a direction that is cached
    int resolution = 64;     ///< nodes over |p|, or along each side of the quadrant
    int threads = 0;
    bool adaptive = true;  ///< if false, every direction has the largest order

    static constexpr int max_order = 12;
};

class BrdfTable {
  public:
    /// Numbers per node (lobe by lobe, direction by direction).
    struct Nodes {
        std::vector<uint8_t> orders;  ///< smallest sufficient order, 0 if there is none
        std::vector<float>
            errors;  ///< e at the table's largest order for F0 = F90; 1 where the quadrature did not converge
        std::vector<float> coefficients;  ///< terms × count_per_term
    };

    /// Computes a table by quadrature, which is refined until it has converged. `lobes` is one lobe, or isotropic lobes
    /// of one kind with increasing α.
    BrdfTable(std::vector<TableLobe> lobes, const BrdfTableOptions& options, Progress& progress);
    /// Restores a table from the arrays of another one.
    BrdfTable(std::vector<TableLobe> lobes, const BrdfTableOptions& options, Nodes nodes);

    int terms() const { return lobes_.front().terms(); }
    int order() const { return options_.order; }
    const std::vector<TableLobe>& lobes() const { return lobes_; }
    const BrdfTableOptions& options() const { return options_; }
    bool isotropic() const { return isotropic_; }
    const TableGrid& grid() const { return grid_; }
    /// Coefficients of one term in a node: (l, m ≥ 0) in the order of polar_index where isotropic, else all.
    int count_per_term() const { return isotropic_ ? polar_count(options_.order) : coefficient_count(options_.order); }
    const Nodes& nodes() const { return nodes_; }

    /// Coefficients of f · cos for `wo`, wo.z > 0, and for roughness `alpha` where there are several lobes: term after
    /// term, order² each. Returns the order; 0 where the lobe is not to be cached, and `out` is as it was.
    int lookup(Vec3 wo, float alpha, std::span<float> out) const;

    /// e at the table's largest order for F0 = F90, interpolated; 1 beyond the table's roughness.
    float error(Vec3 wo, float alpha) const;

    /// Largest relative change of the coefficients, and of ‖f cos‖², in the last halving of the quadrature's steps: a
    /// bound for what further halving would change, since it converges faster than linearly.
    static constexpr double quadrature_tolerance = 1e-4;

  private:
    Vec3 direction(size_t i) const;
    void make_node(size_t i);
    void turn_to(Vec3 wo, std::span<double> coefficients) const;
    void check();

    std::vector<TableLobe> lobes_;
    BrdfTableOptions options_;
    bool isotropic_;
    TableGrid grid_;
    std::shared_ptr<const HemisphereFit> fit_;  // spherical tables only
    Nodes nodes_;
};

}  // namespace eclat
