// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "bsdf/bsdf.h"

#include <bit>
#include <stdexcept>

namespace eclat {

namespace {

/// Calls `f(i)` for each bit i of `mask`, in rising order.
template <class F>
void for_each_bit(uint32_t mask, const F& f) {
    for (; mask != 0; mask &= mask - 1) f(size_t(std::countr_zero(mask)));
}

Color lobe_albedo(const Lobe& lobe, Vec3 wo) {
    return visit_lobe([&](const auto& l) { return l.albedo(wo); }, lobe);
}

Color lobe_straight(const Lobe& lobe, Vec3 wo) {
    if (const auto* pane = std::get_if<ThinDielectricLobe>(&lobe)) return pane->straight(wo);
    if (const auto* mirror = std::get_if<MirrorLobe>(&lobe)) return mirror->straight(wo);
    return {};
}

}  // namespace

void Bsdf::add(const Lobe& lobe, Color weight) {
    if (is_black(weight)) return;
    const bool lambertian = std::holds_alternative<LambertLobe>(lobe);
    if (lambertian)
        for (int i = 0; i < count_; ++i)
            if (std::holds_alternative<LambertLobe>(entries_[size_t(i)].lobe)) {
                entries_[size_t(i)].weight += weight;
                return;
            }
    if (count_ == capacity) throw std::length_error("BSDF: expected at most 8 lobes, got more: blend fewer materials");
    std::construct_at(&entries_[size_t(count_)], lobe, weight);
    visit_lobe(
        [&](const auto& l) {
            diffuse_ |= Mask(l.is_diffuse) << count_;
            delta_ |= Mask(l.is_delta) << count_;
        },
        lobe);
    translucent_ |= Mask(std::holds_alternative<DiffuseTransmissionLobe>(lobe)) << count_;
    ++count_;
    is_lambertian_ = count_ == 1 && lambertian;
}

void Bsdf::set_cached(int i, float share) {
    if (!(share > 0)) return;
    Entry& entry = entries_[size_t(i)];
    if (share < 1) {
        add(entry.lobe, entry.weight * (1 - share));
        entry.weight *= share;
    }
    cached_ |= Mask(1) << i;
}

void Bsdf::append(const Bsdf& other, float weight) {
    for (int i = 0; i < other.count_; ++i)
        add(other.entries_[size_t(i)].lobe, other.entries_[size_t(i)].weight * weight);
}

/// Probabilities of the lobes of `set`, in proportion to what they are expected to reflect; returns their sum, 1 or 0.
float Bsdf::select(Vec3 wo, Mask set, std::array<float, capacity>& probability) const {
    if (std::has_single_bit(set)) {
        probability[size_t(std::countr_zero(set))] = 1;
        return 1;
    }
    float sum = 0;
    for_each_bit(set, [&](size_t i) {
        sum += probability[i] = luminance(entries_[i].weight * lobe_albedo(entries_[i].lobe, wo));
    });
    if (!(sum > 0)) return 0;
    for_each_bit(set, [&](size_t i) { probability[i] /= sum; });
    return 1;
}

EvalPdf Bsdf::eval_lobes(Vec3 wo, Vec3 wi, Mask set) const {
    std::array<float, capacity> probability;
    EvalPdf sum;
    // Delta lobes contribute nothing here.
    if ((set & ~delta_) == 0 || select(wo, set, probability) == 0) return sum;
    for_each_bit(set & ~delta_, [&](size_t i) {
        const EvalPdf e = visit_lobe([&](const auto& l) { return l.eval(wo, wi); }, entries_[i].lobe);
        sum.f += entries_[i].weight * e.f;
        const bool aims = (diffuse_ >> i & 1) != 0 && e.pdf_solid_angle > 0;
        const float factor = aims ? aim(wi) : 1;
        sum.pdf_solid_angle += probability[i] * e.pdf_solid_angle * factor;
    });
    return sum;
}

std::optional<BsdfSample> Bsdf::sample_lobes(Vec3 wo, float u_lobe, Vec2 u, LobeSet set) const {
    const Mask lobes = members(set);
    std::array<float, capacity> probability;
    if (lobes == 0 || select(wo, lobes, probability) == 0) return std::nullopt;

    // Choose a lobe; what remains of the random number serves again inside it.
    Mask rest = lobes;
    size_t chosen = size_t(std::countr_zero(rest));
    while (u_lobe >= probability[chosen] && (rest & (rest - 1)) != 0) {
        u_lobe -= probability[chosen];
        rest &= rest - 1;
        chosen = size_t(std::countr_zero(rest));
    }
    if (!(probability[chosen] > 0)) return std::nullopt;
    u_lobe = clamp(u_lobe / probability[chosen], 0, below_one);

    BsdfSample s;
    const bool aims = guide_ != nullptr && (diffuse_ >> chosen & 1) != 0;
    const float factor = aims ? aimed(u) : 1;
    if (!visit_lobe([&](const auto& l) { return l.sample(wo, u_lobe, u, s); }, entries_[chosen].lobe))
        return std::nullopt;
    if (aims) turn_by(factor, s);

    if (s.delta || (lobes & (lobes - 1)) == 0) {
        s.weight = s.weight * entries_[chosen].weight * (1 / probability[chosen]);
        s.pdf_solid_angle *= probability[chosen];
        return s;
    }
    // Any lobe may have generated this direction.
    const EvalPdf e = eval_lobes(wo, s.wi, lobes);
    if (!(e.pdf_solid_angle > 0)) return std::nullopt;
    s.weight = e.f * (abs_cos(s.wi) / e.pdf_solid_angle);
    s.pdf_solid_angle = e.pdf_solid_angle;
    return s;
}

Color Bsdf::straight(Vec3 wo) const {
    Color sum;
    for_each_bit(delta_, [&](size_t i) { sum += entries_[i].weight * lobe_straight(entries_[i].lobe, wo); });
    return sum;
}

Color Bsdf::scattered_through(Vec3 wo) const {
    Color sum = translucent_albedo(wo);
    for_each_bit(members(LobeSet::glossy) & ~delta_, [&](size_t i) {
        const auto* rough = std::get_if<RoughReflectionLobe>(&entries_[i].lobe);
        if (rough != nullptr && rough->through) sum += entries_[i].weight * rough->albedo(wo);
    });
    return sum;
}

Color Bsdf::albedo_of_lobes(Vec3 wo, LobeSet set) const {
    Color sum;
    for_each_bit(members(set), [&](size_t i) { sum += entries_[i].weight * lobe_albedo(entries_[i].lobe, wo); });
    return sum;
}

}  // namespace eclat
