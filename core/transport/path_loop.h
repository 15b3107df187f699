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

/// Paths under way: the state of each, and beside it the ray that continues it.
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

/// How many vertices are handed over at once.
enum class Span : uint8_t {
    batch,  // all of a batch, for stages that look at them together
    part,   // as many as stay in a processor's first cache
};

/// Follows `paths` to their ends. After each edge `at_vertices(edges, states, vertices, next)` gets how many edges all paths
/// have by now, the state of each path and the vertex that it reached, both as spans and in the same order; it puts into
/// `next` the paths that go on. It is called for all vertices of the batch in order, `span` of them at a time, and then
/// `after_edge(next)` once: results do not depend on `span`. `first` says how the rays of the first edge run.
template <class State, class AtVertices, class AfterEdge>
void follow_paths(const World& world, Paths<State> paths, Coherence first, Span span, Progress& progress,
                  const AtVertices& at_vertices, const AfterEdge& after_edge) {
    // Tuned: against whole batches of 1024 vertices (760 bytes each) the Cornell box gains about 1 % paths a second.
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
