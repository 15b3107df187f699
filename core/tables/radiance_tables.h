// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The coefficients of the lobes at a point, whose dot product with those of a radiance record is the reflected radiance: tables
// of white lobes (tables/brdf_table.h) for the materials of a scene are read in single precision, without allocation, multiplied
// by Fresnel factors and weights, and summed.
//
// Symbol       name here    meaning
//   f_i        factors      ∫ f cosθ B_i, in the basis of hemisphere/radiance_projection.h, for each channel
//   σ          width        of the lobe in units of a Lambertian one's: √(a² / ‖f cos‖² / (3π/2)), a = ∫ f cos
//
// The width is the radius of the patch of sky that a lobe averages, by the participation ratio of f cos; it scales how far
// from a record that lobe may be evaluated. It varies continuously with the direction, which the order does not.
// Held to      tests/core/tables/test_radiance_tables.cpp

#pragma once

#include <array>
#include <memory>
#include <vector>

#include "bsdf/bsdf.h"
#include "tables/brdf_table.h"
#include "hemisphere/radiance_projection.h"
#include "scene/material.h"

namespace eclat {

constexpr size_t max_radiance_coefficients = size_t(max_radiance_order) * max_radiance_order;

/// The reflection towards one direction by those lobes of a point that may be cached.
struct ReflectedFactors {
    int order = 0;                             // 0: there is nothing to cache
    float width = 1;                           // width of the narrowest of the lobes
    bool grey = true;                          // whether only the factors of the first channel are given
    Color albedo;                              // reflectance under uniform light
    std::array<float, Bsdf::capacity> shares;  // of each lobe of the BSDF, 0 where it is not to be cached
    std::array<std::array<float, max_radiance_coefficients>, 3> factors;
};

/// Marks the share of each lobe that its factors hold as given by a cache.
inline void set_cached(Bsdf& bsdf, const ReflectedFactors& factors) {
    for (int i = 0, count = bsdf.count(); i < count; ++i) bsdf.set_cached(i, factors.shares[size_t(i)]);
}

/// One table in the orthonormal basis.
class LobeTable {
  public:
    LobeTable(const BrdfTable& table, const HemisphereFit& fit);

    const TableLobe& lobe() const { return lobes_.front(); }
    bool over_roughness() const { return lobes_.size() > 1; }
    int terms() const { return terms_; }

    /// Returns the share of the lobe that is cached for wo.z > 0 in its frame. It is 0 or 1 except near the border
    /// between cached and traced directions. An abrupt border would be visible as a seam, because cached light is
    /// smooth with a small error and traced light is noisy.
    float share(Vec3 wo, float alpha) const;
    /// Adds `share` times `colors[t]` times term t to the factors of each channel.
    void add(Vec3 wo, float alpha, float share, const Color* colors, ReflectedFactors& out) const;

  private:
    std::vector<float> shares_of_nodes() const;

    std::vector<TableLobe> lobes_;
    TableGrid grid_;
    int order_, terms_;
    size_t count_;  // floats of a term
    std::vector<uint8_t> orders_;
    std::vector<float> widths_, coefficients_, shares_;
};

class RadianceTables {
  public:
    /// Lobes of `materials` that could be cached, each once, as far as their parameters do not vary; `roughness` tells that a
    /// metallic-roughness with a texture of it is among them, which needs one table over all α.
    struct Wanted {
        std::vector<TableLobe> lobes;
        bool roughness = false;
    };
    static Wanted wanted(const std::vector<Material>& materials);

    /// Throws std::invalid_argument unless all tables are spherical and of `order`.
    RadianceTables(const std::vector<Material>& materials, const std::vector<const BrdfTable*>& tables, int order);

    int order() const { return order_; }

    /// Factors of the lobes of `bsdf` that tables say may be cached, in the frame of `wo`. Order 0 where there are none.
    void reflect(const Bsdf& bsdf, Vec3 wo, ReflectedFactors& out) const;
    /// Returns whether some lobe may be cached.
    bool reflects(const Bsdf& bsdf, Vec3 wo) const;

  private:
    const LobeTable* table_of(const Lobe& lobe) const;
    FresnelFactors factors_of(const InterfaceReflectance& reflectance) const;

    struct Interface {
        InterfaceReflectance reflectance;
        FresnelFactors factors;
    };

    int order_;
    HemisphereFit fit_;
    std::vector<LobeTable> tables_;
    std::vector<Interface> interfaces_;
    std::vector<float> uniform_;  // radiance 1 from everywhere: coefficients of m = 0, the others vanish
};

}  // namespace eclat
