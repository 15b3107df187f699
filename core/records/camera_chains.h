// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The surfaces that pixels see, directly and after mirrors and glossy lobes: one chain of vertices from each pixel.

#pragma once

#include <span>
#include <vector>

#include "base/parallel.h"
#include "records/record_passes.h"
#include "scene/camera.h"
#include "transport/path_loop.h"

namespace eclat {

/// What the camera sees at the place `at` of the picture (pixels), `edge` mirrors on, at the end of a path of that `length`.
Candidate seen_candidate(const SurfacePoint& point, const Camera& camera, float length, Vec2 at, int edge);

/// A vertex of a chain; `point` may be changed by who looks at it.
struct SeenVertex {
    SurfacePoint& point;
    Vec3 wo;  // in the point's frame
    const Camera& camera;
    float length;  // of the chain up to here
    Vec2 at;
    int edge;

    Candidate candidate() const { return seen_candidate(point, camera, length, at, edge); }
};

/// The chain of a pixel.
struct Chain {
    uint32_t pixel;
    float length;
};

/// `visit(vertex, found)` for each vertex of the chains from `pixels` (x, y), in parallel, always in the same order for the
/// same `found`; it may add to that and says by which lobes the chain goes on. Returns all that was found.
template <class Found, class Visit>
std::vector<Found> follow_chains(const World& world, const Camera& camera, std::span<const Vec2> pixels, Stream stream,
                                 const IrradianceCacheOptions& options, Progress& progress, const Visit& visit) {
    constexpr int longest_chain = 4;
    constexpr size_t block = 1024;
    std::vector<std::vector<Found>> found((pixels.size() + block - 1) / block);
    parallel_for(found.size(), options.threads, [&](size_t b) {
        progress.check();
        const size_t begin = b * block, end = std::min(pixels.size(), begin + block);
        Paths<Chain> first;
        for (size_t i = begin; i < end; ++i)
            first.push({static_cast<uint32_t>(i), 0}, camera.ray(pixels[i].x, pixels[i].y, {0.5f, 0.5f}));
        follow_paths(
            world, std::move(first), Coherence::camera, Span::batch, progress,
            [&](int edges, std::span<Chain> chains, std::span<Vertex> vertices, Paths<Chain>& next) {
                for (size_t i = 0; i < chains.size(); ++i) {
                    Vertex& v = vertices[i];
                    if (v.missed()) continue;
                    const auto [pixel, length] = chains[i];
                    SeenVertex seen{v.point, v.wo_local, camera, length + v.hit.t, pixels[pixel], edges - 1};
                    const LobeSet going_on = visit(seen, found[b]);
                    if (edges == longest_chain) continue;
                    Sampler sampler(stream_seed(options.seed, stream), pixel, static_cast<uint32_t>(edges - 1));
                    if (const auto to = scatter(v.point, v.wo_local, sampler, going_on))
                        next.push({pixel, seen.length}, v.point.ray(to->direction));
                }
            },
            [](Paths<Chain>&) {});
    });
    std::vector<Found> out;
    for (auto& f : found) out.insert(out.end(), std::make_move_iterator(f.begin()), std::make_move_iterator(f.end()));
    return out;
}

}  // namespace eclat
