// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// References   [Jensen01] photon tracing, [ArvoKirk90] Russian roulette, [Veach97 §5.3] shading normals and refraction
//              are not symmetric: photons need the adjoint of what radiance does
//
// Departures   A path scatters by its matte or by its glossy lobes, chosen by their albedo, so that each photon is
//              either a caustic one or not, whatever the material. Culled backs are not there for those who look
//              (scene/intersect.h), so photons, which run against looks, end at backs and pass through fronts, which they
//              light as well.
// Held to      tests/core/methods/photon_map/test_trace_photons.cpp, tests/methods/test_photon_map.py

#include "methods/photon_map/trace_photons.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/precision.h"
#include "transport/path_loop.h"

namespace eclat {

namespace {

constexpr uint64_t block = 4096;  // number of paths that are traced together

struct State {
    Color power;
    Sampler sampler;
    uint32_t emission;  // number of its emission in the block
    float weight;       // density of its emission relative to uniform emission, times the importance of where it starts
    bool scattered_diffusely = false;
    int passed = 0;        // number of surfaces that it passed, whose edges do not count
    bool passing = false;  // whether its ray starts at such a surface
};

class Tracer {
  public:
    Tracer(const World& world, const TraceOptions& options, Stream stream, Progress& progress)
        : world_(world), options_(options), stream_(stream), progress_(progress) {}

    void run(PhotonPaths range) {
        follow_paths(
            world_, emit(range), Coherence::none, Span::part, progress_,
            [&](int edges, std::span<State> states, std::span<const Vertex> vertices, Paths<State>& next) {
                edges_ = edges;
                look_back(states, vertices);
                store(states, vertices);
                scatter_all(states, vertices, next);
            },
            [](Paths<State>&) {});
    }

    std::vector<Photon> photons;                 // photons in the order of their edges
    std::vector<EmissionGuide::Result> emitted;  // result of each emission

  private:
    Paths<State> emit(PhotonPaths range) {
        Paths<State> paths;
        if (options_.max_edges == 0) return paths;
        for (uint64_t i = range.first; i < range.end; ++i) {
            // The sampler has 2^32 samples; further paths use another sequence.
            Sampler sampler(stream_seed(options_.seed, stream_), static_cast<uint32_t>(i >> 32),
                            static_cast<uint32_t>(i));
            const float u_box = sampler.next_1d(), u_light = sampler.next_1d();
            const Vec2 u_position = sampler.next_2d(), u_direction = sampler.next_2d();
            const auto [u, pdf, box] =
                options_.guide.sample(u_box, {u_light, u_position.x, u_position.y, u_direction.x, u_direction.y});
            emitted.push_back({u, box, 0});
            const PhotonSample photon = world_.lights.emit(u[0], {u[1], u[2]}, {u[3], u[4]});
            if (is_black(photon.power)) continue;
            const auto emission = static_cast<uint32_t>(emitted.size() - 1);
            paths.push({photon.power * (1 / pdf), sampler, emission, pdf * photon.importance},
                       {start(photon), 0, photon.direction, infinity});
        }
        return paths;
    }

    /// Moves the origin of the ray off the surface on which it starts, if there is one.
    Vec3 start(const PhotonSample& photon) const {
        if (photon.triangle == no_triangle) return photon.origin;
        const Vec3 n = world_.geometry.geometric_normal(photon.triangle);
        const float offset = world_.geometry.ray_offset(photon.triangle);
        return photon.origin + n * (dot(n, photon.direction) >= 0 ? offset : -offset);
    }

    int edges(const State& s) const { return edges_ - s.passed; }

    /// Finds the photons that hit culled backs on their way, because the point at which they arrive does not see their
    /// origin.
    void look_back(std::span<const State> states, std::span<const Vertex> vertices) {
        ended_.assign(vertices.size(), 0);
        const Intersector& rays = world_.geometry.rays();
        if (!rays.culls_backs()) return;
        looks_.clear();
        for (size_t i = 0; i < states.size(); ++i) {
            const Vertex& v = vertices[i];
            // The surface that was passed is not hit again from behind, but the front of another surface that lies on
            // it may be hit.
            const float beyond = v.hit.t / shadow_shortening + 2 * v.point.offset;
            looks_.push_back(v.missed()          ? Ray{{}, 0, {0, 0, 1}, 0}
                             : states[i].passing ? v.point.ray(v.wo, beyond)
                                                 : v.point.ray_to_light(v.wo, v.hit.t, {}));
        }
        rays.occluded(looks_, ended_);
        progress_.count_rays(looks_.size());
    }

    bool wanted(const State& s) const {
        if (edges(s) == 1) return options_.stored.direct;
        return s.scattered_diffusely ? options_.stored.indirect : options_.stored.caustic;
    }

    /// Stores the photons that arrived at matte surfaces, with the side on which they arrived.
    void store(std::span<const State> states, std::span<const Vertex> vertices) {
        for (size_t i = 0; i < states.size(); ++i) {
            const Vertex& v = vertices[i];
            if (v.missed() || ended_[i] || !v.point.bsdf.has(LobeSet::matte) || !wanted(states[i])) continue;
            const Vec3 normal = v.point.normal;
            const Vec3 n = dot(normal, v.wo) >= 0 ? normal : -normal;
            photons.push_back({v.point.position, states[i].power, v.wo, n, static_cast<float>(edges(states[i]))});
            emitted[states[i].emission].value += luminance(states[i].power) * states[i].weight;
        }
    }

    void scatter_all(std::span<State> states, std::span<const Vertex> vertices, Paths<State>& next) const {
        for (size_t i = 0; i < states.size(); ++i) {
            const Vertex& v = vertices[i];
            if (v.missed() || ended_[i]) continue;
            if (world_.geometry.material_of(v.hit.triangle).culls_back()) {
                State through = states[i];
                ++through.passed;
                through.passing = true;
                next.push(through, v.point.ray(-v.wo));
            }
            Ray ray;
            const bool may_go_on = options_.max_edges < 0 || edges(states[i]) < options_.max_edges;
            if (may_go_on && scatter_photon(states[i], v, ray)) next.push(states[i], ray);
        }
    }

    bool scatter_photon(State& s, const Vertex& v, Ray& ray) const {
        const SurfacePoint& point = v.point;
        const Vec3 from_local = v.wo_local;
        float u_lobe = s.sampler.next_1d();
        const Vec2 u = s.sampler.next_2d();
        const float u_roulette = s.sampler.next_1d();

        // The matte or the glossy lobes are chosen with probabilities proportional to the power of this photon that
        // they reflect.
        const float diffuse = luminance(point.bsdf.albedo(from_local, LobeSet::matte) * s.power),
                    glossy = luminance(point.bsdf.albedo(from_local, LobeSet::glossy) * s.power);
        if (!(diffuse + glossy > 0)) return false;
        const float p_diffuse = diffuse / (diffuse + glossy);
        const bool diffusely = u_lobe < p_diffuse;
        const float p = diffusely ? p_diffuse : 1 - p_diffuse;
        u_lobe = std::min((diffusely ? u_lobe : u_lobe - p_diffuse) / p, below_one);
        if (diffusely && !options_.stored.indirect) return false;
        const auto to = diffusely && point.frame.n != point.normal
                            ? scatter_as_seen(v, u_lobe, u)
                            : scatter_by_lobes(point, v, u_lobe, u, diffusely ? LobeSet::matte : LobeSet::glossy);
        if (!to) return false;
        const Color power = s.power * to->weight * (1 / p);
        // Unlike paths from the camera, photons keep equal powers: roulette at each vertex accounts for the absorption
        // of the surface.
        float survival = std::min(1.0f, max_component(power) / max_component(s.power));
        if (edges(s) >= roulette_after::photon_edges) survival = std::min(survival, largest_survival);
        if (!(u_roulette < survival)) return false;
        s.power = power * (1 / survival);
        s.scattered_diffusely |= diffusely;
        s.passing = false;
        s.passed += to->straight;  // direct light passes panes too
        ray = point.ray(to->direction);
        return true;
    }

    struct Onward {
        Vec3 direction;
        Color weight;
        bool straight = false;  // whether it passes a pane
    };

    /// Converts the weight of `scatter`, which is that of radiance, to the weight of a photon, which travels in the
    /// other direction [Veach97 §5.3].
    static std::optional<Onward> scatter_by_lobes(const SurfacePoint& point, const Vertex& v, float u_lobe, Vec2 u,
                                                  LobeSet lobes) {
        const auto to = scatter(point, v.wo_local, u_lobe, u, lobes);
        if (!to) return std::nullopt;
        const BsdfSample& sample = to->sample;
        float adjoint = std::fabs(v.wo_local.z * dot(to->direction, point.normal)) /
                        std::fabs(dot(v.wo, point.normal) * sample.wi.z);
        if (sample.transmission) adjoint *= sqr(sample.eta_ratio);
        return Onward{to->direction, sample.weight * adjoint, sample.straight};
    }

    /// Scatters a photon by the matte lobes of a surface whose shading normal differs from its geometric normal. For
    /// grazing views the shading normal is bent towards the viewer, so light leaves in all directions above the
    /// geometric surface. A direction is therefore chosen with a density proportional to the geometric cosine, and
    /// weighted by the reflection that is seen from there.
    std::optional<Onward> scatter_as_seen(const Vertex& v, float u_side, Vec2 u) const {
        const Vec3 n = dot(v.point.normal, v.wo) >= 0 ? v.point.normal : -v.point.normal;
        const float reflected = luminance(v.point.bsdf.diffuse_albedo(v.wo_local)),
                    passed = luminance(v.point.bsdf.translucent_albedo(v.wo_local));
        const float p_reflected = reflected / (reflected + passed);
        const bool through = u_side >= p_reflected;
        const float p_side = through ? 1 - p_reflected : p_reflected;
        const Vec3 to = Frame::around(through ? -n : n).to_world(square_to_cosine_hemisphere(u));
        const SurfacePoint seen = world_.geometry.surface_point(v.hit, to);
        const Vec3 wi = seen.frame.to_local(v.wo), wo = seen.frame.to_local(to);
        if (wi.z * dot(v.wo, seen.normal) <= 0) return std::nullopt;
        const Color f = seen.bsdf.eval(wo, wi, LobeSet::matte).f;
        return Onward{to, f * (pi * std::fabs(wi.z) / (dot(v.wo, n) * p_side))};
    }

    const World& world_;
    const TraceOptions& options_;
    Stream stream_;
    Progress& progress_;
    int edges_ = 0;  // of all paths under way
    std::vector<Ray> looks_;
    std::vector<uint8_t> ended_;  // whether the path ended at each vertex
};

/// Calls `f(tracer, b)` for each block b of paths after it has been traced.
template <class F>
void trace_blocks(const World& world, PhotonPaths paths, const TraceOptions& options, Stream stream, Progress& progress,
                  const F& f) {
    const uint64_t blocks = (paths.end - paths.first + block - 1) / block;
    parallel_for(blocks, options.threads, [&](size_t b) {
        progress.check();
        const uint64_t first = paths.first + b * block;
        Tracer tracer(world, options, stream, progress);
        tracer.run({first, std::min(paths.end, first + block)});
        f(tracer, b);
    });
}

template <class T>
std::vector<T> joined(const std::vector<std::vector<T>>& parts) {
    std::vector<T> out;
    for (const auto& part : parts) out.insert(out.end(), part.begin(), part.end());
    return out;
}

/// About the number of rays of a path from a light.
constexpr uint64_t rays_of_path = 4;

/// Learns from the emissions of `blocks` blocks that several processes trace. The others get the guide that this one learned.
template <class Emitted, class Learn>
bool learn_with_others(const WorkExchange& exchange, size_t blocks, Progress& progress, const Emitted& emitted,
                       const Learn& learn, EmissionGuide& guide) {
    const SharedStep step(exchange, blocks, block * rays_of_path, progress, [&](size_t from, size_t to) {
        std::string out;
        write_bytes(out, std::span<const EmissionGuide::Result>(emitted(from, to)));
        return out;
    });
    if (step.digest()) {
        ByteReader reader(*step.digest());
        const bool enough = reader.read<uint64_t>() != 0;
        guide.read(reader);
        return enough;
    }
    std::vector<EmissionGuide::Result> results;
    for (const std::string& range : step.ranges()) {
        const auto part = ByteReader(range).rest<EmissionGuide::Result>();
        results.insert(results.end(), part.begin(), part.end());
    }
    require(results.size() == blocks * block, "emissions: expected all of the round");
    const bool enough = learn(results);
    std::string digest;
    write_bytes(digest, static_cast<uint64_t>(enough));
    guide.write(digest);
    step.tell(digest);
    return enough;
}

/// The photons of a round, or only their number in a process that follows the one that has them.
struct TracedRound {
    std::vector<Photon> photons;
    size_t count = 0;

    static TracedRound of(std::vector<Photon> photons) {
        const size_t count = photons.size();
        return {std::move(photons), count};
    }
};

TracedRound trace_with_others(const World& world, PhotonPaths paths, const TraceOptions& options, Progress& progress) {
    const size_t blocks = (paths.end - paths.first + block - 1) / block;
    const SharedStep step(*options.exchange, blocks, block * rays_of_path, progress, [&](size_t from, size_t to) {
        const PhotonPaths range{paths.first + from * block, std::min(paths.end, paths.first + to * block)};
        std::string out;
        write_bytes(out, std::span<const Photon>(trace_photons(world, range, options, progress)));
        return out;
    });
    if (step.digest()) return {{}, ByteReader(*step.digest()).read<uint64_t>()};
    TracedRound out;
    for (const std::string& range : step.ranges()) {
        const auto part = ByteReader(range).rest<Photon>();
        out.photons.insert(out.photons.end(), part.begin(), part.end());
    }
    out.count = out.photons.size();
    std::string digest;
    write_bytes(digest, static_cast<uint64_t>(out.count));
    step.tell(digest);
    return out;
}

}  // namespace

std::vector<Photon> trace_photons(const World& world, PhotonPaths paths, const TraceOptions& options,
                                  Progress& progress) {
    std::vector<std::vector<Photon>> parts((paths.end - paths.first + block - 1) / block);
    trace_blocks(world, paths, options, Stream::photons, progress,
                 [&](Tracer& tracer, size_t b) { parts[b].swap(tracer.photons); });
    return joined(parts);
}

EmissionGuide learn_emission(const World& world, const TraceOptions& options, Progress& progress) {
    constexpr uint64_t first_round = 16 * block;
    constexpr int rounds = 6;      // each round refines the guide of the round before
    constexpr double often = 0.2;  // share of emissions with stored photons above which no guide is needed
    TraceOptions learning = options;
    learning.guide = EmissionGuide();
    uint64_t first = 0;
    for (int round = 0; round < rounds; ++round) {
        const uint64_t begin = first;
        const auto emitted = [&](size_t from, size_t to) {
            std::vector<std::vector<EmissionGuide::Result>> parts(to - from);
            trace_blocks(world, {begin + from * block, begin + to * block}, learning, Stream::emission_guides, progress,
                         [&](Tracer& tracer, size_t b) { parts[b].swap(tracer.emitted); });
            return joined(parts);
        };
        const auto learn = [&](const std::vector<EmissionGuide::Result>& results) {
            const auto hits = std::ranges::count_if(results, [](const auto& r) { return r.value > 0; });
            const bool enough = round == 0 && static_cast<double>(hits) > often * static_cast<double>(results.size());
            if (!enough) learning.guide.refine(results);
            return enough;
        };
        const bool enough = options.exchange ? learn_with_others(*options.exchange, first_round / block, progress,
                                                                 emitted, learn, learning.guide)
                                             : learn(emitted(0, first_round / block));
        first += first_round;
        if (enough) break;
    }
    return learning.guide;
}

TracedPhotons trace_until(const World& world, size_t wanted, uint64_t most_paths, const TraceOptions& options,
                          Progress& progress) {
    constexpr uint64_t round = 16 * block;
    TracedPhotons out;
    size_t stored = 0;  // also those that only another process has
    progress.begin(wanted);
    while (stored < wanted && out.paths < most_paths) {
        // The number of paths is what is probably needed; its upper bound limits the memory if many photons are stored.
        uint64_t paths = round;
        if (stored > 0) {
            const double rate = static_cast<double>(stored) / static_cast<double>(out.paths);
            const double missing = static_cast<double>(wanted - stored) / rate;
            paths = std::clamp<uint64_t>(static_cast<uint64_t>(missing / block + 1) * block, block, 16 * round);
        } else {
            paths =
                std::clamp<uint64_t>(out.paths, block, 16 * round);  // nothing was stored yet, so the number is doubled
        }
        paths = std::min(paths, std::max(block, most_paths - out.paths));
        const PhotonPaths range{out.paths, out.paths + paths};
        const TracedRound more = options.exchange ? trace_with_others(world, range, options, progress)
                                                  : TracedRound::of(trace_photons(world, range, options, progress));
        out.photons.insert(out.photons.end(), more.photons.begin(), more.photons.end());
        stored += more.count;
        out.paths += paths;
        progress.done = std::min(wanted, stored);
    }
    return out;
}

}  // namespace eclat
