// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The interface for scattering at a point: a weighted sum of lobes in the local shading frame, whose z axis is the
// shading normal.
//
// - `eval` does not include the cosine; delta lobes are 0 there and appear in `sample` only.
// - Lobes that reflect are 0 unless wo.z > 0 and wi.z > 0: whoever owns a two-sided surface turns the frame. Solid
//   dielectrics take wo on either side, the inside being z < 0; thin sheets look the same from both.
// - The makers below take parameters already looked up in textures.

#pragma once

#include <array>
#include <memory>
#include <optional>

#include "bsdf/lobe.h"
#include "sampling/cosine_guide.h"

namespace eclat {

/// Sets of lobes, which differ in the source of their indirect light and in whether a cache has given it
/// (`set_cached`).
enum class LobeSet : uint8_t {
    all,
    diffuse,      // lobes that reflect the irradiance of the visible side
    translucent,  // lobes that transmit the irradiance of the other side
    matte,        // both of these
    glossy,       // all others, deltas included
    cached,
    uncached
};

class Bsdf {
  public:
    static constexpr int capacity = 8;

    Bsdf() {}  // constructs no lobe: those beyond `count_` stay uninitialised
    /// Makes a BSDF with only a Lambertian lobe, which is the most frequent case.
    static Bsdf lambertian(Color reflectance) {
        Bsdf bsdf;
        if (is_black(reflectance)) return bsdf;
        std::construct_at(&bsdf.entries_[0], LambertLobe{}, reflectance);
        bsdf.diffuse_ = 1;
        bsdf.count_ = 1;
        bsdf.is_lambertian_ = true;
        return bsdf;
    }

    /// Adds `weight` times a lobe; Lambertian lobes are combined. Throws std::length_error beyond `capacity`.
    void add(const Lobe& lobe, Color weight);
    /// Adds the lobes of another BSDF times `weight`, for blends.
    void append(const Bsdf& other, float weight);

    int count() const { return count_; }
    const Lobe& lobe(int i) const { return entries_[size_t(i)].lobe; }
    Color weight(int i) const { return entries_[size_t(i)].weight; }
    /// Marks all of a set as given by a cache.
    void set_cached(LobeSet set) { cached_ |= members(set); }
    /// Marks a share in 0..1 of lobe i as given by a cache; the rest becomes another lobe.
    void set_cached(int i, float share);
    /// Makes `sample` aim the directions of the diffuse lobes by `guide`, whose x axis is (turn.x, turn.y, 0) in the local frame. The
    /// guide must outlive the BSDF.
    void aim_diffuse(const CosineGuide& guide, Vec2 turn) {
        guide_ = &guide;
        turn_ = turn;
    }
    bool has(LobeSet set) const { return members(set) != 0; }
    bool has_uncached_diffuse() const { return (diffuse_ & ~cached_) != 0; }
    bool has_uncached_matte() const { return ((diffuse_ | translucent_) & ~cached_) != 0; }
    bool has_uncached_gloss() const { return (members(LobeSet::glossy) & ~cached_) != 0; }
    bool has_non_delta() const { return (members(LobeSet::all) & ~delta_) != 0; }
    /// Whether `sample` reads `u_lobe`.
    bool chooses_lobe() const { return !is_lambertian_; }

    /// Value, and the density of `sample` over the same set.
    EvalPdf eval(Vec3 wo, Vec3 wi, LobeSet set) const {
        if (!is_lambertian_) return eval_lobes(wo, wi, members(set));
        if (members(set) == 0 || !(wo.z > 0 && wi.z > 0)) return {};
        return {entries_[0].weight * inv_pi, wi.z * inv_pi * aim(wi)};
    }

    /// Samples a direction from which light comes, or nothing if the light is absorbed. `u_lobe` and `u` are in [0, 1).
    std::optional<BsdfSample> sample(Vec3 wo, float u_lobe, Vec2 u, LobeSet set) const {
        if (!is_lambertian_) return sample_lobes(wo, u_lobe, u, set);
        BsdfSample s;
        const float factor = guide_ != nullptr ? aimed(u) : 1;
        if (members(set) == 0 || !LambertLobe{}.sample(wo, u_lobe, u, s)) return std::nullopt;
        s.weight = entries_[0].weight;
        if (guide_ != nullptr) turn_by(factor, s);
        return s;
    }

    /// Returns ρ_d(wo), the albedo of the diffuse lobes; their indirect radiance is ρ_d / π · E.
    Color diffuse_albedo(Vec3 wo) const { return albedo(wo, LobeSet::diffuse); }
    /// Returns τ_d(wo), the transmittance of the translucent lobes; their indirect radiance is τ_d / π · E, with E of
    /// the other side.
    Color translucent_albedo(Vec3 wo) const { return albedo(wo, LobeSet::translucent); }

    /// Directional albedo: exact for diffuse and delta lobes, an estimate for rough ones.
    Color albedo(Vec3 wo, LobeSet set = LobeSet::all) const {
        if (!is_lambertian_) return albedo_of_lobes(wo, set);
        return members(set) != 0 && wo.z > 0 ? entries_[0].weight : Color();
    }

    /// Returns the share of light that passes straight through, as through a pane.
    Color straight(Vec3 wo) const;
    /// Returns the share of light that passes through a thin sheet but not straight: through curtains and frosted panes.
    Color scattered_through(Vec3 wo) const;

  private:
    struct Entry {
        Lobe lobe;
        Color weight;
    };
    using Mask = uint32_t;  // bit i for lobe i

    Mask members(LobeSet set) const {
        const Mask all = (Mask(1) << count_) - 1;
        switch (set) {
            case LobeSet::all: return all;
            case LobeSet::diffuse: return diffuse_;
            case LobeSet::translucent: return translucent_;
            case LobeSet::matte: return diffuse_ | translucent_;
            case LobeSet::glossy: return all & ~diffuse_ & ~translucent_;
            case LobeSet::cached: return cached_;
            case LobeSet::uncached: break;
        }
        return all & ~cached_;
    }
    /// Returns the density of a direction of the diffuse lobes over that of the cosine.
    float aim(Vec3 wi) const {
        if (guide_ == nullptr) return 1;
        return guide_->factor({turn_.x * wi.x + turn_.y * wi.y, turn_.x * wi.y - turn_.y * wi.x, wi.z});
    }
    /// Makes `u` follow the guide; returns the density there.
    float aimed(Vec2& u) const {
        const CosineGuide::Place place = guide_->sample(u);
        u = place.at;
        return place.factor;
    }
    /// Turns a sample of a diffuse lobe, which is made from such a `u`, from the frame of the guide to the local one.
    void turn_by(float factor, BsdfSample& s) const {
        s.wi = {turn_.x * s.wi.x - turn_.y * s.wi.y, turn_.x * s.wi.y + turn_.y * s.wi.x, s.wi.z};
        s.weight *= 1 / factor;
        s.pdf_solid_angle *= factor;
    }
    EvalPdf eval_lobes(Vec3 wo, Vec3 wi, Mask set) const;
    std::optional<BsdfSample> sample_lobes(Vec3 wo, float u_lobe, Vec2 u, LobeSet set) const;
    Color albedo_of_lobes(Vec3 wo, LobeSet set) const;
    float select(Vec3 wo, Mask set, std::array<float, capacity>& probability) const;

    // These are stored next to the first lobe, because most points read nothing else of a Bsdf.
    int count_ = 0;
    Mask diffuse_ = 0, translucent_ = 0, delta_ = 0, cached_ = 0;
    const CosineGuide* guide_ = nullptr;
    Vec2 turn_{1, 0};
    bool is_lambertian_ = false;  // one diffuse lobe with the same value everywhere: the fast path
    union {
        std::array<Entry, capacity> entries_;
    };
};

// --- makers, one per kind of material; α below `smallest_alpha` is smooth -----------------------------------------

Bsdf make_diffuse(Color reflectance);

Bsdf make_phong(Color diffuse, Color specular, float exponent);

Bsdf make_ward(Color diffuse, Color specular, float alpha_u, float alpha_v);

/// Complex index eta + i·k relative to the outside; `specular` multiplies.
Bsdf make_conductor(Color eta, Color k, Color specular, float alpha_u, float alpha_v, Distribution distribution,
                    Masking masking = Masking::separable);

/// `ior` is the inside's index over the outside's.
Bsdf make_dielectric(float ior, float alpha_u, float alpha_v, Color reflection, Color transmission,
                     Distribution distribution);

Bsdf make_thin_dielectric(float ior, Color reflection, Color transmission);

/// The table must outlive the result.
Bsdf make_measured(const MeasuredBrdf& brdf, Color scale);

/// Makes a thin surface that reflects and transmits light diffusely on both sides.
Bsdf make_translucent(Color reflectance, Color transmittance);

/// `table` must outlive the result.
Bsdf make_plastic(const PlasticTable& table, Color diffuse, Color specular, Distribution distribution, bool nonlinear);

struct MetallicRoughness {
    Color base_color{1};
    float metallic = 0, alpha = 0.5f, ior = 1.5f, specular = 1;
    Color specular_color{1};
    float transmission = 0;
    float diffuse_transmission = 0;  ///< share of the diffuse part that comes out on the other side
    Color diffuse_transmission_color{1};
    bool thin =
        true;  ///< transmission goes straight through; else wo.z < 0 is inside, and the frame must not be turned
};

Bsdf make_metallic_roughness(const MetallicRoughness& p);

}  // namespace eclat
