// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Symbols and references as in methods/irradiance_cache/irradiance_cache.cpp.

#include "records/gather.h"

#include <algorithm>

#include "hemisphere/hemisphere.h"

namespace eclat {

namespace {

constexpr float usual_rows = 14;  // of the gather whose noise records keep

// What stands low beside the point, or hangs close under the ceiling that it is part of, fills so little of the hemisphere
// that a gather meets it by luck; yet light ends behind it. Rays along the horizon look for it in every direction.
class HorizonLook {
  public:
    HorizonLook(const World& world, const Candidate& candidate, Progress& progress)
        : world_(world), candidate_(candidate), frame_(Frame::around(candidate.normal)), progress_(progress) {}

    /// Lowers the record's clearances and, with `limits`, its distance.
    void look(IrradianceRecord& record, bool limits) const {
        std::vector<Look> looks;
        for (float elevation : {lowest, highest})
            for (int turn = 0; turn < turns; ++turn) looks.push_back({elevation, turn});
        const auto found = trace(looks);
        // What faces the surface, as the back of a panel does, begins nearer than where a low ray meets it: between the
        // highest ray that meets it and the lowest that passes below.
        std::vector<Edge> edges;
        for (int turn = 0; turn < turns; ++turn) {
            const Met &low = found[size_t(turn)], &high = found[size_t(turn + turns)];
            if (high.faces)
                edges.push_back({turn, highest, above_highest});
            else if (low.faces)
                edges.push_back({turn, lowest, highest});
        }
        tell(looks, found, record, limits);
        for (int halving = 0; halving < halvings && !edges.empty(); ++halving) {
            looks.clear();
            for (const Edge& e : edges) looks.push_back({std::sqrt(e.met * e.passed), e.turn});
            const auto closer = trace(looks);
            for (size_t i = 0; i < edges.size(); ++i)
                (closer[i].faces ? edges[i].met : edges[i].passed) = looks[i].elevation;
            tell(looks, closer, record, limits);
        }
    }

  private:
    static constexpr float degree = pi / 180;
    static constexpr float lowest = 1.5f * degree, highest = 5 * degree, above_highest = 45 * degree;
    static constexpr int turns = 24;
    static constexpr int halvings = 4;  // an edge within a sixth of its distance

    struct Look {
        float elevation;
        int turn;
    };
    struct Met {
        float distance = infinity;  // to what stands apart
        bool faces = false;         // the surface
    };
    struct Edge {
        int turn;
        float met, passed;  // elevations
    };

    Vec3 direction(const Look& look) const {
        const float phi = 2 * pi * (static_cast<float>(look.turn) + 0.5f) / turns;
        return frame_.u * (std::cos(look.elevation) * std::cos(phi)) +
               frame_.v * (std::cos(look.elevation) * std::sin(phi)) + frame_.n * std::sin(look.elevation);
    }

    std::vector<Met> trace(std::span<const Look> looks) const {
        std::vector<Ray> rays;
        for (const Look& look : looks) rays.push_back(candidate_.ray(direction(look)));
        std::vector<Hit> hits(rays.size());
        world_.geometry.rays().intersect(rays, hits);
        progress_.count_rays(rays.size());
        std::vector<Met> out(rays.size());
        for (size_t i = 0; i < rays.size(); ++i) {
            if (hits[i].missed()) continue;
            const Vec3 there = world_.geometry.surface_point(hits[i], -rays[i].direction).frame.n;
            if (stands_apart(candidate_.shading_normal, rays[i].direction, there))
                out[i] = {hits[i].t, dot(there, frame_.n) < -0.7f};
        }
        return out;
    }

    void tell(std::span<const Look> looks, std::span<const Met> found, IrradianceRecord& record, bool limits) const {
        for (size_t i = 0; i < looks.size(); ++i) {
            // A wall goes on between two rays, and is nearest at one side of a sector: its neighbours' sectors hear too.
            for (int heard : {looks[i].turn, looks[i].turn + 1, looks[i].turn - 1}) {
                float& clearance = record.clearance[clearance_sector(frame_, direction({looks[i].elevation, heard}))];
                clearance = std::min(clearance, found[i].distance * std::cos(looks[i].elevation));
            }
            if (limits) record.distance = std::min(record.distance, found[i].distance);
        }
    }

    const World& world_;
    const Candidate& candidate_;
    Frame frame_;
    Progress& progress_;
};

PathOptions gather_paths(const FarEnd& far, const IrradianceCacheOptions& options) {
    PathOptions paths;
    paths.max_depth = options.max_depth < 0 ? -1 : options.max_depth - 1;
    paths.roulette_depth = roulette_after::gather_edges;
    paths.light_set = LightSet::without_smooth_environment;
    paths.emission_at_first_hit = false;
    paths.cache = far.irradiance;
    paths.reflection = far.reflection;
    return paths;
}

/// Radiance and distance in each cell of a hemisphere of `rows` rows around a candidate. `enclosed`: most rays met the
/// back of surfaces that have none.
HemisphereSamples sample_hemisphere(const World& world, const Candidate& candidate, const FarEnd& far,
                                    const IrradianceCacheOptions& options, Stream stream, int rows, Rows kind,
                                    Progress& progress, bool& enclosed) {
    HemisphereSamples samples;
    samples.rows = rows;
    samples.kind = kind;
    samples.columns = columns_for(rows);
    const size_t count = size_t(samples.rows) * samples.columns;
    // A random turn of the grid, or neighbouring records would share the pattern of their error.
    const uint32_t key = hash(candidate.key, static_cast<uint32_t>(stream));
    const float turn = 2 * pi * to_unit_float(hash(key, options.seed));
    const Frame around = Frame::around(candidate.normal);
    const Vec3 u = around.u * std::cos(turn) + around.v * std::sin(turn);
    samples.frame = {u, cross(around.n, u), around.n};

    std::vector<PathRay> rays;
    rays.reserve(count);
    for (int j = 0; j < samples.rows; ++j)
        for (int k = 0; k < samples.columns; ++k) {
            const auto index = static_cast<uint32_t>(j * samples.columns + k);
            Sampler sampler(stream_seed(options.seed, stream), key, index);
            const Vec3 w = cell_direction(samples.rows, samples.columns, j, k, sampler.next_2d(), kind);
            rays.push_back({candidate.ray(samples.frame.to_world(w)), sampler});
        }
    std::vector<PathResult> results(count);
    trace_paths(world, rays, gather_paths(far, options), results, progress);
    for (size_t i = 0; i < count; ++i) {
        samples.radiance.push_back(results[i].radiance);
        samples.distance.push_back(results[i].distance);
        samples.direction.push_back(samples.frame.to_local(rays[i].ray.direction));
        samples.hit_normal.push_back(samples.frame.to_local(results[i].normal));
        samples.apart.push_back(stands_apart(candidate.shading_normal, rays[i].ray.direction, results[i].normal));
    }
    size_t behind = 0;
    for (const PathResult& r : results) behind += r.behind;
    enclosed = 2 * behind > count;
    return samples;
}

/// Irradiance from radiance beyond `limit`, and its standard error in luminance.
struct Excess {
    Color irradiance;
    float noise = 0;
};

// By two techniques: the cells of the grid, and rays aimed at bright places, weighted by the balance heuristic [Veach97].
// Earlier gathers found those places; had this one's own rays chosen where to look closer, what they missed would be lost.
Excess gather_excess(const World& world, const Candidate& candidate, const HemisphereSamples& samples, float limit,
                     const FarEnd& far, const BrightPlaces& bright, const IrradianceCacheOptions& options,
                     Stream stream, Progress& progress, std::vector<Sighting>& sightings) {
    constexpr size_t aimed_share = 4;  // of the grid's rays so many have one aimed ray
    const AimedCones cones = bright.seen_from(candidate.position, candidate.normal);
    const size_t count = samples.radiance.size(), aimed = cones.empty() ? 0 : count / aimed_share;
    std::vector<PathRay> rays;
    const uint32_t key = hash(candidate.key, static_cast<uint32_t>(stream));
    for (size_t i = 0; i < aimed; ++i) {
        Sampler sampler(stream_seed(options.seed, stream), key, static_cast<uint32_t>(count + i));
        const float u_cone = (static_cast<float>(i) + sampler.next_1d()) / static_cast<float>(aimed);
        const Vec3 w = cones.sample(u_cone, sampler.next_2d());
        if (dot(w, candidate.normal) > 0) rays.push_back({candidate.ray(w), sampler});
    }
    std::vector<PathResult> results(rays.size());
    if (!rays.empty()) trace_paths(world, rays, gather_paths(far, options), results, progress);
    Excess out;
    float squares = 0;  // how many rays meet what is so small is about Poisson distributed
    const auto add = [&](Vec3 w, float distance, Color radiance) {
        const Color L = beyond(radiance, limit);
        if (is_black(L)) return;
        const float cosine = dot(w, candidate.normal);
        const float density =
            static_cast<float>(count) * cosine * inv_pi + static_cast<float>(aimed) * cones.pdf_solid_angle(w);
        const Color share = L * (cosine / density);
        out.irradiance += share;
        squares += sqr(luminance(share));
        if (distance < infinity) sightings.push_back({candidate.position + w * distance, luminance(L)});
    };
    for (size_t i = 0; i < count; ++i)
        add(samples.frame.to_world(samples.direction[i]), samples.distance[i], samples.radiance[i]);
    for (size_t i = 0; i < rays.size(); ++i) add(rays[i].ray.direction, results[i].distance, results[i].radiance);
    out.noise = std::sqrt(squares);
    return out;
}

// How E bends at the record, and along which axis less.
void bend(const HemisphereSamples& samples, Curvature curvature, float far, IrradianceRecord& record) {
    const auto bends = principal_curvatures(irradiance_hessian(samples, curvature, far));
    record.curvature = bends.larger;
    record.elongation = elongation(bends);
    // The long axis lies across that of the larger curvature.
    const Vec3 axis = samples.frame.v * std::cos(bends.angle) - samples.frame.u * std::sin(bends.angle);
    const Frame frame = Frame::around(record.normal);
    record.axis = std::atan2(dot(axis, frame.v), dot(axis, frame.u));
}

/// The distance that bounds a record's radius before curvature and gradient do.
float bounding_distance(const HemisphereSamples& samples, const IrradianceCacheOptions& options) {
    if (options.metric == Metric::harmonic) return harmonic_mean_distance(samples);
    if (curvature_of(options.metric) && !options.obstacle_limit) return infinity;
    return minimum_distance(samples);
}

/// Relative noise of what is read at a record: of its own irradiance, and of an excess that its surroundings share.
float noise_when_read(const HemisphereSamples& samples, float excess_noise, float excess) {
    constexpr float sharing = 8;  // records whose excess counts about fully within four radii
    const float E = luminance(irradiance(samples));
    if (!(E > 0)) return 0;
    return std::sqrt(sqr(relative_noise(samples) * E) + sqr(excess_noise) / sharing) / (E + excess);
}

}  // namespace

Gathered gather(const World& world, const Candidate& candidate, const FarEnd& far, const BrightPlaces& bright,
                const IrradianceCacheOptions& options, Stream stream, int rows, Progress& progress, Rows kind,
                const std::function<void(const HemisphereSamples&)>& keep) {
    Gathered out;
    IrradianceRecord& record = out.record;
    bool enclosed = false;
    HemisphereSamples samples =
        sample_hemisphere(world, candidate, far, options, stream, rows, kind, progress, enclosed);
    // What a camera sees is in no solid, though a one-sided panel that hangs close to a ceiling fills its hemisphere.
    record.enclosed = enclosed && !candidate.seen;
    Excess excess;
    if (kind == Rows::cosine)
        excess = gather_excess(world, candidate, samples, excess_limit(samples), far, bright, options, stream, progress,
                               out.sightings);
    const Color met = take_excess(samples);
    if (kind != Rows::cosine) excess.irradiance = met;
    record.excess = excess.irradiance;
    record.excess_noise = excess.noise;
    // Stratified samples in the plane converge with the power 3/4 of their number, which goes with the square of rows.
    record.own_noise = noise_when_read(samples, excess.noise, luminance(record.excess));
    record.noise = record.own_noise * std::pow(static_cast<float>(rows) / usual_rows, 1.5f);
    record.position = candidate.position;
    record.normal = samples.frame.n;
    record.irradiance = irradiance(samples);
    record.distance = bounding_distance(samples, options);
    record.clearance = sector_clearance(samples);
    record.least_radius = options.least_pixels * candidate.footprint;
    record.largest_radius = options.largest_pixels * candidate.footprint;
    // What touches the point, like the surface itself by rounding, would move infinitely fast.
    keep_off(samples, std::max(record.least_radius, 1e-5f * world.geometry.radius()));
    if (keep) keep(samples);
    record.rotation = rotation_gradient(samples);
    record.translation = translation_gradient(samples);
    // Beyond twenty scene radii nothing has parallax.
    if (const auto curvature = curvature_of(options.metric))
        bend(samples, *curvature, 20 * world.geometry.radius(), record);
    const bool limits = options.metric == Metric::minimum || (curvature_of(options.metric) && options.obstacle_limit);
    HorizonLook(world, candidate, progress).look(record, limits);
    return out;
}

}  // namespace eclat
