// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// Which patches lie behind which on sheets that let light through: curtains, paper, lampshades. Both sides of a triangle are
// halved the same way, each as far as its own light asks for.

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "methods/radiosity/patch_surfaces.h"

namespace eclat {

class OtherSides {
  public:
    struct Overlap {
        uint32_t patch;
        float share;  // of the area of the patch in front
    };

    /// `surfaces` has one a node.
    OtherSides(const PatchTree& tree, std::span<const PatchSurface> surfaces);

    /// The patches behind one; none where neither lets light through.
    std::span<const Overlap> of(uint32_t patch) const {
        if (first_.empty()) return {};
        return std::span(overlaps_).subspan(first_[patch], first_[patch + 1] - first_[patch]);
    }

  private:
    std::vector<size_t> first_;  // by node; empty where nothing lets light through
    std::vector<Overlap> overlaps_;
};

}  // namespace eclat
