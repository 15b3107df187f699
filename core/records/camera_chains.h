// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// What pixels see, at first and after mirrors and gloss: one chain of vertices from each, where records could be wanted.

#pragma once

#include <span>
#include <vector>

#include "base/parallel.h"
#include "records/record_passes.h"
#include "scene/camera.h"

namespace eclat {

/// What the camera sees at the place `at` of the picture (pixels), `edge` mirrors on, at the end of a path of that `length`.
Candidate seen_candidate(const SurfacePoint& point, const Camera& camera, float length, Vec2 at, int edge);

/// A vertex of a chain; `point` may be changed by who looks at it.
struct SeenVertex {
    SurfacePoint point;
    Vec3 wo;  // in the point's frame
    const Camera& camera;
    float length;
    Vec2 at;
    int edge;

    Candidate candidate() const { return seen_candidate(point, camera, length, at, edge); }
};

/// `visit(vertex, found)` for each vertex of the chains from `pixels` (x, y), in parallel, always in the same order for the
/// same `found`; it may add to that and says by which lobes the chain goes on. Returns all that was found.
template <class Found, class Visit>
std::vector<Found> follow_chains(const World& world, const Camera& camera, std::span<const Vec2> pixels,
                                 uint32_t stream, const IrradianceCacheOptions& options, Progress& progress,
                                 const Visit& visit) {
    constexpr int longest_chain = 4;
    constexpr size_t block = 1024;
    struct Chain {
        uint32_t pixel;
        float length;
    };
    std::vector<std::vector<Found>> found((pixels.size() + block - 1) / block);
    parallel_for(found.size(), options.threads, [&](size_t b) {
        progress.check();
        const auto some = pixels.subspan(b * block, std::min(block, pixels.size() - b * block));
        std::vector<Ray> rays;
        std::vector<Chain> chains;
        for (uint32_t i = 0; i < some.size(); ++i) {
            rays.push_back(camera.ray(some[i].x, some[i].y, {0.5f, 0.5f}));
            chains.push_back({i, 0});
        }
        for (int edge = 0; edge < longest_chain && !rays.empty(); ++edge) {
            std::vector<Hit> hits(rays.size());
            world.geometry.rays().intersect(rays, hits, edge == 0 ? Coherence::camera : Coherence::none);
            progress.count_rays(rays.size());
            std::vector<Ray> next;
            std::vector<Chain> next_chains;
            for (size_t i = 0; i < rays.size(); ++i) {
                if (hits[i].missed()) continue;
                const Vec3 wo = -rays[i].direction;
                SeenVertex vertex{world.geometry.surface_point(hits[i], wo),
                                  {},
                                  camera,
                                  chains[i].length + hits[i].t,
                                  some[chains[i].pixel],
                                  edge};
                vertex.wo = vertex.point.frame.to_local(wo);
                const LobeSet going_on = visit(vertex, found[b]);
                const auto pixel = static_cast<uint32_t>(b * block) + chains[i].pixel;
                Sampler sampler(options.seed ^ hash(stream), pixel, static_cast<uint32_t>(edge));
                const float u_lobe = sampler.next_1d();
                const auto sample = vertex.point.bsdf.sample(vertex.wo, u_lobe, sampler.next_2d(), going_on);
                if (!sample) continue;
                next.push_back(vertex.point.ray(vertex.point.frame.to_world(sample->wi)));
                next_chains.push_back({chains[i].pixel, vertex.length});
            }
            rays.swap(next);
            chains.swap(next_chains);
        }
    });
    std::vector<Found> out;
    for (auto& f : found) out.insert(out.end(), std::make_move_iterator(f.begin()), std::make_move_iterator(f.end()));
    return out;
}

}  // namespace eclat
