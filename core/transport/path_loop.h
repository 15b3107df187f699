// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The only loop over the edges of paths. It traces the rays of a batch together and passes all their vertices at once to the
// caller, which processes them in stages: each stage is a pass over a span of vertices.

#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "transport/vertex.h"

namespace eclat {

/// The paths that have not ended: the state of each, and the ray that continues it.
template <class State>
struct Paths {
    std::vector<State> states;
    std::vector<Ray> rays;

    bool empty() const { return states.empty(); }
    size_t size() const { return states.size(); }
    void reserve(size_t count) {
        states.reserve(count);
        rays.reserve(count);
    }
    void clear() {
        states.clear();
        rays.clear();
    }
    void push(const State& state, const Ray& ray) {
        states.push_back(state);
        rays.push_back(ray);
    }
    void append(const Paths& more) {
        states.insert(states.end(), more.states.begin(), more.states.end());
        rays.insert(rays.end(), more.rays.begin(), more.rays.end());
    }
};

/// The number of vertices that are passed to the caller at once.
enum class Span : uint8_t {
    batch,  // all of a batch, for stages that process them together
    part,   // as many as fit into the first-level cache of a processor
};

/// Traces `paths` to their ends. After each edge, `at_vertices(edges, states, vertices, next)` is called with the
/// number of edges that all paths have, and with spans of the states of the paths and of the vertices that they
/// reached, in the same order. It appends to `next` the paths that continue. It is called for all vertices of the batch
/// in order, `span` at a time, and after them `after_edge(next)` is called once. The results do not depend on `span`.
/// `first` is the kind of the rays of the first edge.
template <class State, class AtVertices, class AfterEdge>
void follow_paths(const World& world, Paths<State> paths, Coherence first, Span span, Progress& progress,
                  const AtVertices& at_vertices, const AfterEdge& after_edge) {
    // This number is tuned: compared with whole batches of 1024 vertices (760 bytes each), about 1 % more paths per
    // second are traced in the Cornell box.
    constexpr size_t vertices_of_part = 32;
    Vertices vertices;
    Paths<State> next;
    for (int edges = 1; !paths.empty(); ++edges) {
        const size_t count = paths.size(), step = span == Span::batch ? count : vertices_of_part;
        vertices.trace(world, paths.rays, edges == 1 ? first : Coherence::none, progress);
        next.reserve(count);
        for (size_t begin = 0; begin < count; begin += step) {
            const size_t end = std::min(count, begin + step);
            at_vertices(edges, std::span<State>(paths.states).subspan(begin, end - begin),
                        vertices.part(world, paths.rays, begin, end), next);
        }
        after_edge(next);
        std::swap(paths, next);
        next.clear();
    }
}

}  // namespace eclat
