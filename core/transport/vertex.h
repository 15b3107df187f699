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

/// How much of the light that a direction finds has not been counted by light samples where the direction was chosen.
enum class Arrival : uint8_t { whole, weighted, none };

/// A path under way. Its ray is kept beside it, since rays are traced in batches.
struct PathState {
    Color throughput{1};
    Sampler sampler;
    uint32_t index = 0;                // of the ray that it began with
    float pdf = 0;                     // of the ray's direction, summed over the paths that share its last vertex
    float eta2 = 1;                    // radiance scaling by refraction, which roulette must not mistake for absorption
    Arrival arrival = Arrival::whole;  // of light that the ray finds
    int light_samples = 1;             // that the last vertex took
    Vec3 from{};                       // position of the last vertex
    int panes = 0;           // that it went straight through; they are no vertices, since light samples pass too
    bool described = false;  // the first surface that is rough is in the result
};

/// Where the ray of a path ended: on a surface, or beyond the scene, where `point` is empty.
struct Vertex {
    Hit hit;
    Vec3 wo;        // back along the ray
    Vec3 wo_local;  // the same in the point's frame
    // Light towards the path's beginning that was found here, times the path's throughput:
    Color arriving;     // emission, or what lies behind everything
    Color read_matte;   // what a cache knows of the matte lobes
    Color read_glossy;  // … and of the others
    SurfacePoint point;

    Vertex(const Geometry& geometry, const Ray& ray, const Hit& hit)
        : hit(hit), wo(-ray.direction), point(hit.missed() ? SurfacePoint() : geometry.surface_point(hit, wo)) {
        if (!hit.missed()) wo_local = point.frame.to_local(wo);
    }

    bool missed() const { return hit.missed(); }
};

/// The vertices of a batch of rays, in memory that is used again for the next batch.
class Vertices {
  public:
    /// One vertex for each ray, in their order; valid until the next call. Counts the rays in `progress`.
    std::span<Vertex> meet(const World& world, std::span<const Ray> rays, Coherence coherence, Progress& progress);

    /// The same in two steps: all rays of a batch are traced, then their vertices are made a part [begin, end) at a time.
    void trace(const World& world, std::span<const Ray> rays, Coherence coherence, Progress& progress);
    std::span<Vertex> part(const World& world, std::span<const Ray> rays, size_t begin, size_t end);

  private:
    std::vector<Hit> hits_;
    std::vector<Vertex> vertices_;
};

/// The sampler's next number; 0 where nobody will look at it, which costs nothing.
inline float draw_if(bool wanted, Sampler& sampler) {
    if (wanted) return sampler.next_1d();
    sampler.skip(1);
    return 0;
}

/// A direction in which light reaches a point from.
struct Scattered {
    Vec3 direction;     // in world coordinates
    BsdfSample sample;  // the same in the point's frame, with its weight
};

/// Samples the BSDF at `point`, seen from `wo` (in its frame); nothing where light is absorbed, or where the shading normal
/// and the surface disagree on which side the direction is.
inline std::optional<Scattered> scatter(const SurfacePoint& point, Vec3 wo, float u_lobe, Vec2 u, LobeSet lobes) {
    const auto sample = point.bsdf.sample(wo, u_lobe, u, lobes);
    if (!sample) return std::nullopt;
    const Vec3 direction = point.frame.to_world(sample->wi);
    if (dot(direction, point.normal) * sample->wi.z <= 0) return std::nullopt;
    return Scattered{direction, *sample};
}
/// The same with the sampler's next numbers, two dimensions of them.
inline std::optional<Scattered> scatter(const SurfacePoint& point, Vec3 wo, Sampler& sampler, LobeSet lobes) {
    const float u_lobe = draw_if(point.bsdf.chooses_lobe(), sampler);
    return scatter(point, wo, u_lobe, sampler.next_2d(), lobes);
}

/// Edges after which paths may end by chance. Set by judgement, not measured: later ends cost rays, earlier ones noise.
namespace roulette_after {
constexpr int picture_edges = 5;        // of paths from the camera
constexpr int gather_edges = 2;         // of what one of a record's many rays finds
constexpr int photon_gather_edges = 3;  // from the camera, through gathers that end in photons
constexpr int probe_edges = 3;          // from the camera, of a path whose served vertices are examined
constexpr int photon_edges = 8;         // of photons that lost nothing; those that did may end at any vertex
}  // namespace roulette_after
/// The greatest chance to survive, by judgement: light caught in glass must end, here after 20 more edges on average.
constexpr float largest_survival = 0.95f;

/// Lets the path go on from `vertex` along `ray` by one direction of `lobes`, with `roulette` if it survives that; false
/// where it ends. Uses three dimensions of its sampler, whatever happens.
/// `paths` and `light_samples` are how many share the vertex, unless it goes straight through a pane: then nothing changes
/// of what the vertex before it said.
bool go_on(const Vertex& vertex, LobeSet lobes, bool roulette, PathState& path, Ray& ray, int paths = 1,
           int light_samples = 1);

}  // namespace eclat
