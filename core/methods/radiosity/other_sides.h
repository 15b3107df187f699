// SPDX-FileCopyrightText: the Éclat authors
// SPDX-License-Identifier: Apache-2.0

// The patches behind each patch on surfaces that transmit light, such as curtains, paper and lampshades. Both sides of
// a triangle are bisected in the same way, but each as finely as its own light requires.

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

    /// Returns the patches behind a patch, or none if neither side transmits light.
    std::span<const Overlap> of(uint32_t patch) const {
        if (first_.empty()) return {};
        return std::span(overlaps_).subspan(first_[patch], first_[patch + 1] - first_[patch]);
    }

  private:
    std::vector<size_t> first_;  // by node; empty where nothing lets light through
    std::vector<Overlap> overlaps_;
};

}  // namespace eclat
