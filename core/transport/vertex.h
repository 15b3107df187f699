// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The steps at the vertices of all kinds of paths: rays hit surfaces, a path is continued by sampling the BSDF, and Russian
// roulette may end it [ArvoKirk90]. Sampling of lights is in transport/direct_light.h, and the loop over all edges in
// transport/path_loop.h.

#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/progress.h"
#include "sampling/sampler.h"
#include "transport/world.h"

namespace eclat {

/// The share of the light that a ray finds which light samples at the ray's origin have not counted.
enum class Arrival : uint8_t { whole, weighted, none };

/// The state of a path. Its ray is stored separately, because rays are traced in batches.
struct PathState {
    Color throughput{1};
    Sampler sampler;
    uint32_t index = 0;  // index of the ray with which it began
    float pdf = 0;       // density of the ray's direction, summed over the paths that share its last vertex
    float eta2 = 1;      // scaling of radiance by refraction, which roulette must not take for absorption
    Arrival arrival = Arrival::whole;  // how light that the ray finds is counted
    int light_samples = 1;             // number of light samples of the last vertex
    Vec3 from{};                       // position of the last vertex
    int panes = 0;           // panes that it passed; they are no vertices, because light samples pass them too
    bool described = false;  // whether the result holds the first rough surface
    /// Whether the last vertex sampled all lights, whatever `PathOptions::light_set` leaves out.
    bool all_lights = false;
    bool past_matte = false;  // whether it went on from a matte lobe that no cache served
    float read_albedo = 0;    // sum over its vertices of throughput times the albedo of the lobes that a cache served
};

/// The end of a path's ray: a point on a surface, or, if `point` is empty, infinity.
struct Vertex {
    Hit hit;
    Vec3 wo;        // direction back along the ray
    Vec3 wo_local;  // this direction in the point's frame
    // These are the contributions of this vertex, multiplied by the path's throughput.
    Color arriving;     // emission, or light from infinity
    Color read_matte;   // light of the matte lobes that a cache gave
    Color read_glossy;  // light of the other lobes that a cache gave
    SurfacePoint point;

    Vertex(const Geometry& geometry, const Ray& ray, const Hit& hit)
        : hit(hit), wo(-ray.direction), point(hit.missed() ? SurfacePoint() : geometry.surface_point(hit, wo)) {
        if (!hit.missed()) wo_local = point.frame.to_local(wo);
    }

    bool missed() const { return hit.missed(); }
};

/// The vertices of a batch of rays, in memory that is reused for the next batch.
class Vertices {
  public:
    /// Makes one vertex for each ray, in the order of the rays. The vertices are valid until the next call. Counts the
    /// rays in `progress`.
    std::span<Vertex> meet(const World& world, std::span<const Ray> rays, Coherence coherence, Progress& progress);

    /// These do the same in two steps: all rays of a batch are traced, and then their vertices are made in parts
    /// [begin, end).
    void trace(const World& world, std::span<const Ray> rays, Coherence coherence, Progress& progress);
    std::span<Vertex> part(const World& world, std::span<const Ray> rays, size_t begin, size_t end);

  private:
    std::vector<Hit> hits_;
    std::vector<Vertex> vertices_;
};

/// Returns the next number of the sampler, or 0 without computing it if it is not used.
inline float draw_if(bool wanted, Sampler& sampler) {
    if (wanted) return sampler.next_1d();
    sampler.skip(1);
    return 0;
}

/// A direction from which light arrives at a point.
struct Scattered {
    Vec3 direction;     // in world coordinates
    BsdfSample sample;  // the direction in the point's frame, with its weight
};

/// Samples the BSDF at `point`, seen from `wo`, which is in its frame. Returns nothing if the light is absorbed, or if
/// the direction is on different sides of the shading and geometric normals.
inline std::optional<Scattered> scatter(const SurfacePoint& point, Vec3 wo, float u_lobe, Vec2 u, LobeSet lobes) {
    const auto sample = point.bsdf.sample(wo, u_lobe, u, lobes);
    if (!sample) return std::nullopt;
    const Vec3 direction = point.frame.to_world(sample->wi);
    if (dot(direction, point.normal) * sample->wi.z <= 0) return std::nullopt;
    return Scattered{direction, *sample};
}
/// Does the same with the next two dimensions of the sampler.
inline std::optional<Scattered> scatter(const SurfacePoint& point, Vec3 wo, Sampler& sampler, LobeSet lobes) {
    const float u_lobe = draw_if(point.bsdf.chooses_lobe(), sampler);
    return scatter(point, wo, u_lobe, sampler.next_2d(), lobes);
}

/// The number of edges after which roulette may end paths. These numbers are chosen by judgement: larger numbers take
/// more rays, and smaller ones cause more noise.
namespace roulette_after {
constexpr int picture_edges = 5;        // for paths from the camera
constexpr int gather_edges = 2;         // for gather rays of records
constexpr int photon_gather_edges = 3;  // for camera paths with final gathers that end in photons
constexpr int probe_edges = 3;          // for camera paths of error probes
constexpr int photon_edges = 8;         // for photons without loss of power; others may end at any vertex
}  // namespace roulette_after
/// The greatest probability of survival, chosen by judgement: paths that are trapped in glass must end, here after 20
/// more edges on average.
constexpr float largest_survival = 0.95f;
/// Returns the factor of `go_on` for paths that roulette may end after a number of edges.
inline float roulette_from(int first, int edges) { return edges >= first ? 1.0f : 0.0f; }

/// Continues the path from `vertex` in one direction of `lobes`, which is stored in `ray`. If `roulette` is positive,
/// the path may end: it goes on with the probability of `roulette` times its throughput. Returns false if it ends. Three dimensions of its sampler are used in any case. `paths` and `light_samples`
/// are the numbers of those at the vertex. They are not stored if the path goes straight through a pane; those of the
/// vertex before the pane are then kept.
bool go_on(const Vertex& vertex, LobeSet lobes, float roulette, PathState& path, Ray& ray, int paths = 1,
           int light_samples = 1, bool all_lights = false);

}  // namespace eclat
