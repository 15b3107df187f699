// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Held to      tests/methods/test_focused_light.py

#include "estimate/focused_light.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <vector>

#include "base/parallel.h"
#include "transport/path_loop.h"

namespace eclat {

namespace {

constexpr uint64_t paths_of_block = 2048, blocks = 16;

// This is the solid angle that one ray of a gather of about 500 rays represents.
constexpr float met_once = pi / 500;

/// Paths have at most this number of edges, because longer paths carry little light.
constexpr int most_edges = 12;

struct State {
    Color power;
    Sampler sampler;
    float lamp_area = 0;    // area of the lamp in the scene, m²
    float solid_angle = 0;  // solid angle of an infinite light, and of the widest lobe so far
    float length = 0;       // length of the path, m
    bool by_lobes = false;
};

struct Sums {
    double all = 0, by_chance = 0, unseen = 0;
    double squares = 0;  // of the errors of a gather in light found by chance, times its power
};

class Tracer {
  public:
    Tracer(const World& world, const std::vector<float>& lamp_areas, int max_edges, Progress& progress)
        : world_(world), lamp_areas_(lamp_areas), max_edges_(max_edges), progress_(progress) {}

    Sums trace(uint32_t seed, uint32_t part) {
        follow_paths(
            world_, emit(seed, part), Coherence::none, Span::part, progress_,
            [&](int edges, std::span<State> states, std::span<const Vertex> vertices, Paths<State>& next) {
                for (size_t i = 0; i < states.size(); ++i) {
                    if (vertices[i].missed()) continue;
                    Ray ray;
                    arrive(states[i], vertices[i]);
                    if (edges < max_edges_ && reflect(states[i], vertices[i], ray)) next.push(states[i], ray);
                }
            },
            [](Paths<State>&) {});
        return sums_;
    }

  private:
    Paths<State> emit(uint32_t seed, uint32_t part) const {
        Paths<State> paths;
        for (uint32_t i = 0; i < paths_of_block; ++i) {
            Sampler sampler(stream_seed(seed, Stream::focused_light), 0, part * paths_of_block + i);
            const float u = sampler.next_1d();
            const Vec2 u_position = sampler.next_2d(), u_direction = sampler.next_2d();
            const PhotonSample photon = world_.lights.emit(u, u_position, u_direction);
            if (is_black(photon.power)) continue;
            // Light of a wide ground far away would hide what is found by chance here.
            if (photon.importance < 1) continue;
            State state{.power = photon.power, .sampler = sampler};
            Vec3 origin = photon.origin;
            if (photon.triangle != no_triangle) {
                state.lamp_area = lamp_areas_[photon.triangle];
                const Vec3 n = world_.geometry.geometric_normal(photon.triangle);
                const float offset = world_.geometry.ray_offset(photon.triangle);
                origin = origin + n * (dot(n, photon.direction) >= 0 ? offset : -offset);
            } else {
                state.solid_angle = behind_everything(photon.direction);
            }
            paths.push(state, {origin, 0, photon.direction, infinity});
        }
        return paths;
    }

    /// Returns the solid angle of the infinite light in a direction; it is 0 for point lights.
    float behind_everything(Vec3 direction) const {
        const Lights::Infinite all = world_.lights.infinite(-direction);
        if (is_black(all.radiance)) return 0;
        const Lights::Infinite sharp = world_.lights.infinite(-direction, LightSet::without_smooth_environment);
        const bool small = luminance(sharp.radiance) > 0.5f * luminance(all.radiance);
        return small ? 1 / sharp.pdf_solid_angle : 2 * pi;
    }

    void arrive(State& s, const Vertex& v) {
        s.length += v.hit.t;
        if (!v.point.bsdf.has(LobeSet::matte)) return;
        const double power = luminance(s.power);
        sums_.all += power;
        if (!s.by_lobes) return;
        const float seen = std::max(s.solid_angle, s.lamp_area / std::max(sqr(s.length), 1e-12f));
        if (seen < met_once) {
            sums_.by_chance += power;
            // One of met_once / seen gathers meets the light, and finds it as many times too bright.
            sums_.squares += power * (seen > 0 ? met_once / seen : 1);
        }
        if (seen == 0) sums_.unseen += power;
    }

    /// Continues paths by lobes that are not diffuse, like photons (methods/photon_map/trace_photons.cpp).
    bool reflect(State& s, const Vertex& v, Ray& ray) const {
        if (!v.point.bsdf.has(LobeSet::glossy)) return false;
        const float u_lobe = s.sampler.next_1d();
        const Vec2 u = s.sampler.next_2d();
        const float u_roulette = s.sampler.next_1d();
        const auto to = scatter(v.point, v.wo_local, u_lobe, u, LobeSet::glossy);
        if (!to) return false;
        float adjoint = std::fabs(v.wo_local.z * dot(to->direction, v.point.normal)) /
                        std::fabs(dot(v.wo, v.point.normal) * to->sample.wi.z);
        if (to->sample.transmission) adjoint *= sqr(to->sample.eta_ratio);
        const Color power = s.power * to->sample.weight * adjoint;
        const float survival = std::min(1.0f, max_component(power) / max_component(s.power));
        if (!(u_roulette < survival)) return false;
        s.power = power * (1 / survival);
        // Light samples pass straight through panes, so that light behind a pane is not found only by chance.
        s.by_lobes |= !to->sample.straight;
        if (!to->sample.delta) s.solid_angle = std::max(s.solid_angle, 1 / to->sample.pdf_solid_angle);
        ray = v.point.ray(to->direction);
        return true;
    }

    const World& world_;
    const std::vector<float>& lamp_areas_;  // area of the lamp of each triangle
    int max_edges_;
    Progress& progress_;
    Sums sums_;
};

float triangle_area(const Geometry& g, uint32_t t) {
    const Vec3 a = g.vertex(t, 0);
    return 0.5f * length(cross(g.vertex(t, 1) - a, g.vertex(t, 2) - a));
}

/// Returns for each triangle the total area of the emitting triangles with its material, which is taken for the area of
/// the lamp.
std::vector<float> areas_of_lamps(const World& world) {
    const Geometry& g = world.geometry;
    std::unordered_map<const Material*, float> sums;
    std::vector<float> out(g.triangle_count(), 0.0f);
    for (uint32_t t = 0; t < g.triangle_count(); ++t)
        if (world.emitter(t) != not_emitting) sums[&g.material_of(t)] += triangle_area(g, t);
    for (uint32_t t = 0; t < g.triangle_count(); ++t)
        if (world.emitter(t) != not_emitting) out[t] = sums[&g.material_of(t)];
    return out;
}

}  // namespace

FocusedLight focused_light(const World& world, int max_depth, uint32_t seed, int threads, Progress& progress) {
    const int edges = max_depth < 0 ? most_edges : std::min(most_edges, max_depth - 1);
    const bool shines = std::ranges::any_of(world.geometry.materials(),
                                            [](const Material& m) { return m.kind != MaterialKind::diffuse; });
    if (!shines || world.lights.dark() || edges < 2) return {};
    const std::vector<float> lamps = areas_of_lamps(world);
    const auto parts = parallel_map<Sums>(blocks, threads, [&](size_t i) {
        progress.check();
        return Tracer(world, lamps, edges, progress).trace(seed, static_cast<uint32_t>(i));
    });
    Sums sum;
    for (const Sums& part : parts) {
        sum.all += part.all;
        sum.by_chance += part.by_chance;
        sum.unseen += part.unseen;
        sum.squares += part.squares;
    }
    if (!(sum.all > 0)) return {};
    const double spread = sum.by_chance > 0 ? std::sqrt(sum.squares / sum.by_chance) : 0;
    return {sum.by_chance / sum.all, sum.unseen / sum.all, spread};
}

}  // namespace eclat
