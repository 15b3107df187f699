// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

#include "transport/paths.h"

#include "transport/path_loop.h"

namespace eclat {

namespace {

class Tracer {
  public:
    Tracer(const World& world, const PathOptions& options, std::span<PathResult> out, Progress& progress)
        : world_(world), options_(options), lights_(world, options.light_set), out_(out), progress_(progress) {}

    void run(std::span<const PathRay> rays) {
        Paths<PathState> paths;
        paths.reserve(rays.size());
        const Arrival arrival = options_.emission_at_first_hit ? Arrival::whole : Arrival::none;
        for (uint32_t i = 0; i < rays.size(); ++i) {
            const auto& [ray, sampler, pdf] = rays[i];
            const bool weighted = pdf > 0;
            paths.push({.sampler = sampler,
                        .index = i,
                        .pdf = pdf,
                        .arrival = weighted ? Arrival::weighted : arrival,
                        .from = ray.origin,
                        .all_lights = weighted},
                       ray);
        }
        if (options_.estimate_irradiance) continued_.resize(rays.size());
        follow_paths(
            world_, std::move(paths), options_.coherence,
            options_.cache || options_.reflection ? Span::batch : Span::part, progress_,
            [&](int edges, std::span<PathState> states, std::span<Vertex> vertices, Paths<PathState>& next) {
                edges_ = edges;
                at_vertices(states, vertices, next);
            },
            [&](Paths<PathState>& next) { after_edge(next); });
        for (size_t i = 0; i < continued_.size(); ++i) {
            const Continued& from = continued_[i];
            out_[i].radiance += from.weight * from.radiance;
            if (from.matte) out_[i].irradiance = (from.radiance - from.sampled) * from.cosine_over_density;
        }
    }

  private:
    /// The processing of vertices in passes: the light that arrives, the light that caches give for all vertices of the
    /// batch together, light samples, and the continuation of the paths.
    void at_vertices(std::span<PathState> paths, std::span<Vertex> vertices, Paths<PathState>& next) {
        for (size_t i = 0; i < vertices.size(); ++i) {
            describe(world_, vertices[i], edges_ == 1, paths[i], out_[paths[i].index]);
            lights_.arrive(paths[i], vertices[i]);
        }
        if (options_.cache) read_matte(paths, vertices);
        if (options_.reflection) read_glossy(paths, vertices);
        for (size_t i = 0; i < vertices.size(); ++i) {
            if (keeps_apart())
                deposit_apart(paths[i], vertices[i]);
            else
                deposit(vertices[i], edges_ - paths[i].panes, out_[paths[i].index]);
            if (!vertices[i].missed() && goes_on(paths[i])) want_lights(paths[i], vertices[i]);
        }
        lights_.sample(wanted_, shadows_);
        wanted_.clear();
        for (size_t i = 0; i < vertices.size(); ++i) {
            if (vertices[i].missed()) continue;
            if (goes_on(paths[i]))
                continue_path(paths[i], vertices[i], next);
            else
                pass_straight(paths[i], vertices[i], next);
        }
    }

    /// What the ray that continued from the first vertex brings, kept apart from the light that is known at that vertex.
    struct Continued {
        Color weight;                   // of its radiance in the result
        float cosine_over_density = 0;  // of its direction, or 0 where it brings no irradiance
        bool matte = false;             // whether the first vertex has a matte lobe that no cache serves
        Color radiance;                 // W m⁻² sr⁻¹
        Color sampled;                  // the part that light samples at the first vertex would find as well
    };

    /// Returns whether light at the current vertices was brought by rays that continued from the first vertex and whose
    /// throughput is counted from there.
    bool keeps_apart() const { return !continued_.empty() && edges_ > 1; }

    void deposit_apart(const PathState& path, const Vertex& v) {
        Continued& to = continued_[path.index];
        to.radiance += v.arriving;
        if (!v.missed()) to.radiance += v.read_matte + v.read_glossy;
        if (edges_ - path.panes > 2) return;
        to.sampled += v.arriving;
        if (v.missed()) to.sampled = to.sampled - path.throughput * world_.lights.left_out(-v.wo, options_.light_set);
    }

    /// Begins to count the throughput of a path at its first vertex, which it leaves along `ray`.
    void set_apart(const Vertex& v, const Ray& ray, PathState& path) {
        Continued& from = continued_[path.index];
        from.weight = path.throughput;
        // Roulette goes on to judge by the whole throughput.
        path.eta2 *= max_component(path.throughput);
        path.throughput = Color(1);
        if (path.arrival == Arrival::weighted)
            from.cosine_over_density = std::max(0.0f, dot(ray.direction, v.point.frame.n)) / path.pdf;
    }

    bool goes_on(const PathState& path) const {
        return options_.max_depth < 0 || edges_ - path.panes < options_.max_depth;
    }

    /// Follows the last edge of a path of full length through panes, because panes do not count as edges.
    void pass_straight(PathState& path, const Vertex& v, Paths<PathState>& next) const {
        constexpr int most_panes = 64;  // more than any scene has one behind the other
        const Color through = v.point.bsdf.straight(v.wo_local);
        if (is_black(through) || path.panes == most_panes) return;
        path.throughput *= through;
        ++path.panes;
        next.push(path, v.point.ray(-v.wo));
    }

    void after_edge(Paths<PathState>& next) {
        next.append(split_);
        split_.clear();
        shadows_.resolve(world_, progress_, [&](uint32_t index, Color radiance, bool direct) {
            if (keeps_apart()) {
                continued_[index].radiance += radiance;
                return;
            }
            out_[index].radiance += radiance;
            if (direct) out_[index].direct += radiance;
        });
    }

    bool reads_caches(const PathState& path) const { return !options_.gather_first || path.past_matte; }

    /// Adds the light that the cache gives for matte lobes on either side; these lobes are not continued.
    void read_matte(std::span<PathState> paths, std::span<Vertex> vertices) {
        for (size_t i = 0; i < vertices.size(); ++i) {
            Vertex& v = vertices[i];
            if (v.missed() || !goes_on(paths[i])) continue;
            if (!reads_caches(paths[i])) {
                if (v.point.bsdf.has(LobeSet::diffuse)) unread_.push_back(&v.point);
                continue;
            }
            if (v.point.bsdf.has(LobeSet::diffuse)) read_side(paths[i], v, v.point, LobeSet::diffuse);
            if (v.point.bsdf.has(LobeSet::translucent))
                read_side(paths[i], v, v.point.other_side(), LobeSet::translucent);
        }
        if (options_.aim && !unread_.empty()) options_.aim(unread_);
        unread_.clear();
    }

    /// Adds what the cache knows of those `lobes` that scatter light from the side of `point`.
    void read_side(PathState& path, Vertex& v, const SurfacePoint& point, LobeSet lobes) {
        auto irradiance = options_.cache(point, v.hit.t);
        if (!irradiance && edges_ > 1 && options_.far_cache) irradiance = options_.far_cache(point, v.hit.t);
        if (irradiance) {
            const Color albedo = path.throughput * v.point.bsdf.albedo(v.wo_local, lobes);
            v.read_matte += albedo * *irradiance * inv_pi;
            path.read_albedo += max_component(albedo);
            v.point.bsdf.set_cached(lobes);
        } else {
            out_[path.index].cache_missed = true;
        }
    }

    /// Adds the light that a cache gives for lobes that are not diffuse.
    void read_glossy(std::span<const PathState> paths, std::span<Vertex> vertices) {
        for (size_t i = 0; i < vertices.size(); ++i) {
            Vertex& v = vertices[i];
            if (v.missed() || !goes_on(paths[i]) || !v.point.bsdf.has(LobeSet::glossy)) continue;
            if (!reads_caches(paths[i])) continue;
            const Color reflected = options_.reflection(v.point, v.wo_local);
            v.read_glossy = paths[i].throughput * reflected;
            if (edges_ > 1) continue;
            out_[paths[i].index].gloss_cached = !is_black(reflected);
            out_[paths[i].index].gloss_traced = v.point.bsdf.has_uncached_gloss();
        }
    }

    /// Returns the number of paths that continue from a vertex.
    int paths_from(const PathState& path) const {
        return edges_ == 1 && out_[path.index].cache_missed ? options_.miss_paths : 1;
    }

    /// Lobes that a cache served must not meet the lights that `light_set` leaves out, because the cache contains them.
    bool samples_all_lights(const Vertex& v) const {
        const Bsdf& bsdf = v.point.bsdf;
        return options_.all_lights_where_uncached && bsdf.has_uncached_matte() && !bsdf.has(LobeSet::cached);
    }

    int light_samples() const { return edges_ == 1 ? options_.light_samples : 1; }

    /// Asks for the light samples of a vertex. The paths that continue from it also find lights.
    void want_lights(PathState& path, const Vertex& v) {
        const int count = light_samples();
        const LitLobes lobes{
            .alone = LobeSet::cached, .shared = LobeSet::uncached, .paths = paths_from(path), .light_samples = count};
        if (v.point.bsdf.has_non_delta())
            for (int i = 0; i < count; ++i)
                wanted_.push_back({&path, &v,
                                   path.sampler.split(static_cast<uint32_t>(count), static_cast<uint32_t>(i)), lobes,
                                   edges_ - path.panes == 1, samples_all_lights(v)});
        path.sampler.skip(light_sample_dimensions);
    }

    /// Returns the factor of roulette at a vertex. Where a cache has answered for the matte lobes, little is left to find:
    /// the other lobes matter in proportion to their share of the albedo, and half of all rays would be spent on the faint
    /// reflections of bright walls.
    float roulette_at(const PathState& path, const Vertex& v) const {
        if (options_.roulette_beside_cache > 0 && !is_black(v.read_matte))
            return options_.roulette_beside_cache / path.read_albedo;
        return roulette_from(options_.roulette_depth, edges_);
    }

    /// Continues a path in one direction or, from the first vertex, in several stratified directions.
    void continue_path(PathState& path, const Vertex& v, Paths<PathState>& next) {
        const int parts = paths_from(path);
        const float roulette = roulette_at(path, v);
        Ray ray;
        if (parts == 1) {
            const bool apart = !continued_.empty() && edges_ == 1;
            if (apart) continued_[path.index].matte = v.point.bsdf.has_uncached_diffuse();
            if (!go_on(v, LobeSet::uncached, roulette, path, ray, 1, light_samples(), samples_all_lights(v))) return;
            if (apart) set_apart(v, ray, path);
            next.push(path, ray);
            return;
        }
        for (int part = 0; part < parts; ++part) {
            PathState one = path;
            one.sampler = path.sampler.split(static_cast<uint32_t>(parts), static_cast<uint32_t>(part));
            one.throughput *= 1 / static_cast<float>(parts);
            if (go_on(v, LobeSet::uncached, roulette, one, ray, parts, light_samples(), samples_all_lights(v)))
                split_.push(one, ray);
        }
    }

    const World& world_;
    const PathOptions& options_;
    DirectLight lights_;
    std::span<PathResult> out_;
    Progress& progress_;
    int edges_ = 0;                      // number of edges of all paths that have not ended
    Paths<PathState> split_;             // additional paths, which follow all others
    std::vector<SurfacePoint*> unread_;  // matte vertices that read no cache
    std::vector<WantedLight> wanted_;    // light samples of the vertices that are being processed
    std::vector<Continued> continued_;   // of each ray, if irradiance is estimated
    Shadows shadows_;
};

}  // namespace

void describe(const World& world, const Vertex& vertex, bool first, PathState& path, PathResult& out) {
    if (path.described || vertex.missed()) return;
    const Color albedo = vertex.point.bsdf.albedo(vertex.wo_local);
    if (first) {
        const uint32_t triangle = vertex.hit.triangle;
        out.distance = vertex.hit.t;
        out.normal = vertex.point.frame.n;
        out.behind =
            world.geometry.has_no_back(triangle) && dot(world.geometry.geometric_normal(triangle), vertex.wo) < 0;
        out.albedo = albedo;
    }
    out.rough_albedo = min(path.throughput * albedo, Color(1.0f));
    out.rough_normal = vertex.point.frame.n;
    path.described = vertex.point.bsdf.has_non_delta();
}

void trace_paths(const World& world, std::span<const PathRay> rays, const PathOptions& options,
                 std::span<PathResult> out, Progress& progress) {
    std::fill(out.begin(), out.end(), PathResult{});
    Tracer(world, options, out, progress).run(rays);
}

}  // namespace eclat
