// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Front door of scattering at a point: a sum of lobes in the local shading frame (z = normal). `eval` does not include
// the cosine. Lobes that only reflect expect wo.z > 0; whoever owns the surface turns the frame of a two-sided one.

#pragma once

#include <cstdint>
#include <optional>

#include "bsdf/lobe.h"

namespace eclat {

/// Which lobes are meant: the diffuse ones (what an irradiance cache serves), the rest (deltas included), or all.
enum class LobeSet : uint8_t { all, diffuse, glossy };

struct BsdfSample {
    Vec3 wi;
    Color weight;  // f · |cos| / pdf over the chosen set of lobes
    float pdf_solid_angle = 0;
    bool delta = false;
    bool transmission = false;
    float eta_ratio = 1;  // transmitted over incident index: radiance scales with its square
};

struct EvalPdf {
    Color f;
    float pdf_solid_angle = 0;
};

class Bsdf {
  public:
    static constexpr int capacity = 8;

    void add(const Lobe& lobe) {
        if (count_ < capacity && !is_black(lobe.color)) lobes_[count_++] = lobe;
    }

    /// Adds the other's lobes, scaled [a blend of two materials].
    void append(const Bsdf& other, float weight) {
        for (int i = 0; i < other.count_; ++i) {
            Lobe lobe = other.lobes_[i];
            lobe.color *= weight;
            add(lobe);
        }
    }

    bool has(LobeSet set) const {
        for (int i = 0; i < count_; ++i)
            if (in(lobes_[i], set)) return true;
        return false;
    }
    bool has_non_delta() const {
        for (int i = 0; i < count_; ++i)
            if (!lobes_[i].delta()) return true;
        return false;
    }

    EvalPdf eval(Vec3 wo, Vec3 wi, LobeSet set) const {
        EvalPdf out;
        float total = 0;
        for (int i = 0; i < count_; ++i) {
            if (!in(lobes_[i], set)) continue;
            const float p = selection(lobes_[i], wo);
            total += p;
            if (lobes_[i].delta()) continue;
            const LobeEval e = lobes_[i].eval(wo, wi);
            out.f += e.f;
            out.pdf_solid_angle += p * e.pdf_solid_angle;
        }
        if (total > 0) out.pdf_solid_angle /= total;
        return out;
    }

    /// Nothing where light is absorbed.
    std::optional<BsdfSample> sample(Vec3 wo, float u_lobe, Vec2 u, LobeSet set) const {
        float p[capacity], total = 0;
        int chosen = -1;
        for (int i = 0; i < count_; ++i) total += p[i] = in(lobes_[i], set) ? selection(lobes_[i], wo) : 0;
        if (!(total > 0)) return std::nullopt;
        float x = u_lobe * total;
        for (int i = 0; i < count_; ++i) {
            if (p[i] == 0) continue;
            chosen = i;
            if (x < p[i]) break;
            x -= p[i];
        }
        const Lobe& lobe = lobes_[chosen];
        const float u_inside = clamp(x / p[chosen], 0, 0x1.fffffep-1f);
        const auto s = lobe.sample(wo, u_inside, u);
        if (!s) return std::nullopt;
        BsdfSample out{s->wi, s->weight, s->pdf_solid_angle, lobe.delta(), s->transmission, s->eta_ratio};
        const float probability = p[chosen] / total;
        if (lobe.delta()) {
            out.weight *= 1 / probability;
            out.pdf_solid_angle *= probability;
            return out;
        }
        if (count_ == 1) return out;
        const EvalPdf all = eval(wo, out.wi, set);
        if (!(all.pdf_solid_angle > 0)) return std::nullopt;
        out.pdf_solid_angle = all.pdf_solid_angle;
        out.weight = all.f * (std::fabs(out.wi.z) / all.pdf_solid_angle);
        return out;
    }

    /// ρ_d(wo): what the diffuse lobes reflect under uniform light, so that their indirect radiance is ρ_d / π · E.
    Color diffuse_albedo(Vec3 wo) const { return albedo(wo, LobeSet::diffuse); }

    /// Directional albedo; approximate for rough lobes.
    Color albedo(Vec3 wo, LobeSet set = LobeSet::all) const {
        Color sum;
        for (int i = 0; i < count_; ++i)
            if (in(lobes_[i], set)) sum += lobes_[i].albedo(wo);
        return sum;
    }

  private:
    static bool in(const Lobe& lobe, LobeSet set) {
        return set == LobeSet::all || (set == LobeSet::diffuse) == lobe.diffuse();
    }
    static float selection(const Lobe& lobe, Vec3 wo) { return luminance(lobe.albedo(wo)) + 1e-4f * mean(lobe.color); }

    Lobe lobes_[capacity];
    int count_ = 0;
};

}  // namespace eclat
