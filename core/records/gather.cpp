// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// One gather makes one record. Rays leave the point through the cells of a stratified grid over its hemisphere
// (hemisphere/hemisphere.cpp). Their hits give irradiance, its gradients, its second derivatives and the distances of obstacles.
// If a single cell contributes more than a twentieth of the irradiance, a few rays cannot determine the size of the
// bright object. The excess over this share is therefore removed from the grid and estimated separately, by additional
// rays that are aimed at places that earlier gathers found to be bright. Neighbouring records share it when they are
// read (records/record_cache.cpp).
//
// Symbol     name here          meaning                                                     unit
//   M, N     rows, columns      rows and columns of the grid, N = π M                       1
//   L_jk     samples.radiance   radiance in cell (j, k)                                     W m⁻² sr⁻¹
//   E        record.irradiance  irradiance without the excess                               W m⁻²
//   X        record.excess      irradiance of the excess that was removed                   W m⁻²
//   n, m     count, aimed       number of rays of the grid, n = M N, and of aimed rays      1
//   q        cones              density of the directions of the aimed rays                 sr⁻¹
//   L⁺       beyond()           part of the radiance that is above the limit for one cell   W m⁻² sr⁻¹
//
// The rays of both kinds together estimate X = Σ L⁺(ω) cos θ / (n cos θ / π + m q(ω)): the balance heuristic [Veach97 §9].
//
// References   [Ward88] the grid, [WardHeckbert92] gradients, [Schwarzhaupt12] curvature, [Veach97]
// Departures   The excess is estimated by rays of its own and read from a plane through that of neighbouring records.
// Held to      tests/core/records/test_record_passes.cpp, tests/core/records/test_bright_places.cpp

#include "records/gather.h"

#include <algorithm>

#include "hemisphere/hemisphere.h"
#include "records/horizon_look.h"

namespace eclat {

namespace {

// Records store the noise that a gather with the default `rows` would have, so that values are comparable for all
// `rows`.
constexpr float usual_rows = 14;

PathOptions gather_paths(const FarEnd& far, const IrradianceCacheOptions& options) {
    PathOptions paths;
    paths.max_depth = options.max_depth < 0 ? -1 : options.max_depth - 1;
    paths.roulette_depth = roulette_after::gather_edges;
    paths.roulette_beside_cache = 1;
    paths.light_set = LightSet::without_smooth_environment;
    paths.emission_at_first_hit = false;
    paths.cache = far.irradiance;
    paths.reflection = far.reflection;
    paths.estimate_irradiance = far.wants_samples;
    return paths;
}

/// The results of the rays of one hemisphere.
struct Sampled {
    HemisphereSamples samples;  // radiance and distance in each cell
    bool enclosed = false;      // whether most rays hit backs of one-sided surfaces
    std::vector<CellSample> found;
};

/// Returns how many rays of a gather hit the back of a one-sided surface, or would hit it if backs were not culled.
size_t count_backs(const World& world, std::span<const PathRay> rays, std::span<const PathResult> results,
                   Progress& progress) {
    if (!world.geometry.rays().culls_backs())
        return static_cast<size_t>(std::ranges::count_if(results, [](const PathResult& r) { return r.behind; }));
    std::vector<Ray> looks;
    for (const PathRay& ray : rays) looks.push_back(ray.ray);
    std::vector<Hit> hits(looks.size());
    world.geometry.meet_with_backs(looks, hits);
    progress.count_rays(looks.size());
    size_t behind = 0;
    for (size_t i = 0; i < hits.size(); ++i)
        behind += !hits[i].missed() && world.geometry.has_no_back(hits[i].triangle) &&
                  dot(world.geometry.geometric_normal(hits[i].triangle), looks[i].direction) > 0;
    return behind;
}

Sampled sample_hemisphere(const GatherTask& task, const Candidate& candidate, int rows, Rows kind) {
    const auto& [world, far, bright, options, stream, progress] = task;
    Sampled out;
    HemisphereSamples& samples = out.samples;
    samples.rows = rows;
    samples.kind = kind;
    samples.columns = columns_for(rows);
    const size_t count = size_t(samples.rows) * samples.columns;
    // The grid is rotated by a random angle, because neighbouring records would otherwise have similar errors.
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
        if (results[i].irradiance)
            out.found.push_back({CellKey::at(rays[i].ray.origin + rays[i].ray.direction * results[i].distance,
                                             results[i].normal, results[i].distance),
                                 *results[i].irradiance});
    }
    out.enclosed = 2 * count_backs(world, rays, results, progress) > count;
    return out;
}

/// The irradiance from the radiance above `limit`, and the standard error of its luminance.
struct Excess {
    Color irradiance;
    float noise = 0;
};

// Two techniques are combined by the balance heuristic [Veach97]: the cells of the grid, and rays aimed at bright
// places. Only earlier gathers choose these places. If the rays of this gather chose them, the light of places that
// they missed would be lost, and the estimate would be biased. For the same reason the limit for a cell, and for aimed rays
// through it, follows from the half of the grid to which the cell does not belong.
Excess gather_excess(const GatherTask& task, const Candidate& candidate, const HemisphereSamples& samples,
                     std::vector<Sighting>& sightings) {
    const auto& [world, far, bright, options, stream, progress] = task;
    const ExcessLimits limits = excess_limits(samples);
    // One ray is aimed for this many rays of the grid. In the scene bright-spot, this reduces splotches from 3.0 to 1.8
    // % and errors from 6.8 to 4.0 %, with 23 % more rays than without aimed rays. A larger share would take more rays
    // in every gather.
    constexpr size_t aimed_share = 4;
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
    float squares = 0;  // the number of rays that hit so small an object has about a Poisson distribution
    const auto add = [&](Vec3 w, size_t cell, float distance, Color radiance) {
        const Color L = beyond(radiance, limits.at(samples, cell));
        if (is_black(L)) return;
        const float cosine = dot(w, candidate.normal);
        const float density =
            static_cast<float>(count) * cosine * inv_pi + static_cast<float>(aimed) * cones.pdf_solid_angle(w);
        const Color share = L * (cosine / density);
        out.irradiance += share;
        squares += sqr(luminance(share));
        if (distance < infinity) sightings.push_back({candidate.position + w * distance, luminance(L), distance});
    };
    for (size_t i = 0; i < count; ++i)
        add(samples.frame.to_world(samples.direction[i]), i, samples.distance[i], samples.radiance[i]);
    for (size_t i = 0; i < rays.size(); ++i) {
        const Vec3 w = rays[i].ray.direction;
        add(w, cell_at(samples, samples.frame.to_local(w)), results[i].distance, results[i].radiance);
    }
    out.noise = std::sqrt(squares);
    return out;
}

// These are the second derivatives of E at the record, and the axis along which they are smaller.
void bend(const HemisphereSamples& samples, Curvature curvature, float far, IrradianceRecord& record) {
    const auto bends = principal_curvatures(irradiance_hessian(samples, curvature, far));
    record.curvature = bends.larger;
    record.elongation = elongation(bends);
    // The long axis is perpendicular to the axis of the larger curvature.
    const Vec3 axis = samples.frame.v * std::cos(bends.angle) - samples.frame.u * std::sin(bends.angle);
    const Frame frame = Frame::around(record.normal);
    record.axis = std::atan2(dot(axis, frame.v), dot(axis, frame.u));
}

/// Returns the distance that bounds a record's radius whatever its curvature and gradient are.
float bounding_distance(const HemisphereSamples& samples, const IrradianceCacheOptions& options) {
    if (options.metric == Metric::harmonic) return harmonic_mean_distance(samples);
    if (curvature_of(options.metric) && !options.obstacle_limit) return infinity;
    return minimum_distance(samples);
}

/// Computes the relative noise of the irradiance that is read at a record: that of its own irradiance, and that of the
/// excess, which is averaged over neighbouring records.
float noise_when_read(const HemisphereSamples& samples, float excess_noise, float excess) {
    // This is the number of records that share an excess, chosen by judgement: the widest neighbourhood (share_excess)
    // extends to four radii and contains about this many records with full weight. A larger number would underestimate
    // the noise, and a smaller one would cause needless rays.
    constexpr float sharing = 8;
    const float E = luminance(irradiance(samples));
    if (!(E + excess > 0)) return 0;
    return std::sqrt(sqr(relative_noise(samples) * E) + sqr(excess_noise) / sharing) / (E + excess);
}

}  // namespace

// This inverts the exponent by which `gather` sets the noise of a gather of the usual number of rows.
int rows_of(const IrradianceRecord& record, int unknown) {
    if (!(record.own_noise > 0) || !(record.noise > 0)) return unknown;
    return static_cast<int>(std::lround(usual_rows * std::pow(record.noise / record.own_noise, 2 / 3.0f)));
}

Gathered gather(const GatherTask& task, const Candidate& candidate, int rows, Rows kind,
                const std::function<void(const HemisphereSamples&)>& keep) {
    const World& world = task.world;
    const IrradianceCacheOptions& options = task.options;
    Gathered out;
    IrradianceRecord& record = out.record;
    auto [samples, enclosed, found] = sample_hemisphere(task, candidate, rows, kind);
    out.samples = std::move(found);
    // A point that a camera sees is not inside a solid, even if a one-sided panel close to it fills its hemisphere.
    record.enclosed = enclosed && !candidate.seen;
    Excess excess;
    if (kind == Rows::cosine) excess = gather_excess(task, candidate, samples, out.sightings);
    const Color met = take_excess(samples);
    if (kind != Rows::cosine) excess.irradiance = met;
    record.excess = excess.irradiance;
    record.excess_noise = excess.noise;
    // The error of stratified samples in the plane is proportional to the power −3/4 of their number, which is
    // proportional to the square of the number of rows.
    record.own_noise = noise_when_read(samples, excess.noise, luminance(record.excess));
    record.noise = record.own_noise * std::pow(static_cast<float>(rows) / usual_rows, 1.5f);
    record.position = candidate.position;
    record.normal = samples.frame.n;
    record.irradiance = irradiance(samples);
    out.obstacle = bounding_distance(samples, options);
    record.clearance = sector_clearance(samples);
    out.reach = reach(samples);
    out.footprint = candidate.footprint > 0 ? candidate.footprint : pixel_share * out.reach;
    record.least_radius = options.least_pixels * out.footprint;
    record.largest_radius = options.largest_pixels * out.footprint;
    // For surfaces that touch the point, such as the surface itself because of rounding, the gradients would be
    // infinite.
    keep_off(samples, std::max(record.least_radius, 10 * candidate.offset));
    if (keep) keep(samples);
    record.rotation = rotation_gradient(samples);
    record.translation = translation_gradient(samples);
    // At twenty times the largest hit distance, the parallax is negligible. If no ray hits a surface, there are no
    // second derivatives.
    const float farthest = farthest_distance(samples);
    if (const auto curvature = curvature_of(options.metric); curvature && farthest > 0)
        bend(samples, *curvature, 20 * farthest, record);
    const bool limits = options.metric == Metric::minimum || (curvature_of(options.metric) && options.obstacle_limit);
    const float along_horizon = look_along_horizon(world, candidate, task.progress, record);
    if (limits) out.obstacle = std::min(out.obstacle, along_horizon);
    return out;
}

}  // namespace eclat
