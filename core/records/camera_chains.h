// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Chains of vertices, one from each pixel, along which the camera sees surfaces directly and by way of mirrors and
// glossy lobes.

#pragma once

#include <span>
#include <vector>

#include "base/parallel.h"
#include "records/record_passes.h"
#include "scene/camera.h"
#include "transport/path_loop.h"

namespace eclat {

/// Makes the candidate for a point that the camera sees at the position `at` of the picture, in pixels, after `edge`
/// mirrors, at the end of a path of the given `length`.
Candidate seen_candidate(const SurfacePoint& point, const Camera& camera, float length, Vec2 at, int edge);

/// A vertex of a chain. The visitor may change `point`.
struct SeenVertex {
    SurfacePoint& point;
    Vec3 wo;  // in the point's frame
    const Camera& camera;
    float length;  // length of the chain up to this vertex, m
    Vec2 at;
    int edge;

    Candidate candidate() const { return seen_candidate(point, camera, length, at, edge); }
};

/// The chain of vertices of one pixel.
struct Chain {
    uint32_t pixel;
    float length;
};

/// Calls `visit(vertex, found)` for each vertex of the chains from `pixels` (x, y), in parallel, but in a fixed order
/// for each `found`. The call may append to `found` and returns the lobes by which the chain continues. Returns
/// everything that was found.
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
