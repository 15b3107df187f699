// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Photon mapping, second pass [Jensen01]. At a vertex that the camera sees, directly or after glossy lobes:
//
//   emission                  what the ray meets, weighted against light sampling after a glossy lobe
//   direct                    by light sampling: all of the matte lobes', the glossy lobes' weighted
//   caustics                  light that met glossy lobes only: density of the caustic map, ρ / π · E
//   diffuse interreflection   looked up in the global map, or gathered: diffuse rays to what the point sees
//   light through sheets      the same, of the sheet's other side
//   glossy lobes              the path goes on, to the next vertex that the camera sees
//
// At a vertex that a gather ray meets, directly or after glossy lobes: direct light and photons of both maps by its matte
// lobes; no emission and no light through its glossy lobes, which the first vertex has as direct light and as caustics.
// So each path of light belongs to exactly one term.
//
// Where the gather ray was shorter than the disc of an estimate, in corners, photons would blur what is near: it goes on
// by one more diffuse ray.
//
// References   [Jensen01], [Christensen99] irradiance precomputed at photons
// Bias         Blur of caustics; what gather rays see is blurred too. docs/algorithms/photon_map.md
// Held to      tests/methods/test_photon_map.py, tests/methods/test_caustics.py

#include "methods/photon_map/photon_gathering.h"

#include <algorithm>
#include <optional>

#include "transport/path_loop.h"

namespace eclat {

namespace {

struct State : PathState {
    bool gathering = false;  // whether a gather ray from a visible surface led here
};

class Gatherer {
  public:
    Gatherer(const World& world, const PhotonMaps& maps, const PhotonMapOptions& options, std::span<PathResult> out,
             Progress& progress)
        : world_(world),
          maps_(maps),
          options_(options),
          lights_(world, LightSet::all),
          out_(out),
          progress_(progress) {}

    void run(std::span<const PathRay> rays) {
        Paths<State> paths;
        for (uint32_t i = 0; i < rays.size(); ++i)
            paths.push({{.sampler = rays[i].sampler, .index = i, .from = rays[i].ray.origin}}, rays[i].ray);
        follow_paths(
            world_, std::move(paths), Coherence::camera, Span::batch, progress_,
            [&](int edges, std::span<State> states, std::span<Vertex> vertices, Paths<State>& next) {
                edges_ = edges;
                at_vertices(states, vertices, next);
            },
            [&](Paths<State>&) {
                shadows_.resolve(world_, progress_, [&](uint32_t index, Color radiance, bool direct) {
                    out_[index].radiance += radiance;
                    if (direct) out_[index].direct += radiance;
                });
            });
    }

  private:
    /// The stages of the processing, each for all vertices of a batch.
    void at_vertices(std::span<State> paths, std::span<Vertex> vertices, Paths<State>& next) {
        for (size_t i = 0; i < vertices.size(); ++i) {
            describe(world_, vertices[i], edges_ == 1, paths[i], out_[paths[i].index]);
            if (!paths[i].gathering) lights_.arrive(paths[i], vertices[i]);
        }
        const bool goes_on = options_.max_depth < 0 || edges_ < options_.max_depth;
        if (goes_on) {
            sample_lights(paths, vertices);
            read_photons(paths, vertices);
        }
        for (size_t i = 0; i < vertices.size(); ++i)
            deposit(vertices[i], edges_ - paths[i].panes, out_[paths[i].index]);
        if (goes_on) continue_paths(paths, vertices, next);
    }

    /// Adds direct light: all of it for the matte lobes and, unless a gather ray led here, the weighted share for the
    /// glossy lobes.
    void sample_lights(std::span<State> paths, std::span<const Vertex> vertices) {
        LitLobes lobes{.alone = LobeSet::matte, .shared = LobeSet::glossy};
        for (size_t i = 0; i < vertices.size(); ++i) {
            const Vertex& v = vertices[i];
            if (v.missed()) continue;
            lobes.has_shared = !paths[i].gathering;
            if (v.point.bsdf.has_non_delta()) wanted_.push_back({&paths[i], &v, paths[i].sampler, lobes, edges_ == 1});
            paths[i].sampler.skip(light_sample_dimensions);
        }
        lights_.sample(wanted_, shadows_);
        wanted_.clear();
    }

    /// Adds the indirect light of the matte lobes that photons give at this vertex. If gather rays must find it, the
    /// lobes are stored in `gathers_`.
    void read_photons(std::span<const State> paths, std::span<Vertex> vertices) {
        gathers_.assign(vertices.size(), std::nullopt);
        for (size_t i = 0; i < vertices.size(); ++i) {
            Vertex& v = vertices[i];
            if (v.missed()) continue;
            const bool reflected = read_side(paths[i], v, LobeSet::diffuse, v.wo),
                       passed = read_side(paths[i], v, LobeSet::translucent, -v.wo);
            if (reflected && passed)
                gathers_[i] = LobeSet::matte;
            else if (reflected || passed)
                gathers_[i] = reflected ? LobeSet::diffuse : LobeSet::translucent;
        }
    }

    /// Adds the light of those `lobes` that scatter light from the side of `from`. Returns true if gather rays must
    /// find it instead.
    bool read_side(const State& path, Vertex& v, LobeSet lobes, Vec3 from) {
        const Color albedo = v.point.bsdf.albedo(v.wo_local, lobes);
        if (is_black(albedo)) return false;
        const DensityPoint at(v.point, from);
        const Color scattered = path.throughput * albedo * inv_pi;
        if (path.gathering) {
            const auto far = far_irradiance(world_, maps_, at, v.hit.t, max_photon_edges(), progress_);
            v.read_matte += scattered * (far ? *far : density(maps_.caustic, at, maps_.reading.caustic));
            return !far;
        }
        v.read_matte += scattered * density(maps_.caustic, at, maps_.reading.caustic);
        if (options_.gather_rays > 0) return true;
        v.read_matte += scattered * density(maps_.global, at, maps_.reading.global);
        return false;
    }

    Color density(const PhotonMap& map, const DensityPoint& at, DensityOptions options) {
        options.max_edges = max_photon_edges();
        return estimate_irradiance(world_, map, at, options, progress_).irradiance;
    }

    /// Returns the greatest number of edges of a photon's path for which it is not too long together with the camera
    /// path.
    int max_photon_edges() const { return options_.max_depth < 0 ? -1 : options_.max_depth - edges_; }

    /// Continues with gather rays by the matte lobes and one ray by the glossy lobes.
    void continue_paths(std::span<const State> paths, std::span<const Vertex> vertices, Paths<State>& next) {
        constexpr uint32_t gather_dimensions = 6;  // dimensions reserved for gather rays, so that the parts share none
        const auto parts = static_cast<uint32_t>(edges_ == 1 ? options_.gather_rays : 1);
        for (size_t i = 0; i < vertices.size(); ++i) {
            const Vertex& v = vertices[i];
            if (v.missed()) continue;
            for (uint32_t part = 0; gathers_[i] && part < parts; ++part) {
                State one = paths[i];
                one.sampler = one.sampler.split(parts, part);
                one.throughput *= 1 / static_cast<float>(parts);
                one.gathering = true;
                push(one, v, *gathers_[i], next);
            }
            if (!v.point.bsdf.has(LobeSet::glossy)) continue;
            State one = paths[i];
            one.sampler.skip(gather_dimensions);
            push(one, v, LobeSet::glossy, next);
        }
    }

    /// Continues the path by `lobes` unless roulette ends it.
    void push(State& path, const Vertex& v, LobeSet lobes, Paths<State>& next) const {
        Ray ray;
        if (go_on(v, lobes, roulette_from(roulette_after::photon_gather_edges, edges_), path, ray))
            next.push(path, ray);
    }

    const World& world_;
    const PhotonMaps& maps_;
    const PhotonMapOptions& options_;
    DirectLight lights_;
    std::span<PathResult> out_;
    Progress& progress_;
    int edges_ = 0;                    // number of edges of all paths that have not ended
    std::vector<WantedLight> wanted_;  // light samples of the vertices that are being processed
    Shadows shadows_;
    std::vector<std::optional<LobeSet>> gathers_;  // lobes of the gather rays at each vertex
};

}  // namespace

void trace_to_photons(const World& world, const PhotonMaps& maps, const PhotonMapOptions& options,
                      std::span<const PathRay> rays, std::span<PathResult> out, Progress& progress) {
    std::fill(out.begin(), out.end(), PathResult{});
    Gatherer(world, maps, options, out, progress).run(rays);
}

std::vector<Color> photon_irradiance(const World& world, std::span<const PointNormal> points, const PhotonMaps& maps,
                                     const PointIrradianceOptions& options, Progress& progress) {
    // The maps hold light of any path length. Photons lie on surfaces, but points need not, so caustics are found by
    // paths.
    if (options.max_depth >= 0) return path_irradiance(world, points, options, progress);
    return path_irradiance(world, points, options, progress, [&](const SurfacePoint& point, float distance) {
        return far_irradiance(world, maps, {point, point.frame.n}, distance, -1, progress);
    });
}

}  // namespace eclat
