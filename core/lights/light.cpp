// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "lights/light.h"

#include <map>
#include <tuple>

#include "lights/mean_emission.h"

namespace eclat {

namespace {

/// The number of samples that are taken together: as many as there are vertices in a part of a batch of paths.
constexpr size_t group_size = 32;

/// Emissions of equal key are the same function of uv.
auto key_of(const Value& v) {
    return std::tuple(v.texture, v.constant.r, v.constant.g, v.constant.b, v.channel, v.invert, v.square,
                      v.uv_transform);
}

/// Throws std::invalid_argument for values that no light can emit.
void check_power(Color power, const char* kind, size_t index) {
    if (is_finite(power) && power.r >= 0 && power.g >= 0 && power.b >= 0) return;
    require(false, "lights: " + std::string(kind) + " " + std::to_string(index) +
                       ": power must be finite and not negative, got " + std::to_string(power.r) + ", " +
                       std::to_string(power.g) + ", " + std::to_string(power.b));
}

template <class Light, class F>
std::vector<double> powers_of(const char* kind, const std::vector<Light>& lights, Color& total, F&& power) {
    std::vector<double> out;
    for (const Light& light : lights) {
        const Color p = power(light);
        check_power(p, kind, out.size());
        total += p;
        out.push_back(luminance(p));
    }
    return out;
}

}  // namespace

Lights::Lights(LightInputs inputs)
    : points_(std::move(inputs.points)),
      spots_(std::move(inputs.spots)),
      profiles_(std::move(inputs.profiles)),
      directionals_(std::move(inputs.directionals)),
      environment_(std::move(inputs.environment)),
      discs_of_emission_({inputs.scene_center, inputs.scene_radius > 0 ? inputs.scene_radius : 1}, inputs.places) {
    const float area = discs_of_emission_.area();
    std::array<std::vector<double>, light_kinds> powers;
    powers[static_cast<size_t>(LightKind::triangle)] = add_triangles(inputs.triangles);
    powers[static_cast<size_t>(LightKind::point)] =
        powers_of("point light", points_, total_power_, [](const PointLight& l) { return l.power(); });
    powers[static_cast<size_t>(LightKind::spot)] =
        powers_of("spot light", spots_, total_power_, [](const SpotLight& l) { return l.power(); });
    powers[static_cast<size_t>(LightKind::profile)] =
        powers_of("profile light", profiles_, total_power_, [](const ProfileLight& l) { return l.power(); });
    powers[static_cast<size_t>(LightKind::directional)] = powers_of(
        "directional light", directionals_, total_power_, [&](const DirectionalLight& l) { return l.power(area); });
    if (environment_) sharp_environment_ = environment_->sharp_part();
    if (sharp_environment_)
        powers[static_cast<size_t>(LightKind::sharp_environment)] = {luminance(sharp_environment_->integral() * area)};
    if (environment_) {
        const Color power = environment_->integral() * area;
        total_power_ += power;
        powers[static_cast<size_t>(LightKind::environment)] = {luminance(power)};
    }
    for (uint32_t i = 0; i < directionals_.size(); ++i) {
        if (!directionals_[i].is_delta()) discs_.push_back(i);
    }
    sampler_ = LightSampler(powers);
}

std::vector<double> Lights::add_triangles(std::span<const EmitterTriangle> triangles) {
    using Known = std::pair<uint32_t, MeanEmission>;
    std::map<decltype(key_of(Value())), Known> known;
    std::vector<double> weights;
    std::array<double, 3> power = {0, 0, 0};
    areas_.reserve(triangles.size());
    weights.reserve(triangles.size());
    for (const EmitterTriangle& t : triangles) {
        MeanEmission::Estimate estimate;
        uint32_t emission = 0;
        if (t.emission.is_constant()) {
            estimate.mean = t.emission.color(Vec2());
            estimate.weight = luminance(estimate.mean);
        } else {
            const auto key = key_of(t.emission);
            auto found = known.find(key);
            if (found == known.end()) {
                found = known.emplace(key, Known(emissions_.size(), MeanEmission(t.emission))).first;
                emissions_.push_back(t.emission);
            }
            emission = found->second.first;
            estimate = found->second.second.over(t.uv0, t.uv1, t.uv2);
        }
        areas_.emplace_back(t, emission);
        const double flux_of_one = M_PI * areas_.back().area() * (t.two_sided ? 2 : 1);
        check_power(estimate.mean * static_cast<float>(flux_of_one), "emissive triangle", weights.size());
        weights.push_back(flux_of_one * estimate.weight);
        for (int c = 0; c < 3; ++c) power[c] += flux_of_one * estimate.mean[c];
    }
    total_power_ += Color(static_cast<float>(power[0]), static_cast<float>(power[1]), static_cast<float>(power[2]));
    return weights;
}

LightSample Lights::sample(Vec3 position, float u_light, Vec2 u, LightSet set) const {
    const LightQuery query{position, u_light, u};
    LightSample out;
    sample_group({&query, 1}, set, {&out, 1});
    return out;
}

void Lights::sample(std::span<const LightQuery> queries, LightSet set, std::span<LightSample> out) const {
    for (size_t begin = 0; begin < queries.size(); begin += group_size) {
        const size_t count = std::min(group_size, queries.size() - begin);
        sample_group(queries.subspan(begin, count), set, out.subspan(begin, count));
    }
}

const EnvironmentImage* Lights::image_of(LightKind kind) const {
    if (kind == LightKind::environment) return &*environment_;
    if (kind == LightKind::sharp_environment) return &*sharp_environment_;
    return nullptr;
}

/// Takes at most `group_size` samples, one step of all of them after the other.
void Lights::sample_group(std::span<const LightQuery> queries, LightSet set, std::span<LightSample> out) const {
    std::array<LightSampler::Choice, group_size> choices;
    std::array<EnvironmentImage::Search, group_size> searches;
    const size_t count = queries.size();
    for (size_t i = 0; i < count; ++i) choices[i] = sampler_.choose(set, queries[i].u_light);
    if (environment_) {
        const auto for_each_image = [&](const auto& step) {
            for (size_t i = 0; i < count; ++i)
                if (choices[i].pdf_discrete > 0)
                    if (const EnvironmentImage* image = image_of(choices[i].kind)) step(i, *image);
        };
        for_each_image([&](size_t i, const EnvironmentImage& image) { searches[i] = image.find_row(queries[i].u); });
        for_each_image([&](size_t i, const EnvironmentImage& image) { image.narrow(searches[i]); });
        for_each_image([&](size_t i, const EnvironmentImage& image) { image.find_cell(searches[i]); });
    }
    for (size_t i = 0; i < count; ++i) out[i] = finish(queries[i], set, choices[i], searches[i]);
}

LightSample Lights::finish(const LightQuery& query, LightSet set, const LightSampler::Choice& choice,
                           const EnvironmentImage::Search& search) const {
    if (choice.pdf_discrete == 0) return {};
    const auto& [position, u_light, u] = query;
    LightSample s;
    switch (choice.kind) {
        case LightKind::triangle: s = areas_[choice.index].sample(emissions_, position, u); break;
        case LightKind::point: s = points_[choice.index].sample(position); break;
        case LightKind::spot: s = spots_[choice.index].sample(position); break;
        case LightKind::profile: s = profiles_[choice.index].sample(position); break;
        case LightKind::directional: s = directionals_[choice.index].sample(u); break;
        case LightKind::environment: s = environment_->finish(search); break;
        case LightKind::sharp_environment: s = sharp_environment_->finish(search); break;
    }
    if (s.pdf_solid_angle == 0) return {};
    s.pdf_solid_angle *= choice.pdf_discrete;
    if (s.delta || std::isfinite(s.distance)) return s;
    // The image and the discs overlap, so the radiance and the density of a direction are sums over both.
    Infinite all;
    if (choice.kind == LightKind::environment || choice.kind == LightKind::sharp_environment) {
        all = {s.radiance, s.pdf_solid_angle};
    } else {
        add_image(s.wi, set, all);
    }
    add_discs(s.wi, set, all);
    s.radiance = all.radiance;
    s.pdf_solid_angle = all.pdf_solid_angle;
    return s;
}

Lights::Infinite Lights::infinite(Vec3 direction, LightSet set) const {
    Infinite out;
    add_image(direction, set, out);
    add_discs(direction, set, out);
    return out;
}

void Lights::add_image(Vec3 direction, LightSet set, Infinite& out) const {
    const bool whole = set == LightSet::all;
    const auto& image = whole ? environment_ : sharp_environment_;
    if (!image) return;
    const EnvironmentImage::Lookup at = image->lookup(direction);
    const LightKind kind = whole ? LightKind::environment : LightKind::sharp_environment;
    out.radiance += at.radiance;
    out.pdf_solid_angle += at.pdf_solid_angle * sampler_.pdf_discrete(set, kind, 0);
}

void Lights::add_discs(Vec3 direction, LightSet set, Infinite& out) const {
    for (const uint32_t i : discs_) {
        const DirectionalLight& disc = directionals_[i];
        if (!disc.covers(direction)) continue;
        out.radiance += disc.radiance();
        out.pdf_solid_angle += disc.pdf_solid_angle() * sampler_.pdf_discrete(set, LightKind::directional, i);
    }
}

PhotonSample Lights::emit(float u_light, Vec2 u_position, Vec2 u_direction) const {
    const LightSampler::Choice choice = sampler_.choose(LightSet::all, u_light);
    if (choice.pdf_discrete == 0) return {};
    PhotonSample photon;
    switch (choice.kind) {
        case LightKind::triangle: photon = areas_[choice.index].emit(emissions_, u_position, u_direction); break;
        case LightKind::point: photon = points_[choice.index].emit(u_direction); break;
        case LightKind::spot: photon = spots_[choice.index].emit(u_direction); break;
        case LightKind::profile: photon = profiles_[choice.index].emit(u_direction); break;
        case LightKind::directional:
            photon = directionals_[choice.index].emit(discs_of_emission_, u_position, u_direction);
            break;
        case LightKind::environment: photon = environment_->emit(discs_of_emission_, u_position, u_direction); break;
        case LightKind::sharp_environment: return {};  // photons start from the whole image
    }
    photon.power *= 1 / choice.pdf_discrete;
    return photon;
}

}  // namespace eclat
