// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The links of hierarchical radiosity [Hanrahan91]: the pairs of nodes that exchange light, at their levels of the tree.

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"
#include "methods/radiosity/patch_surfaces.h"
#include "transport/world.h"

namespace eclat {

/// All that goes from one node to the other and back: one number for both, so that reciprocity holds by itself.
struct Link {
    uint32_t a = 0, b = 0;
    float exchange = 0;     // A_a F_ab = A_b F_ba with what stands between, m²
    float visibility = -1;  // share of the exchange that nothing hides; < 0: not known yet
    float kernel = 0;  // of clusters that reach into each other: exchange per area of both, without what hides it, m⁻²
    uint32_t in_part = 0;  // 1: other rays than those that measure visibility found it hidden, but not all of it
};

struct LinkOptions {
    float tolerance = 0;       // W m⁻² of irradiance that may be wrong by one link
    float least_sender = 0;    // W m⁻²: no sender counts as darker, so that all form factors are known somewhat
    size_t most = ~size_t(0);  // links, about: where there are more the tolerance grows with the cube of their number
    uint32_t seed = 0;
    int threads = 0;
};

/// The link of everything with everything, from which refinement starts.
std::vector<Link> first_links(const PatchTree& tree);

/// Replaces links by those of their halves where the light that they would carry from nodes of these radiosities, times what
/// is not known about it, exceeds the tolerance. Links of patches that were divided since are refined further likewise.
/// `surfaces` has one a node, or none where all patches are exposed. Returns the tolerance that held in the end.
float refine_links(const World& world, const PatchTree& tree, std::span<const PatchSurface> surfaces,
                   std::span<const float> radiosity, const LinkOptions& options, std::vector<Link>& links,
                   Progress& progress);

/// Where each node's light is from.
class Exchanges {
  public:
    struct Sender {
        uint32_t node;
        float form_factor;  // share of its radiosity that arrives
        float visibility;
    };

    Exchanges() = default;
    Exchanges(const PatchTree& tree, std::span<const Link> links);

    std::span<const Sender> of(uint32_t node) const {
        return std::span(senders_).subspan(first_[node], first_[node + 1] - first_[node]);
    }
    size_t size() const { return senders_.size(); }

  private:
    std::vector<size_t> first_;
    std::vector<Sender> senders_;
};

}  // namespace eclat
