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

/// The exchange between two nodes. It is one number for both directions, so that it is reciprocal.
struct Link {
    uint32_t a = 0, b = 0;
    float exchange = 0;     // A_a F_ab = A_b F_ba including occlusion, m²
    float visibility = -1;  // share of the exchange that arrives, past obstacles and panes; < 0 if it is not known yet
    float kernel = 0;       // for overlapping clusters: unoccluded exchange per area of both, m⁻²
    uint32_t in_part = 0;   // 1 if rays other than the measuring ones found it partly occluded
    Color tint{1};          // colour of what arrives; its mean is 1
};

struct LinkOptions {
    float tolerance = 0;     // tolerated error of the irradiance by one link, W m⁻²
    float least_sender = 0;  // least radiosity assumed for senders, so that all form factors are roughly known, W m⁻²
    size_t most =
        ~size_t(0);  // approximate number of links above which the tolerance grows with the cube of their number
    uint32_t seed = 0;
    int threads = 0;
};

/// Returns the link of the root with itself, from which refinement starts.
std::vector<Link> first_links(const PatchTree& tree);

/// Replaces links by links of their halves if the light that they carry between nodes of the given radiosities, times
/// its uncertainty, exceeds the tolerance. Links of patches that have since been divided are refined too. `surfaces`
/// has one entry per node, or none if all patches are exposed. Returns the tolerance that was finally used.
float refine_links(const World& world, const PatchTree& tree, std::span<const PatchSurface> surfaces,
                   std::span<const float> radiosity, const LinkOptions& options, std::vector<Link>& links,
                   Progress& progress);

/// The sources of the light of each node.
class Exchanges {
  public:
    struct Sender {
        uint32_t node;
        float form_factor;  // share of its radiosity that arrives
        float visibility;
        Color tint;  // colour of this share
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
