// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// References   [Jensen01] photon tracing, [ArvoKirk90] Russian roulette, [Veach97 §5.3] shading normals and refraction
//              are not symmetric: photons need the adjoint of what radiance does
//
// Departures   A path scatters by its diffuse or by its glossy lobes, chosen by their albedo, so that each photon is
//              either a caustic one or not, whatever the material.
// Held to      tests/core/methods/photon_map/test_trace_photons.cpp, tests/methods/test_photon_map.py

#include "methods/photon_map/trace_photons.h"

#include <algorithm>

#include "base/parallel.h"
#include "sampling/sampler.h"

namespace eclat {

namespace {

constexpr uint32_t photon_stream = 51, guide_stream = 52;
constexpr uint64_t block = 4096;           // paths that are traced together
constexpr float resolution = 0x1p-20f;     // of coordinates, with three bits to spare
constexpr int sure_edges = 8;              // before a path that lost nothing may end by chance
constexpr float largest_survival = 0.95f;  // after that: light caught in glass must end somewhere

struct State {
    Color power;
    Sampler sampler;
    uint32_t emission;  // its number in the block
    float pdf;          // of its emission, with respect to a uniform one
    bool scattered_diffusely = false;
};

class Tracer {
  public:
    Tracer(const World& world, const TraceOptions& options, uint32_t stream, Progress& progress)
        : world_(world), options_(options), stream_(stream), progress_(progress) {}

    void run(PhotonPaths paths) {
        emit(paths);
        for (edges_ = 1; !rays_.empty(); ++edges_) {
            hits_.resize(rays_.size());
            world_.geometry.rays().intersect(rays_, hits_);
            progress_.count_rays(rays_.size());
            size_t kept = 0;
            for (size_t i = 0; i < rays_.size(); ++i) {
                if (hits_[i].missed() || !advance(states_[i], rays_[i], hits_[i])) continue;
                states_[kept] = states_[i];
                rays_[kept++] = rays_[i];
            }
            states_.erase(states_.begin() + static_cast<ptrdiff_t>(kept), states_.end());
            rays_.resize(kept);
        }
    }

    std::vector<Photon> photons;                 // in order of their edges
    std::vector<EmissionGuide::Result> emitted;  // what each path brought

  private:
    void emit(PhotonPaths paths) {
        if (options_.max_edges == 0) return;
        for (uint64_t i = paths.first; i < paths.end; ++i) {
            // The sampler counts 2^32 samples; what lies beyond is another sequence.
            Sampler sampler(options_.seed ^ hash(stream_), static_cast<uint32_t>(i >> 32), static_cast<uint32_t>(i));
            const float u_box = sampler.next_1d(), u_light = sampler.next_1d();
            const Vec2 u_position = sampler.next_2d(), u_direction = sampler.next_2d();
            const auto [u, pdf, box] =
                options_.guide.sample(u_box, {u_light, u_position.x, u_position.y, u_direction.x, u_direction.y});
            emitted.push_back({u, box, 0});
            const PhotonSample photon = world_.lights.emit(u[0], {u[1], u[2]}, {u[3], u[4]});
            if (is_black(photon.power)) continue;
            const auto emission = static_cast<uint32_t>(emitted.size() - 1);

            states_.push_back({photon.power * (1 / pdf), sampler, emission, pdf});
            rays_.push_back({start(photon), 0, photon.direction, infinity});
        }
    }

    /// Off the surface that it leaves, if it leaves one.
    Vec3 start(const PhotonSample& photon) const {
        if (photon.triangle == no_triangle) return photon.origin;
        const Vec3 n = world_.geometry.geometric_normal(photon.triangle);
        const float offset = resolution * (world_.geometry.radius() + length(photon.origin));
        return photon.origin + n * (dot(n, photon.direction) >= 0 ? offset : -offset);
    }

    bool wanted(const State& s) const {
        if (edges_ == 1) return options_.stored.direct;
        return s.scattered_diffusely ? options_.stored.indirect : options_.stored.caustic;
    }

    /// Store the photon that arrived at `hit`; true where its path goes on, along `ray`.
    bool advance(State& s, Ray& ray, const Hit& hit) {
        const Vec3 from = -ray.direction;
        const SurfacePoint point = world_.geometry.surface_point(hit, from);
        if (point.bsdf.has(LobeSet::diffuse) && wanted(s)) {
            const Vec3 n = dot(point.normal, from) >= 0 ? point.normal : -point.normal;
            photons.push_back({point.position, s.power, from, n, static_cast<float>(edges_)});
            emitted[s.emission].value += luminance(s.power) * s.pdf;
        }
        if (options_.max_edges >= 0 && edges_ >= options_.max_edges) return false;
        return scatter(s, ray, point, from);
    }

    bool scatter(State& s, Ray& ray, const SurfacePoint& point, Vec3 from) const {
        const Vec3 from_local = point.frame.to_local(from);
        float u_lobe = s.sampler.next_1d();
        const Vec2 u = s.sampler.next_2d();
        const float u_roulette = s.sampler.next_1d();

        // Choose the diffuse or the glossy lobes, in proportion to what they reflect of this photon.
        const float diffuse = luminance(point.bsdf.albedo(from_local, LobeSet::diffuse) * s.power),
                    glossy = luminance(point.bsdf.albedo(from_local, LobeSet::glossy) * s.power);
        if (!(diffuse + glossy > 0)) return false;
        const float p_diffuse = diffuse / (diffuse + glossy);
        const bool diffusely = u_lobe < p_diffuse;
        const float p = diffusely ? p_diffuse : 1 - p_diffuse;
        u_lobe = std::min((diffusely ? u_lobe : u_lobe - p_diffuse) / p, below_one);
        if (diffusely && !options_.stored.indirect) return false;
        const auto sample = point.bsdf.sample(from_local, u_lobe, u, diffusely ? LobeSet::diffuse : LobeSet::glossy);
        if (!sample) return false;
        const Vec3 to = point.frame.to_world(sample->wi);
        if (dot(to, point.normal) * sample->wi.z <= 0) return false;  // shading normal and surface disagree

        // What `sample` weighs is radiance that travels the other way [Veach97 §5.3].
        float adjoint =
            std::fabs(from_local.z * dot(to, point.normal)) / std::fabs(dot(from, point.normal) * sample->wi.z);
        if (sample->transmission) adjoint *= sqr(sample->eta_ratio);
        const Color power = s.power * sample->weight * (adjoint / p);
        float survival = std::min(1.0f, max_component(power) / max_component(s.power));
        if (edges_ >= sure_edges) survival = std::min(survival, largest_survival);
        if (!(u_roulette < survival)) return false;
        s.power = power * (1 / survival);
        s.scattered_diffusely |= diffusely;
        ray = point.ray(to);
        return true;
    }

    const World& world_;
    const TraceOptions& options_;
    uint32_t stream_;
    Progress& progress_;
    int edges_ = 0;  // of all paths under way, the one that is traced included
    std::vector<State> states_;
    std::vector<Ray> rays_;  // of each state
    std::vector<Hit> hits_;
};

/// `f(tracer, b)` for each block b of paths, once it is traced.
template <class F>
void trace_blocks(const World& world, PhotonPaths paths, const TraceOptions& options, uint32_t stream,
                  Progress& progress, const F& f) {
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

}  // namespace

std::vector<Photon> trace_photons(const World& world, PhotonPaths paths, const TraceOptions& options,
                                  Progress& progress) {
    std::vector<std::vector<Photon>> parts((paths.end - paths.first + block - 1) / block);
    trace_blocks(world, paths, options, photon_stream, progress,
                 [&](Tracer& tracer, size_t b) { parts[b].swap(tracer.photons); });
    return joined(parts);
}

EmissionGuide learn_emission(const World& world, const TraceOptions& options, Progress& progress) {
    constexpr uint64_t first_round = 16 * block;
    constexpr int rounds = 6;      // each refines what the one before has found
    constexpr double often = 0.2;  // of emissions that bring something: then nothing is to be learnt
    TraceOptions learning = options;
    learning.guide = EmissionGuide();
    uint64_t first = 0;
    for (int round = 0; round < rounds; ++round) {
        std::vector<std::vector<EmissionGuide::Result>> parts(first_round / block);
        trace_blocks(world, {first, first + first_round}, learning, guide_stream, progress,
                     [&](Tracer& tracer, size_t b) { parts[b].swap(tracer.emitted); });
        first += first_round;
        const auto results = joined(parts);
        const auto hits = std::ranges::count_if(results, [](const auto& r) { return r.value > 0; });
        if (round == 0 && static_cast<double>(hits) > often * static_cast<double>(results.size())) break;
        learning.guide.refine(results);
    }
    return learning.guide;
}

TracedPhotons trace_until(const World& world, size_t wanted, uint64_t most_paths, const TraceOptions& options,
                          Progress& progress) {
    constexpr uint64_t round = 16 * block;
    TracedPhotons out;
    progress.begin(wanted);
    while (out.photons.size() < wanted && out.paths < most_paths) {
        // As many as are probably needed; at most what keeps memory bounded where hits are frequent.
        uint64_t paths = round;
        if (!out.photons.empty()) {
            const double rate = static_cast<double>(out.photons.size()) / static_cast<double>(out.paths);
            const double missing = static_cast<double>(wanted - out.photons.size()) / rate;
            paths = std::clamp<uint64_t>(static_cast<uint64_t>(missing / block + 1) * block, block, 16 * round);
        } else {
            paths = std::clamp<uint64_t>(out.paths, block, 16 * round);  // nothing yet: look ever wider
        }
        paths = std::min(paths, std::max(block, most_paths - out.paths));
        const auto more = trace_photons(world, {out.paths, out.paths + paths}, options, progress);
        out.photons.insert(out.photons.end(), more.begin(), more.end());
        out.paths += paths;
        progress.done = std::min(wanted, out.photons.size());
    }
    return out;
}

}  // namespace eclat
